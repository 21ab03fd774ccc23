# SPDX-License-Identifier: Apache-2.0
"""Symbols that a client stores for the server: valid data are restored, other data are rejected."""

from __future__ import annotations

import pytest

from as2fm_lsp.handlers.symbols import pack, unpack
from roaml.diagnostics import Symbol
from roaml.roles import SymbolKind


@pytest.mark.parametrize("kind", SymbolKind)
def test_there_and_back(kind: SymbolKind) -> None:
    symbol = Symbol("/a.ascxml", kind, "level", "thread")
    assert unpack(pack(symbol)) == symbol


@pytest.mark.parametrize("data", [None, "state", [], ["/a", "state", "s"], ["/a", "no-kind", "s", ""]])
def test_other_data_is_no_symbol(data: object) -> None:
    assert unpack(data) is None
