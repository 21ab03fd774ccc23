# SPDX-License-Identifier: Apache-2.0
"""The interface definitions of the conformance models have no findings."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_interface_standard import REGISTRY, check

import conformance
from roaml.interfaces import Definition


@pytest.mark.parametrize("file", conformance.INTERFACE_FILES, ids=lambda file: "/".join(file.parts[-3:]))
def test_conformance_file(file: Path) -> None:
    check(file)
    definition = REGISTRY.find(file.parts[-2], file.parts[-3], file.stem)  # type: ignore[arg-type]
    assert isinstance(definition, Definition)
    assert definition.path == str(file)
