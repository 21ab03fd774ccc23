# SPDX-License-Identifier: Apache-2.0
"""A sample of the pairs of errors of `run.py --pairs`, and a test that it detects hidden errors."""

from __future__ import annotations

import pytest

from fuzz.pairs import Mistake, Outcome, base, choose, mistakes, outcome, report
from roaml.model.system import System

SAMPLE = 60


def test_the_base_is_sound() -> None:
    assert report(base()).findings == frozenset()


def test_there_are_many_mistakes_in_all_files() -> None:
    assert len(mistakes()) > 900
    assert {mistake.file for mistake in mistakes()} == set(base())


def test_sample() -> None:
    outcomes = {seed: outcome(*choose(seed)) for seed in range(SAMPLE)}
    assert {seed: pair_outcome for seed, pair_outcome in outcomes.items() if pair_outcome[0] is Outcome.LOST} == {}
    assert sum(pair_outcome[0] is Outcome.BOTH for pair_outcome in outcomes.values()) >= 0.95 * SAMPLE


def mistake(file: str, old: str, new: str) -> Mistake:
    text = base()[file]
    assert text.count(old) == 1
    return Mistake(file, f"{old} -> {new}", text.replace(old, new))


UNKNOWN = mistake("battery.ascxml", '<state id="saved" />', '<state id="saved" /><foo/>')
TYPO = mistake("dashboard.ascxml", 'topic="/battery/level"', 'topic="/battery/levle"')


def test_an_unknown_element_hides_no_topic() -> None:
    assert outcome(UNKNOWN, TYPO) == (Outcome.BOTH, "")


def test_a_declaration_that_cannot_be_read_hides_what_it_could_be() -> None:
    unnamed = mistake("motor.ascxml", 'topic="/arrived"', 'topic=""')
    assert outcome(unnamed, TYPO) == (Outcome.HELD_BACK, "topic-without-publisher in dashboard.ascxml")


def test_a_missing_finding_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulates rules that check again whether the whole system can be read."""
    both = choose(0)
    assert outcome(*both)[0] is Outcome.BOTH
    monkeypatch.setattr(System, "may", lambda system, act, name, automaton=None: bool(system.possible))
    assert outcome(UNKNOWN, mistake("tree.xml", 'service="/motor/drive"', 'service="/motor/driv"'))[0] is Outcome.BOTH
    misread = mistake("painter.ascxml", '<ros_action_server name="paint"', '<ros_action_server nam="paint"')
    assert outcome(misread, TYPO)[0] is not Outcome.BOTH
