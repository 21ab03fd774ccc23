# SPDX-License-Identifier: Apache-2.0
"""A short sample of what `run.py` does at length, and that it would notice."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from fuzz.cases import make, run
from fuzz.corpus import snippets, systems
from fuzz.damage import JSON, XML
from roaml.diagnostics import Severity
from roaml.project import checking
from roaml.rules.rule import FileContext, Rule

SAMPLE = 400


def test_sample() -> None:
    failures = [(seed, failure) for seed in range(SAMPLE) for failure in run(make(seed), timed=False)]
    assert failures == []


def test_a_seed_makes_one_case() -> None:
    for seed in range(50):
        assert make(seed) == make(seed)


def test_cases_damage_something() -> None:
    cases = [make(seed) for seed in range(100)]
    assert sum(case.texts != case.model.texts for case in cases) > 80
    assert len({case.model.name for case in cases}) > 30


def test_every_way_is_taken() -> None:
    taken = {how.partition(" in ")[0] for seed in range(500) for how in make(seed).damage}
    assert taken >= {way.__name__ for way in (*XML, *JSON)}


def test_undamaged_models_hold() -> None:
    assert systems()
    assert len(snippets()) > 100
    for model in (*systems(), *snippets()):
        case = make(0)
        case.model, case.texts, case.main = model, model.texts, model.main
        assert run(case, timed=False) == [], model.name


def test_crashes_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(context: FileContext) -> Iterator[None]:
        raise RuntimeError("on purpose")

    broken = Rule("missing-attribute", Severity.ERROR, "", file=crash)  # type: ignore[arg-type]
    monkeypatch.setattr(checking, "RULES", (broken,))
    kinds = {failure.kind.partition(" at ")[0] for failure in run(make(0), timed=False)}
    assert kinds >= {"internal-error", "RuntimeError"}
