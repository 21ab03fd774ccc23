# SPDX-License-Identifier: Apache-2.0
"""Messages of the rules about answers: which node waits for which, where the first answer was, and what to do."""

from __future__ import annotations

from pathlib import Path

from checked import check_text
from fixture import read_cases

FOLDER = Path(__file__).parents[1] / "rules" / "cases" / "one_report"


def messages_of(folder: Path, file: str, title: str, code: str) -> list[tuple[str, list[tuple[int, str]]]]:
    """The messages of a rule for one of the cases in `FOLDER`, with the offset and text of the related places."""
    case = next(case for case in read_cases(FOLDER / f"{file}.txt") if case.title == title)
    diagnostics, _ = check_text(folder, case.text)
    return [
        (diagnostic.message, [(place.location.span.start, place.message) for place in diagnostic.related])
        for diagnostic in diagnostics
        if diagnostic.code == code
    ]


def test_the_result_is_named_and_not_the_feedback(tmp_path: Path) -> None:
    [(message, _)] = messages_of(tmp_path, "paths_time", "feedback comes before the result", "answer-needs-time")
    assert message.startswith("the status of a tick waits for the result of `/draw`, which takes time: ")


def test_both_answers_in_one_body_are_named(tmp_path: Path) -> None:
    [(message, related)] = messages_of(tmp_path, "paths_tick", "two answers in one body", "repeated-answer")
    assert "by `<bt_return_status>` and then by `<bt_return_status>`, both in the `<bt_tick>` of the state" in message
    assert [text for _, text in related] == ["the first answer", "the second answer"]


def test_the_first_answer_of_an_earlier_step_is_named(tmp_path: Path) -> None:
    title = "answered at once and again when the response comes"
    [(message, related)] = messages_of(tmp_path, "paths_tick", title, "repeated-answer")
    assert "the tick was already answered by `<bt_return_status>` in the `<bt_tick>` of the state `a`" in message
    assert [text for _, text in related] == ["the first answer", "the second answer"]
    assert related[0][0] < related[1][0]


def test_the_answer_on_entering_a_state_is_named(tmp_path: Path) -> None:
    title = "answered in the body and again when the state is entered"
    [(message, _)] = messages_of(tmp_path, "paths_tick", title, "repeated-answer")
    assert ", then by `<bt_return_status>` in the `<onentry>` of the state " in message


def test_a_halt_names_the_plugin_that_runs(tmp_path: Path) -> None:
    [(message, _)] = messages_of(tmp_path, "paths_tick", "a waiting state that takes no halt", "unanswered-halt")
    assert message.startswith("a halt that arrives while the plugin is running in the state `c`")


def test_the_variable_with_the_new_goal_is_named(tmp_path: Path) -> None:
    title = "the running goal is rejected instead of the new one"
    [(message, _)] = messages_of(tmp_path, "paths_goal", title, "wrong-goal-id")
    assert message.endswith(
        "holds the id of an earlier goal, not of the one that has just arrived; use `other` as `goal_id`"
    )


def test_one_mistake_with_an_id_gives_one_advice(tmp_path: Path) -> None:
    """The variable has no value on one path, and on another one the id of a rejected goal."""
    [(message, _)] = messages_of(tmp_path, "paths_goal", "ended by a variable of rejected goals only", "wrong-goal-id")
    assert "was rejected; store the id of the accepted goal in another variable" in message


def test_constants_name_the_client_that_they_mean(tmp_path: Path) -> None:
    [(message, related)] = messages_of(tmp_path, "paths_goal", "a constant id with two clients", "wrong-goal-id")
    assert "which is always the id of `Client`, but `/draw` has 2 clients" in message
    assert [text for _, text in related] == ["also used here"]


def test_the_state_in_which_a_lost_tick_arrived_is_named(tmp_path: Path) -> None:
    title = "the handler of the response does not answer"
    [(message, related)] = messages_of(tmp_path, "paths_tick", title, "unanswered-tick")
    assert message.startswith("the tick that arrived in the state `")
    assert related[0][1] == "the tick arrives"
