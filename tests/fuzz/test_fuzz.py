# SPDX-License-Identifier: Apache-2.0
"""A short sample of the cases of `run.py`, and tests that it detects failures."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Iterator

import pytest

from as2fm_lsp.server import create
from fuzz import limits, runner
from fuzz.checked import problems_of_check
from fuzz.corpus import snippets, systems
from fuzz.damage import JSON, XML
from fuzz.runner import run, run_all
from fuzz.strategies import frames, plan, strategies
from fuzz.strategies.files import make
from fuzz.strategy import Failure, Strategy
from roaml.diagnostics import Severity
from roaml.project import checking
from roaml.rules.rule import FileContext, Rule

SAMPLE = 200
"""The number of cases of all strategies together."""


@pytest.mark.parametrize(("name", "count"), plan(SAMPLE, tuple(strategies().values())))
def test_sample(name: str, count: int) -> None:
    failures = [(seed, failure) for seed in range(count) for failure in run(name, seed, bounded=False).failures]
    assert failures == []


@pytest.mark.parametrize("name", strategies())
def test_a_seed_makes_one_case(name: str) -> None:
    for seed in range(30):
        one, same = strategies()[name].make(seed), strategies()[name].make(seed)
        assert one.files() == same.files()
        assert list(one.description()) == list(same.description())


def test_every_request_of_the_project_is_sent() -> None:
    features = {name for name in create().endpoint.protocol.fm.features if name.startswith("as2fm/")}
    assert features - {"as2fm/didChangeTrust"} <= {*frames.REQUESTS, *frames.OTHERS}


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
    # Other tests check each snippet and translate each system; this one looks for false reports of the fuzzer.
    for model in (*systems()[::3], *snippets()[::4]):
        with runner.Crashes() as crashes:
            assert list(problems_of_check(model.main, model.texts, model.ros_paths)) == [], model.name
        assert crashes.errors == []


def test_an_exception_that_was_never_raised_has_a_place() -> None:
    assert runner.place(MemoryError()) == "MemoryError at an unknown place"


def test_crashes_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(context: FileContext) -> Iterator[None]:
        raise RuntimeError("on purpose")

    broken = Rule("missing-attribute", Severity.ERROR, "", file=crash)  # type: ignore[arg-type]
    monkeypatch.setattr(checking, "RULES", (broken,))
    kinds = {failure.kind.partition(" at ")[0] for failure in run("files", 0, bounded=False).failures}
    assert kinds >= {"internal-error", "RuntimeError"}


class _Bad:
    """A case that violates the limits."""

    def __init__(self, seed: int) -> None:
        self.seed = seed

    def description(self) -> Iterable[str]:
        return ()

    def files(self) -> dict[str, str | bytes]:
        return {}

    def run(self) -> Iterator[Failure]:
        match self.seed:
            case 0:
                yield Failure("wrong", "")
            case 1:
                raise RuntimeError
            case 2:
                os.abort()
            case 3:
                time.sleep(3600)
            case 4:
                bytearray(2 * limits.MEMORY)
            case 5:
                while True:
                    pass


def test_what_no_case_may_do_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(strategies(), "bad", Strategy("bad", "", _Bad))
    ran = {
        outcome.seed: outcome.failures for outcome in run_all([("bad", seed) for seed in range(7) if seed != 3], jobs=2)
    }
    monkeypatch.setattr(runner, "TIMEOUT_S", 0.5)  # of the case that never comes back, and of no other
    ran |= {outcome.seed: outcome.failures for outcome in run_all([("bad", 3)], jobs=1)}
    kinds = {seed: [failure.kind.partition(":")[0].partition(" at ")[0] for failure in ran[seed]] for seed in ran}
    died = ["the process died (exit code -6)"]
    assert kinds == {
        0: ["wrong"],
        1: ["RuntimeError"],
        2: died,
        3: ["hangs"],
        4: ["out of memory"],
        5: ["out of time"],
        6: [],
    }


def test_plan_gives_every_strategy_its_share() -> None:
    chosen = (Strategy("a", "", _Bad, share=9), Strategy("b", "", _Bad))
    assert plan(100, chosen) == [("a", 90), ("b", 10)]
    assert plan(2, chosen) == [("a", 1), ("b", 1)]
