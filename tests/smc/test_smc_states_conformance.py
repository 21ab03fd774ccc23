# SPDX-License-Identifier: Apache-2.0
"""Traces over states that were expanded before are those of the kernel, for all conformance systems and all models of
the Quantitative Verification Benchmark Set that are beside the project."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_smc_states import NO_PAYLOAD, results, with_nodes

import conformance
from conformance_systems import load
from roaml import api
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.batch import Simulator, Task, run_on
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker

MODELS = sorted((conformance.ROOT.parent / "qvbs").glob("*.jani"))
TRACES, STEPS = 30, 1500


def assert_same(checker: ModelChecker) -> None:
    for property_ in checker.compiled_properties:
        questions = (0, 1) if property_.question.is_conditional else (0,)
        compiled = checker.compiled(property_)
        task = Task(NO_PAYLOAD, 5, 0, TRACES, STEPS, 0, questions)
        assert results(run_on(with_nodes(compiled), task)) == results(run_on(Simulator(compiled, 0), task))


@pytest.mark.parametrize("path", conformance.systems(), ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_systems(path: Path) -> None:
    assert_same(api.checker(api.to_jani(load(path))))


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_models(path: Path) -> None:
    value, _ = parse(path.read_text(encoding="utf-8-sig"))
    model, _ = read_model(value, path.name)
    assert model is not None
    try:
        checker = ModelChecker(model)
    except FaultError:  # `test_qvbs_conformance.py` lists the models that are refused
        return
    assert_same(checker)
