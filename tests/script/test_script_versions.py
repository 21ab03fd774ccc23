# SPDX-License-Identifier: Apache-2.0
"""The grammar of scripts before version 4.9 of BehaviorTree.CPP (docs/spec/scripts.md#before).

If `behaviortreepy` is installed, which binds version 4.8.2, the library judges: it refuses the same random scripts, and
the others have the same value as with all brackets.
"""

from __future__ import annotations

from html import escape
from importlib import util
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bracketed_script import with_brackets
from examples import TIMES, examples
from roaml.script.parse import ScriptGrammar, parse
from roaml.text import Decoded


def read(text: str, grammar: ScriptGrammar) -> str:
    """The last statement of a script with all brackets, or the first syntax error."""
    script, problems = parse(Decoded(text, 0), grammar)
    return problems[0].message if problems else with_brackets(script.statements[-1])


@pytest.mark.parametrize(
    ("text", "before", "now"),
    [
        ("10 - 3 - 2", "(10 - (3 - 2))", "((10 - 3) - 2)"),
        ("100 / 10 * 5", "(100 / (10 * 5))", "((100 / 10) * 5)"),
        ("1 - 2 * 3 - 4", "(1 - ((2 * 3) - 4))", "((1 - (2 * 3)) - 4)"),
        ("4 ^ 1 | 5", "((4 ^ 1) | 5)", "((4 ^ 1) | 5)"),
        ("1 || 0 && 0", "((1 || 0) && 0)", "(1 || (0 && 0))"),
        ("1 < 2 == 2", "(1 < 2 == 2)", "(1 < 2 == 2)"),
        ("a := 1; b := 2", "(b := 2)", "(b := 2)"),
    ],
)
def test_precedences(text: str, before: str, now: str) -> None:
    assert (read(text, ScriptGrammar.BEFORE_4_9), read(text, ScriptGrammar.CURRENT)) == (before, now)


@pytest.mark.parametrize(
    ("text", "message", "now"),
    [
        ("1 + 2 & 3", "cannot mix `&` with arithmetic; use brackets", "((1 + 2) & 3)"),
        ("~0 == 0 - 1", "cannot mix `-` with operators on bits; use brackets", "((~0) == (0 - 1))"),
        ("'a' .. 5 - 2", "cannot mix `-` with `..`; use brackets", "(('a' .. 5) - 2)"),
        ("2 * !0", "cannot mix `!` with arithmetic; use brackets", "(2 * (!0))"),
        ("1 ? 2 : 0 ? 3 : 4", "allow a second `?` only in brackets", "(1 ? 2 : (0 ? 3 : 4))"),
        ("a := b := 1", "allow a second `:=` only in brackets", "(a := (b := 1))"),
        ("a := 1 b := 2", "require a `;` before `b`", "(b := 2)"),
        ("a := 1;", "require a statement after each `;`; remove this `;`", "(a := 1)"),
        ("a := 1;; b := 2", "require a statement after each `;`; remove this `;`", "(b := 2)"),
    ],
)
def test_scripts_that_were_errors(text: str, message: str, now: str) -> None:
    assert read(text, ScriptGrammar.BEFORE_4_9) == f"versions of BehaviorTree.CPP before 4.9 {message}"
    assert read(text, ScriptGrammar.CURRENT) == now


@pytest.mark.parametrize("text", ["(1 + 2) & 3", "1 ? 4 & 5 : 6 + 1", "0 ? 1 ? 2 : 3 : 4", "a := (b := 1)"])
def test_brackets_separate_operators(text: str) -> None:
    assert read(text, ScriptGrammar.BEFORE_4_9) == read(text, ScriptGrammar.CURRENT)


def larger(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    operators = st.sampled_from(("+", "-", "*", "/", "&", "|", "^", "&&", "||", "==", "!=", "<", ">="))
    return st.one_of(
        st.tuples(parts, operators, parts).map(" ".join),
        st.tuples(parts, operators, parts).map(" ".join),
        st.tuples(parts, parts, parts).map(lambda three: "{} ? {} : {}".format(*three)),
        st.tuples(st.sampled_from("-~!"), parts).map("".join),
        parts.map("({})".format),
    )


SCRIPTS = st.recursive(st.sampled_from(("0", "1", "2", "3", "7")), larger, max_leaves=7)


def value_of(library: Any, text: str) -> float | None:
    """The value of an expression; `None` if the library refuses the script. Not all values can be computed."""
    factory, board = library.BehaviorTreeFactory(), library.Blackboard.create()
    tree = f'<BehaviorTree ID="A"><Script code="r := {escape(text)}"/></BehaviorTree>'
    factory.register_behavior_tree_from_text(f'<root BTCPP_format="4">{tree}</root>')
    try:
        created = factory.create_tree("A", board)
    except RuntimeError:
        return None
    try:
        created.tick_exactly_once()
    except RuntimeError:
        return float("nan")
    value: float = board.get_double("r")
    return value


if util.find_spec("behaviortreepy") is None:
    print("behaviortreepy is not installed: BehaviorTree.CPP itself does not judge the grammar of scripts")
else:

    @settings(max_examples=examples(300), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
    @given(SCRIPTS)
    def test_random_scripts_are_read_as_by_behaviortree_cpp(text: str) -> None:
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        script, problems = parse(Decoded(text, 0), ScriptGrammar.BEFORE_4_9)
        value = value_of(behaviortreepy, text)
        assert (value is None) is bool(problems), (text, [problem.message for problem in problems])
        if value is not None:
            expected = value_of(behaviortreepy, with_brackets(script.statements[0]))
            assert repr(value) == repr(expected), text  # also if both are not numbers
