# SPDX-License-Identifier: Apache-2.0
"""What holds for any script: no exception, places inside the text, and what is written out is read back."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from bracketed_script import with_brackets
from roaml.script.infer import Type, check_types, type_of
from roaml.script.parse import ASSIGNMENTS, BINARY, COMPARISONS, MAX_DEPTH, MAX_PROBLEMS, UNARY, parse
from roaml.script.tree import (
    Assignment,
    Binary,
    Boolean,
    Comparison,
    Conditional,
    Expr,
    Name,
    Number,
    Script,
    String,
    Unary,
    children,
    walk,
)
from roaml.text import Decoded, Span

NOWHERE = Span(0, 0)
NAMES = st.from_regex(r"[a-z_@][a-z0-9_]{1,4}", fullmatch=True).filter(
    lambda n: n not in ("true", "false", "and", "or", "not")
)
LEAVES: st.SearchStrategy[Expr] = st.one_of(
    st.integers(0, 2**63 - 1).map(lambda value: Number(NOWHERE, value)),
    st.floats(0, 1e300, allow_nan=False).map(lambda value: Number(NOWHERE, value)),
    st.booleans().map(lambda value: Boolean(NOWHERE, value)),
    st.text(st.characters(exclude_characters="'", codec="utf-8"), max_size=5).map(lambda text: String(NOWHERE, text)),
    NAMES.map(lambda name: Name(NOWHERE, name)),
)


def larger(parts: st.SearchStrategy[Expr]) -> st.SearchStrategy[Expr]:
    comparisons = st.lists(st.sampled_from(COMPARISONS), min_size=1, max_size=3).flatmap(
        lambda operators: st.lists(parts, min_size=len(operators) + 1, max_size=len(operators) + 1).map(
            lambda operands: Comparison(NOWHERE, tuple(operators), NOWHERE, tuple(operands))
        )
    )
    return st.one_of(
        st.builds(Unary, st.just(NOWHERE), st.sampled_from(UNARY), parts),
        st.builds(Binary, st.just(NOWHERE), st.sampled_from(list(BINARY)), st.just(NOWHERE), parts, parts),
        comparisons,
        st.builds(Conditional, st.just(NOWHERE), parts, parts, parts),
        st.builds(
            Assignment,
            st.just(NOWHERE),
            st.sampled_from(ASSIGNMENTS),
            st.just(NOWHERE),
            NAMES.map(lambda name: Name(NOWHERE, name)),
            parts,
        ),
    )


SCRIPTS = st.lists(st.recursive(LEAVES, larger, max_leaves=12), min_size=1, max_size=3)


def structure(expr: Expr) -> object:
    """An expression without its places."""
    match expr:
        case Number(value=value) | Boolean(value=value) | String(value=value):
            return value
        case Name(name=name):
            return f"name {name}"
    operators = getattr(expr, "operators", getattr(expr, "operator", ""))
    return (type(expr).__name__, operators, *(structure(child) for child in children(expr)))


@given(SCRIPTS)
def test_written_scripts_are_parsed_back(statements: list[Expr]) -> None:
    script, problems = parse(Decoded("; ".join(map(with_brackets, statements)), 0))
    assert problems == ()
    assert [structure(statement) for statement in script.statements] == [
        structure(statement) for statement in statements
    ]


PIECES = st.lists(
    st.sampled_from(
        [
            *("a", "@b", "true", "1", "0x", "2.5", "3.", ".", "'x'", "'", '"', "(", ")", "?", ":", ";", "$", " ", "é"),
            *("++", *ASSIGNMENTS, *COMPARISONS, *UNARY, *BINARY),
        ]
    ),
    max_size=25,
).map("".join)


@given(st.one_of(PIECES, st.text(max_size=30)))
def test_any_text_gives_a_script(text: str) -> None:
    script, problems = parse(Decoded(text, 7))
    assert len(problems) <= MAX_PROBLEMS
    for span in [*(problem.span for problem in problems), *(expr.span for expr in walk(script))]:
        assert 7 <= span.start <= span.end <= 7 + len(text)
    for expr in walk(script):
        for part in children(expr):
            assert expr.span.start <= part.span.start <= part.span.end <= expr.span.end
    list(check_types(script, lambda _: Type.UNKNOWN))


def test_deep_and_long_scripts_are_bounded() -> None:
    many = 20_000
    for text in ("(" * many, "-" * many, "a:=" * many, "1+" * many, "a?b:" * many, "((1)+1)" * many, "!" * many + "a"):
        script, problems = parse(Decoded(text, 0))
        assert problems or len(script.statements) > 1
        assert max(map(height, script.statements), default=0) <= MAX_DEPTH
    grown = "(" * 100 + "1" + "+1+1)" * 100
    script, problems = parse(Decoded(grown, 0))
    assert problems
    type_of(script.statements[0], lambda _: Type.UNKNOWN)


def height(expr: Expr) -> int:
    stack, highest = [(expr, 1)], 0
    while stack:
        part, level = stack.pop()
        highest = max(highest, level)
        stack += ((child, level + 1) for child in children(part))
    return highest


def test_chains_of_comparisons_are_flat() -> None:
    script, problems = parse(Decoded("a" + " < a" * 5000, 0))
    assert problems == ()
    assert isinstance(script, Script)
    assert len(children(script.statements[0])) == 5001
