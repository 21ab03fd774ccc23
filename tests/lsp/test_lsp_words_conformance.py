# SPDX-License-Identifier: Apache-2.0
"""The editor and the command line say the same about the properties of conformance systems."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from test_lsp_words import compare

import conformance

SYSTEMS = ("string_comparison", "on_entry_exit_test", "probabilistic_transitions", "ros_example", "data_structs")


@pytest.mark.parametrize("name", SYSTEMS)
async def test_words(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(conformance.ROOT / "models" / name, tmp_path / name)
    main = min((tmp_path / name).glob("main*.xml"))
    assert await compare(main, capsys, str(conformance.INTERFACES)) == []
