# SPDX-License-Identifier: Apache-2.0
"""The knowledge about values never excludes a possible value, and excludes values that conditions rule out."""

from __future__ import annotations

import itertools
import random

import pytest

from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.parse import parse
from roaml.expr.tree import Binary, Boolean, Expr, Name, Number, Unary
from roaml.model.behavior.knowledge import NOTHING, ConditionFacts, Knowledge
from roaml.text import Decoded

FACTS = ConditionFacts(frozenset(("n", "m")), frozenset(("b", "c")))
NUMBERS, TRUTHS = range(-1, 4), (False, True)


def tree(text: str) -> Expr:
    node, findings = parse(Decoded(text, 0))
    assert not findings, text
    return node


def value(expr: Expr, values: dict[str, int | bool]) -> int | bool:
    match expr:
        case Number() | Boolean():
            return expr.value  # type: ignore[return-value]
        case Name():
            return values[expr.name]
        case Unary(operator=UnaryOperator.NOT):
            return not value(expr.operand, values)
        case Unary(operator=UnaryOperator.NEGATE):
            return -value(expr.operand, values)
        case Binary():
            left, right = value(expr.left, values), value(expr.right, values)
            return {
                Operator.AND: left and right,
                Operator.OR: left or right,
                Operator.EQUAL: left == right,
                Operator.NOT_EQUAL: left != right,
                Operator.LESS: left < right,
                Operator.LESS_EQUAL: left <= right,
                Operator.GREATER: left > right,
                Operator.GREATER_EQUAL: left >= right,
                Operator.ADD: left + right,
            }[expr.operator]
    raise AssertionError(expr)


def condition(rng: random.Random, depth: int = 2) -> str:
    if depth and rng.random() < 0.6:
        operator = rng.choice(["&&", "||"])
        text = f"({condition(rng, depth - 1)} {operator} {condition(rng, depth - 1)})"
        return f"!{text}" if rng.random() < 0.3 else text
    kind = rng.random()
    if kind < 0.3:
        return rng.choice(["b", "!c", "b == c", "b != true", "c == false", "!b == c"])
    operator = rng.choice(["==", "!=", "<", "<=", ">", ">="])
    sides = [rng.choice(["n", "m", "n + m"]), rng.choice(["n", "m", *map(str, NUMBERS)])]
    rng.shuffle(sides)
    return f"{sides[0]} {operator} {sides[1]}"


def admits(knowledge: Knowledge, values: dict[str, int | bool]) -> bool:
    for entry in knowledge.entries:
        left, _, right = entry.term.partition(" ? ")
        if right:
            one, other = value(tree(left), values), value(tree(right), values)
            relation = "=" if one == other else "<" if one < other else ">"
            if not entry.domain.admits(relation):
                return False
        elif not entry.domain.admits(value(tree(entry.term), values)):
            return False
    return True


def valuations() -> list[dict[str, int | bool]]:
    every = itertools.product(NUMBERS, NUMBERS, TRUTHS, TRUTHS)
    return [dict(zip("nmbc", values, strict=True)) for values in every]


@pytest.mark.parametrize("seed", range(150))
def test_nothing_that_is_possible_is_excluded(seed: int) -> None:
    """Three conditions in turn, each holding or not, and an assignment between them."""
    rng = random.Random(seed)
    known: list[Knowledge] = [NOTHING]
    possible = valuations()
    for _ in range(3):
        cond, holds = tree(condition(rng)), rng.random() < 0.5
        known = [after for before in known for after in FACTS.assume(before, cond, holds)]
        possible = [values for values in possible if bool(value(cond, values)) == holds]
        for values in possible:
            assert any(admits(knowledge, values) for knowledge in known), (seed, values)
        name, given = rng.choice([("n", "2"), ("n", "m"), ("b", "n < m"), ("c", "true"), ("m", "n + m")])
        known = [after for before in known for after in FACTS.assign(before, tree(name), tree(given))]
        possible = [{**values, name: value(tree(given), values)} for values in possible]
        for values in possible:
            assert any(admits(knowledge, values) for knowledge in known), (seed, values, name, given)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("n > 3", "n <= 3"),
        ("n > 3", "n < 4"),
        ("n > m", "m >= n"),
        ("n == m", "n < m || n > m"),
        ("b", "!b"),
        ("b == true", "b == false"),
        ("b && n > 0", "!b || n < 1"),
        ("b == c", "b != c"),
        ("n + m > 2", "n + m <= 2"),
        ("s == 'on'", "s != 'on'"),
        ("n >= 1 && n <= 2", "n != 1 && n != 2"),
    ],
)
def test_contraries(first: str, second: str) -> None:
    """Exactly one of two contrary conditions holds, also if nothing else is known."""
    one, other = tree(first), tree(second)
    assert FACTS.assume(NOTHING, one)
    assert not [both for known in FACTS.assume(NOTHING, one) for both in FACTS.assume(known, other)]
    assert not [none for known in FACTS.assume(NOTHING, one, False) for none in FACTS.assume(known, other, False)]


@pytest.mark.parametrize(
    ("first", "second"), [("x < 1", "x > 0"), ("n < 3", "n > 3"), ("b", "c"), ("n == 1", "n == 2")]
)
def test_conditions_that_are_not_contrary(first: str, second: str) -> None:
    """`x` may be a real."""
    one, other = tree(first), tree(second)
    neither = [n for known in FACTS.assume(NOTHING, one, False) for n in FACTS.assume(known, other, False)]
    both = [n for known in FACTS.assume(NOTHING, one) for n in FACTS.assume(known, other)]
    assert both or neither


def test_random_numbers_are_not_remembered() -> None:
    draw = tree("Math.random() < 0.5")
    assert FACTS.assume(NOTHING, draw) == FACTS.assume(NOTHING, draw, False) == (NOTHING,)


def test_stored_conditions_are_remembered() -> None:
    for known in FACTS.assign(NOTHING, tree("b"), tree("n > 2")):
        for both in FACTS.assume(known, tree("b")):
            assert not FACTS.assume(both, tree("n <= 2"))


@pytest.mark.parametrize(("array", "index"), [("a", "b"), ("b", "a")])
def test_an_assignment_to_an_element_keeps_what_is_known_about_its_index(array: str, index: str) -> None:
    facts = ConditionFacts(frozenset((index,)))
    (below,) = facts.assume(NOTHING, tree(f"{index} < 2"))
    (known,) = facts.assume(below, tree(f"{array}[{index}] == 1"))
    assert facts.assign(known, tree(f"{array}[{index}]"), tree("3")) == (below,)


def test_a_remainder_is_never_negative() -> None:
    for text, expected in (("-7 % 3", 2), ("7 % -3", 1), ("-7 % -3", 2), ("7 % 3", 1)):
        assert FACTS.value(NOTHING, tree(text)) == expected
