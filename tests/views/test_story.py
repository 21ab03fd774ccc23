# SPDX-License-Identifier: Apache-2.0
"""Stories of traces: as a whole for a robot and its bug, and of models that were not translated."""

from __future__ import annotations

import html
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from roaml import api
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE
from roaml.smc.record import Recorder
from roaml.smc.story import Story, build_story
from roaml.text import Location
from roaml.views.cause import cause
from roaml.views.folding import LeftOut, Repetition, folded, without_middle
from roaml.views.story import MAX_COLUMNS, as_html, as_mermaid, as_text, lines
from roaml.views.turns import turns

HERE = Path(__file__).parent
ROBOT = HERE.parents[1] / "examples/assembly_robot"
DROPPED = 446
"""A trace in which the robot with its bug loses the block."""
EMPTY = 372
"""A trace in which a robot that charges too late stands still."""

PlaceOf = Callable[[Location], str]


@pytest.fixture(scope="module")
def bug() -> tuple[Story, PlaceOf]:
    subject = api.as_target(api.load(str(ROBOT / "main_with_bug.xml")))
    ready = api.checker(subject.model, ["never_placed_empty"])
    story = build_story(Recorder(ready, ready.compiled_properties[0], 0, 10_000), DROPPED, subject.clock)

    def place_of(origin: Location) -> str:
        path, line, _ = subject.place(origin) or ("", 0, 0)
        return f"{Path(path).name}:{line}"

    return story, place_of


@pytest.mark.parametrize(("name", "notation"), [("story.txt", as_text), ("story.mmd", as_mermaid)])
def test_as_a_whole(bug: tuple[Story, PlaceOf], name: str, notation: Callable[[Story, PlaceOf], str]) -> None:
    assert notation(*bug) == (HERE / name).read_text(encoding="utf-8")


def rows_of(page: str) -> list[list[tuple[str, str]]]:
    """The rows of the first table: the attributes and the texts of its cells, without those that are empty."""
    table = page.partition("<tbody>")[2].partition("</tbody>")[0]
    rows = [re.findall(r"<t[hd]([^>]*)>(.*?)</t[hd]>", row) for row in table.split("</tr>") if row]
    return [[(attributes, re.sub("<[^>]*>", "", text)) for attributes, text in row if text] for row in rows]


def test_a_page_with_many_automata_has_a_column_of_names(bug: tuple[Story, PlaceOf]) -> None:
    story, place_of = bug
    page = as_html([story], place_of, "why <now>")
    assert "why &lt;now&gt;" in page
    assert "<th scope='col'>who</th><th scope='col'>what</th></tr>" in page
    shown = lines(story, place_of)
    assert len({line.who for line in shown if line.who}) > MAX_COLUMNS
    named = [[text for attributes, text in row if "who" in attributes] for row in rows_of(page)]
    assert named == [[html.escape(line.who)] if line.who else [] for line in shown]
    assert "<ul></ul>" not in page  # screen readers announce it


def test_a_page_with_few_automata_has_a_column_for_each() -> None:
    subject = api.as_target(api.load(str(ROBOT.parent / "battery" / "main.xml")))
    ready = api.checker(subject.model, ["all_delivered"])
    story = build_story(Recorder(ready, ready.compiled_properties[0], 0, 10_000), DROPPED, subject.clock)
    shown = lines(story, lambda _: "a`b")
    names = {line.who for line in shown if line.who}
    page = as_html([story], lambda _: "main.xml:1", "t", file_of=lambda _: "/all of it's path/main.xml:1")
    assert 1 < len(names) <= MAX_COLUMNS
    assert all(page.count(f"<th scope='col'>{name}</th>") == 1 for name in names)
    assert "<small title='/all of it&#x27;s path/main.xml:1'>main.xml:1</small>" in page


def test_forwarding_steps_are_omitted() -> None:
    """A handler is between a client and its server, and the answer contains a text with its length."""
    folder = ROBOT.parent / "delivery_robot"
    texts = {str(folder / "tree.xml"): (folder / "tree.xml").read_text().replace('level="30"', 'level="0"')}
    subject = api.as_target(api.load(str(folder / "main.xml"), texts=texts))
    ready = api.checker(subject.model, ["never_empty"])
    story = build_story(Recorder(ready, ready.compiled_properties[0], 0, 10_000), EMPTY, subject.clock)
    story_lines = lines(story, lambda _: "")
    assert {line.who for line in story_lines if line.who} == {
        "Battery",
        "BatteryAbove",
        "ReactiveFallback",
        "Deliver",
        "Building",
    }
    event_phrase = [text for line in story_lines for text in (line.what, *line.details)]
    assert "sends the response of /hand_over (success: true, message: 'taken')" in event_phrase
    assert not [text for text in event_phrase if "_client_" in text or "_len" in text]


def walked(written: Json) -> Story:
    ready = ModelChecker(model(written))
    return build_story(Recorder(ready, ready.compiled_properties[0], 0, 1000), 0)


def test_steps_of_hand_written_models_are_listed_one_by_one() -> None:
    both = [edge("s", "t", action="meet"), edge("t", way("u", x=op("+", "x", 1)))]
    written = document(
        automaton("a", "s t u", both),
        automaton("b", "s t", [edge("s", "t", action="meet")]),
        variables=[variable("x")],
        system={
            "elements": [{"automaton": "a"}, {"automaton": "b"}],
            "syncs": [{"synchronise": ["meet", "meet"], "result": "meet"}],
        },
        properties={"p": probability(op("F", op("=", "x", 1)))},
    )
    story = walked(written)
    story_lines = [(line.who, line.what, line.details) for line in lines(story, lambda _: "here")]
    assert story_lines == [("a", "meet: s → t", ()), ("b", "meet: s → t", ()), ("a", "t → u", ("x: 0 → 1",))]


def test_the_probability_of_an_outcome_is_shown_if_it_does_not_depend_on_the_state() -> None:
    """A probability may be computed from constants; the other one depends on a variable."""
    known = edge("s", way("t", op("/", "k", 4), x=1), way("t", op("-", 1, op("/", "k", 4)), x=1))
    unknown = edge("t", way("u", op("/", "y", 4), x=2), way("u", op("-", 1, op("/", "y", 4)), x=2))
    written = document(
        automaton("a", "s t u", [known, unknown]),
        variables=[variable("x"), variable("y", initial=2)],
        properties={"p": probability(op("F", op("=", "x", 2)))},
    )
    written["constants"] = [{"name": "k", "type": "int", "value": 2}]
    odds = [next(iter(line.details)) for line in lines(walked(written), lambda _: "")]
    assert odds == ["by chance, 0.5", "by chance"]


def test_repetitions_are_folded() -> None:
    count = edge("s", way("s", x=op("+", "x", 1)))
    goal = {"p": probability(op("F", op("=", "x", 9)))}
    story = walked(document(automaton("a", "s", [count]), variables=[variable("x")], properties=goal))
    assert len(turns(story)) == 9
    story_lines = [(line.step, line.what, line.details) for line in lines(story, lambda _: "")]
    assert story_lines == [(1, "s", ("x: 0 → 1",)), (2, "… 7 more times …", ()), (9, "s", ("x: 8 → 9",))]
    assert "… 7 more times …" in as_mermaid(story, lambda _: "")
    assert [row[-1][1] for row in rows_of(as_html([story], lambda _: "", "t"))] == [
        "sx: 0 → 1",
        "… 7 more times …",
        "sx: 8 → 9",
    ]
    assert as_text(story, lambda _: "a.jani").startswith("p holds: a s and x: 8 → 9")


def test_periods_that_consist_of_periods_are_folded() -> None:
    day = [*["tick"] * 5, "charge"]
    assert folded([*day * 4, None]) == [0, Repetition(1, 4, 1, 4), 5, Repetition(3, 3, 6, 23), 24]


def test_different_lines_are_not_folded() -> None:
    assert folded(["a", "b", "c", "a", "b", "c"]) == [0, 1, 2, 3, 4, 5]
    assert folded([None, None, None]) == [0, 1, 2]


def test_the_middle_of_a_long_story_is_left_out() -> None:
    shown = without_middle(list(range(20)), 3, 5)
    assert shown == [0, 1, 2, LeftOut(3, 14), 15, 16, 17, 18, 19]
    assert without_middle(shown, 3, 5) == shown


def test_the_first_line_names_the_leaf_that_failed() -> None:
    folder = ROBOT.parent / "case_study"
    subject = api.as_target(api.load(str(folder / "main_with_bug.xml")))
    ready = api.checker(subject.model, ["recovers_or_succeeds"])
    recorder = Recorder(ready, ready.compiled_properties[0], 0, 10_000)
    failing = next(n for n in range(100) if build_story(recorder, n, subject.clock).recording.verdict == FALSE)
    sentence = cause(build_story(recorder, failing, subject.clock), lambda _: "")
    assert re.fullmatch(
        r"recovers_or_succeeds fails at \d+\.000 s: the tree ends with FAILURE, "
        r"because MoveBlock returns FAILURE",
        sentence,
    )
