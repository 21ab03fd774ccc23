# SPDX-License-Identifier: Apache-2.0
"""A property made from a sentence and events: the system has no new findings, and the sentence is the one chosen."""

from __future__ import annotations

import pytest
from ide_case import path_of
from ide_models import system_file
from test_ide_actions import opened

import clock
from fixture import split_files
from mending import applied, found
from property_robot import ROBOT
from roaml.ide.new_property import ObservableEvent, PropertySentence, new_property, observable_events, sentences
from roaml.ide.verifiable import verifiable
from roaml.observers.properties import LEFT, Pattern, ScopeKind
from roaml.project.workspace import Snapshot

MAIN = path_of("main.xml")
WITHOUT_FILE = "".join(f"-- {name} --\n{text}\n" for name, text in clock.FILES.items())


def events(snapshot: Snapshot) -> dict[str, ObservableEvent]:
    return {event.clause: event for event in observable_events(snapshot.analysis, MAIN)}


def test_events_are_those_that_the_system_sends() -> None:
    assert list(events(opened(WITHOUT_FILE)[0])) == ["a message is published on `/ticks`"]
    of_robot = list(events(opened(ROBOT)[0]))
    assert "`/charge` is called" in of_robot
    assert "a result of `/count` is sent" in of_robot
    assert "`right_pick` answers" in of_robot
    assert "`full` is sent" in of_robot
    assert not any("cancel" in clause for clause in of_robot)


def test_sentences_need_a_clock_only_for_time() -> None:
    chosen = [*sentences(opened(ROBOT)[0].analysis, MAIN)]
    assert [s.text for s in chosen[:2]] == ["Whenever A happens, B happens then or later", "A happens at some time"]
    assert {s.pattern for s in chosen if s.needs_time} == {Pattern.RECURRENCE}
    machine = '<ascxml name="M" version="1.0" initial="a"><state id="a"><transition target="b"><send event="e" />'
    machine += '</transition></state><state id="b" /></ascxml>'
    without_clock = opened(
        f"-- main.xml --\n{system_file('node_models node-ascxml m.ascxml')}\n-- m.ascxml --\n{machine}\n"
    )[0]
    assert not any(s.needs_time for s in sentences(without_clock.analysis, MAIN))


@pytest.mark.parametrize("files", [WITHOUT_FILE, ROBOT], ids=["new file", "known file"])
def test_every_sentence_makes_a_property_without_findings(files: str) -> None:
    snapshot = opened(files)[0]
    known = [*events(snapshot).values()]
    before = {(d.code, d.path) for d in found(snapshot)}
    for sentence in sentences(snapshot.analysis, MAIN):
        conditions = {name: known[i % len(known)] for i, name in enumerate(sentence.conditions)}
        made = new_property(snapshot.analysis, MAIN, sentence.pattern, sentence.scope, conditions, "3")
        after = snapshot.with_texts(applied(snapshot, made.change))
        # The only event of the first system is both events of a sentence.
        expected = {("repeated-operand", made.path)} if len(known) < len(conditions) else set()
        assert {(d.code, d.path) for d in found(after)} <= before | expected, sentence
        (property_,) = (p for p in verifiable(after.analysis, MAIN) if p.name == made.name)
        assert property_.path == made.path
        assert _is_said(sentence, property_.comment, [event.clause for event in conditions.values()])


def _is_said(sentence: PropertySentence, comment: str, clauses: list[str]) -> bool:
    """Whether the property says what was chosen: its conditions, and the words for the scope."""
    words = {ScopeKind.GLOBALLY: "", ScopeKind.AFTER: "From the first time", ScopeKind.BEFORE: "Before the first time"}
    subjects = [clause.split("`")[1] for clause in clauses]
    begins = words.get(sentence.scope, "Each time from when")
    return comment.startswith(begins) and all(subject in comment for subject in subjects) and "3 s" in comment


def test_a_known_port_is_used_again() -> None:
    snapshot = opened(ROBOT)[0]
    event = events(snapshot)["a message is published on `/battery/level`"]
    made = new_property(snapshot.analysis, MAIN, Pattern.EXISTENCE, ScopeKind.GLOBALLY, {LEFT: event})
    text = applied(snapshot, made.change)[path_of("properties.xml")]
    assert made.name == "measured_existence"
    before = split_files(ROBOT)["properties.xml"]
    assert text.count("<ros_topic") == before.count("<ros_topic")
    assert text.count("<property ") == before.count("<property ") + 1
