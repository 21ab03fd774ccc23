# SPDX-License-Identifier: Apache-2.0
"""Reductions keep the answers of the conformance systems and of the Quantitative Verification Benchmark Set."""

from __future__ import annotations

from pathlib import Path

import pytest
from compared_spaces import both, check

import conformance
from roaml import api
from roaml.explicit.space import LimitError, StateLimits
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker
from roaml.verification.verifier import checker_of

INTERFACES = str(conformance.ROOT / "interfaces")


@pytest.mark.parametrize("path", conformance.systems(), ids=conformance.label)
def test_systems(path: Path) -> None:
    """Systems have the same answers, and most of them far fewer states."""
    checker = checker_of(api.target(str(path), [INTERFACES]))
    for property_ in checker.compiled_properties:
        own = checker.reduced(property_)
        question = property_ if own is checker else own.compiled_properties[0]
        try:
            spaces = both(own, question, limits=StateLimits(states=20_000))
        except LimitError:
            continue
        if spaces is not None:
            check(*spaces)


@pytest.mark.parametrize("path", sorted((conformance.ROOT.parent / "qvbs").glob("*.jani")), ids=lambda path: path.stem)
def test_benchmarks(path: Path) -> None:
    """Models of the Quantitative Verification Benchmark Set have the same answers."""
    value, _ = parse(path.read_text(encoding="utf-8"))
    read, _ = read_model(value, str(path))
    assert read is not None
    try:
        checker = ModelChecker(read)
    except FaultError:
        return
    for property_ in checker.compiled_properties:
        try:
            spaces = both(checker, property_, limits=StateLimits(states=3_000))
        except LimitError:
            continue
        if spaces is not None:
            check(*spaces)
