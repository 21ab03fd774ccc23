# SPDX-License-Identifier: Apache-2.0
"""The model checker on models that another translator has made from the conformance models: it must estimate the
expected probabilities."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import pytest

import conformance
from roaml.jani.model import Model
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.run import Options

CASES = conformance.verified()


def reference(case: dict[str, Any]) -> Path:
    path = Path(case["model"])
    return conformance.ROOT / "reference" / f"{path.parts[1]}.{path.stem}.jani.gz"


def load(path: Path) -> Model:
    value, _ = parse(gzip.decompress(path.read_bytes()).decode())
    model, _ = read_model(value, str(path))
    assert model is not None
    return model


@pytest.mark.parametrize("path", sorted({reference(case) for case in CASES}), ids=lambda path: path.name)
def test_reference_translations(path: Path) -> None:
    model = load(path)
    expected = {case["property"]: case for case in CASES if reference(case) == path}
    checker = ModelChecker(model, [p for p in model.properties if p.name in expected])
    with Pool() as pool:
        for property_ in checker.compiled_properties:
            case = expected[property_.question.name]
            answer = checker.answer(property_, Options(seed=1), pool)
            assert answer.value == pytest.approx(case["probability"], abs=case["tolerance"] + 1e-12)
