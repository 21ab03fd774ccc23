# SPDX-License-Identifier: Apache-2.0
"""The values of a machine contain every value that occurs, and the bounds of loops are those of their conditions."""

from __future__ import annotations

import itertools
import operator
import random

import pytest

from roaml.expr.operators import Operator
from roaml.expr.parse import parse
from roaml.expr.tree import Expr
from roaml.model.values.describe import described
from roaml.model.values.domain import ANYTHING, Origin, ValueSet, between, exactly, interval, join, listed, meet, widen
from roaml.model.values.evaluate import Evaluator, compared
from roaml.model.values.strides import Stride, aligned
from roaml.text import Decoded

COMPARISONS = {
    Operator.EQUAL: operator.eq,
    Operator.NOT_EQUAL: operator.ne,
    Operator.LESS: operator.lt,
    Operator.LESS_EQUAL: operator.le,
    Operator.GREATER: operator.gt,
    Operator.GREATER_EQUAL: operator.ge,
}
SETS = [*map(listed, itertools.chain.from_iterable(itertools.combinations(range(-1, 3), n) for n in (1, 2)))]
SETS += [between(low, high) for low in range(-2, 2) for high in range(low + 1, 3)]


def members(values: ValueSet) -> list[int]:
    return [n for n in range(-3, 4) if values.includes(n)]


@pytest.mark.parametrize("symbol", COMPARISONS, ids=lambda symbol: symbol.symbol)
def test_a_comparison_has_exactly_its_possible_results(symbol: Operator) -> None:
    for left, right in itertools.product(SETS, SETS):
        results = {COMPARISONS[symbol](a, b) for a, b in itertools.product(members(left), members(right))}
        assert compared(symbol, left, right).only == results, (left, right)


def test_join_and_meet_contain_the_members() -> None:
    for first, second in itertools.product(SETS, SETS):
        assert {*members(first), *members(second)} <= {*members(join(first, second))}
        assert {*members(first)} & {*members(second)} == {*members(meet(first, second))}


def test_a_widened_set_grows_a_few_times_only() -> None:
    values, steps = between(0, 1), 0
    while (
        grown := widen(values, join(values, between(0, values.high + 1, Origin.REACHED, values.high_from)), [5, 9])
    ) != values:
        values, steps = grown, steps + 1
    assert steps <= 4
    assert (values.low, values.low_from) == (0, Origin.REACHED)
    assert values.high_from is Origin.WIDENED


def tree(text: str) -> Expr:
    expr, findings = parse(Decoded(text, 0))
    assert not findings, text
    return expr


def run(text: str, values: dict[str, int]) -> object:
    python = text.replace("&&", " and ").replace("||", " or ").replace("!(", " not (")
    return eval(python, {}, dict(values))


def random_condition(source: random.Random, depth: int) -> str:
    if depth and source.random() < 0.6:
        parts = [random_condition(source, depth - 1) for _ in range(2)]
        return source.choice(["({} && {})", "({} || {})", "!({})"]).format(*parts)
    terms = [random_term(source) for _ in range(2)]
    return f"({terms[0]} {source.choice(['<', '<=', '==', '!=', '>', '>='])} {terms[1]})"


def random_term(source: random.Random) -> str:
    return source.choice(["x", "y", "x + 1", "x - y", "x * y", "-y", "2", "0", "-1", "3 - x"])


def test_conditions_keep_every_value_with_which_they_hold() -> None:
    source = random.Random(31)
    evaluator = Evaluator(lambda _: True)
    for _ in range(1500):
        text = random_condition(source, 3)
        known = {"x": source.choice(SETS), "y": source.choice(SETS)}
        condition = tree(text)
        results = evaluator.values(known, condition)
        kept = {holds: evaluator.assume(known, condition, holds) for holds in (True, False)}
        for x, y in itertools.product(members(known["x"]), members(known["y"])):
            holds = bool(run(text, {"x": x, "y": y}))
            assert results.includes(holds), (text, x, y)
            rest = kept[holds]
            assert rest is not None, (text, x, y, known)
            assert rest["x"].includes(x), (text, x, y, known)
            assert rest["y"].includes(y), (text, x, y, known)


def test_terms_contain_every_result() -> None:
    evaluator = Evaluator(lambda _: True)
    texts = ["x + y", "x - y", "x * y", "x % 3", "-x", "x > y ? x : y", "(x < y) == (y > x)", "x * x - y"]
    for text, left, right in itertools.product(texts, SETS, SETS):
        values = evaluator.values({"x": left, "y": right}, tree(text))
        for x, y in itertools.product(members(left), members(right)):
            results = {"x > y ? x : y": max(x, y), "(x < y) == (y > x)": True}
            result = results[text] if text in results else run(text, {"x": x, "y": y})
            assert values.includes(result), (text, x, y, values)  # type: ignore[arg-type]


def test_unknown_values_stay_unknown() -> None:
    evaluator = Evaluator(lambda _: True)
    assert evaluator.values({}, tree("x")) == ANYTHING
    assert evaluator.values({"x": exactly("a")}, tree("x == y")).only == {True, False}


def test_strings_are_described_as_literals() -> None:
    assert described(listed(["a'b\n", ""])) == "`''` or `'a\\'b\\n'`"


@pytest.mark.parametrize("modulus", range(2, 6))
def test_aligned_values_are_those_with_the_stride(modulus: int) -> None:
    for values, rest in itertools.product(SETS, range(modulus)):
        expected = [n for n in members(values) if n % modulus == rest]
        found = aligned(values, Stride(modulus, rest))
        assert [n for n in members(found) if n % modulus == rest] == expected, (values, rest)
        assert not expected or (interval(found).low, interval(found).high) == (expected[0], expected[-1])


def test_a_remainder_is_less_than_the_divisor() -> None:
    known = {"x": between(0, 100)}
    assert interval(Evaluator(lambda _: True).values(known, tree("x % 3"))).high == 2
    assert interval(Evaluator(lambda _: False).values(known, tree("x % 3"))).high == 3
