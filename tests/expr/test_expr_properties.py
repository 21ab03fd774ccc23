# SPDX-License-Identifier: Apache-2.0
"""Invariants of all expressions: precedence as in an independent parser, spans inside the text, no exceptions."""

from __future__ import annotations

import ast
from typing import Any

from expr_cases import show, tree_of
from hypothesis import given
from hypothesis import strategies as st

from roaml.expr.format import format_expr
from roaml.expr.infer import constant, infer
from roaml.expr.parse import MAX_DEPTH, MAX_FINDINGS, parse
from roaml.expr.tree import Binary, Call, Expr, Index, Member, Name, Unary, children, walk
from roaml.expr.types import BASE_TYPES, Array, Struct, Type
from roaml.text import Decoded, apply_edits

# Python's operators of the same precedence, loosest first. Each level is left-associative in both languages.
PYTHON = {
    "||": "|",
    "&&": "^",
    "==": "&",
    "!=": "&",
    "<": "<<",
    "<=": "<<",
    ">": ">>",
    ">=": ">>",
    "+": "+",
    "-": "-",
    "*": "*",
    "/": "/",
    "%": "%",
    "!": "~",
}
OPERANDS = st.sampled_from(["a", "b.c", "d[0]", "e[f].g", "Math.max(h, i)", "(j)"])


@st.composite
def operations(draw: st.DrawFn, depth: int = 0) -> list[str]:
    """The tokens of an expression, so that both languages can be written from them."""
    tokens: list[str] = []
    for _ in range(draw(st.integers(1, 5))):
        tokens += draw(st.lists(st.sampled_from(["-", "!"]), max_size=2))
        if depth < 2 and draw(st.integers(0, 3)) == 0:
            tokens += ["(", *draw(operations(depth + 1)), ")"]
        else:
            tokens.append(draw(OPERANDS))
        tokens.append(draw(st.sampled_from(["||", "&&", "==", "!=", "<", "<=", ">", ">=", "+", "-", "*", "/", "%"])))
    return tokens[:-1]


@given(operations())
def test_precedence_is_that_of_an_independent_parser(tokens: list[str]) -> None:
    expr, findings = parse(Decoded(" ".join(tokens), 0))
    assert findings == ()
    python = ast.parse(" ".join(PYTHON.get(token, token) for token in tokens), mode="eval").body
    assert structure(expr) == python_structure(python)


def structure(expr: Expr) -> object:
    match expr:
        case Binary():
            return (PYTHON[expr.operator.symbol], structure(expr.left), structure(expr.right))
        case Unary():
            return (PYTHON[expr.operator.symbol], structure(expr.operand))
        case Member():
            return (".", structure(expr.object), expr.name)
        case Index():
            return ("[]", structure(expr.object), structure(expr.index))
        case Call():
            return ("()", structure(expr.function), *map(structure, expr.arguments))
        case Name():
            return expr.name
    return show(expr)


SYMBOLS: dict[type[Any], str] = {
    ast.BitOr: "|",
    ast.BitXor: "^",
    ast.BitAnd: "&",
    ast.LShift: "<<",
    ast.RShift: ">>",
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Mod: "%",
    ast.USub: "-",
    ast.Invert: "~",
}


def python_structure(node: ast.expr) -> object:
    match node:
        case ast.BinOp():
            return (SYMBOLS[type(node.op)], python_structure(node.left), python_structure(node.right))
        case ast.UnaryOp():
            return (SYMBOLS[type(node.op)], python_structure(node.operand))
        case ast.Attribute():
            return (".", python_structure(node.value), node.attr)
        case ast.Subscript():
            return ("[]", python_structure(node.value), python_structure(node.slice))
        case ast.Call():
            return ("()", python_structure(node.func), *map(python_structure, node.args))
        case ast.Name():
            return node.id
    return ast.unparse(node)


PIECES = [
    *("a", "b", "_msg", "Math.floor", "v", "s", "p", "f", ".", ".x", ".length", "[", "]", "(", ")", "{", "}", ",", ":"),
    *("'", '"', "'t'", "`", "\\", "1", "2.5", "0x", "1e999", "0", "08", " ", "\n", "@", "#", "é", "\0", "\ud800", "٣"),
    *("+", "-", "*", "/", "%", "<", ">", "=", "==", "!", "&&", "||", "?", "&", "|", "^", "~", "++", "**", "=>", ";"),
    *("true", "null", "new", "typeof", "not", "and", "in", "this", "if", "Math.random()", "'\\u", "\\x4"),
]
TEXTS = st.lists(st.sampled_from(PIECES), max_size=14).map("".join) | st.text(max_size=40)
SCOPE: dict[str, Type] = {
    "a": BASE_TYPES["int32"],
    "b": BASE_TYPES["bool"],
    "f": BASE_TYPES["float64"],
    "s": BASE_TYPES["string"],
    "v": Array(BASE_TYPES["int16"], 3),
    "p": Struct("P", (("x", BASE_TYPES["float32"]), ("q", Array(BASE_TYPES["string"], None)))),
    "_msg": Array(Struct("", (("x", Array(BASE_TYPES["bool"], 2)),), "message"), 4),
}


@given(TEXTS, st.integers(0, 3))
def test_any_text(text: str, base: int) -> None:
    source = Decoded(text, base)
    expr, findings = parse(source)
    assert len(findings) <= MAX_FINDINGS
    for finding in findings:
        for place in (finding.span, *(edit.span for fix in finding.fixes for edit in fix.edits)):
            assert base <= place.start <= place.end <= base + len(text)
    assert_nested(expr)
    assert base <= expr.span.start <= expr.span.end <= base + len(text)


def assert_nested(expr: Expr) -> None:
    """Check that subexpressions are inside their parents, in order and disjoint, and that no tree is too deep."""
    level, depth = [expr], 0
    while level:
        depth += 1
        for node in level:
            at = node.span.start
            for child in children(node):
                assert at <= child.span.start <= child.span.end <= node.span.end
                at = child.span.end
        level = [child for inner_node in level for child in children(inner_node)]
    assert depth <= MAX_DEPTH + 2


@given(TEXTS)
def test_fixes_can_be_applied(text: str) -> None:
    """The preferred fix of a single error removes it."""
    source = Decoded(text, 0)
    findings = parse(source)[1]
    for finding in findings:
        for fix in finding.fixes:
            after = parse(Decoded(apply_edits(text, fix.edits).replace("&amp;", "&").replace("&lt;", "<"), 0))[1]
            if fix.preferred and len(findings) == 1:
                assert finding.message not in {other.message for other in after}


@given(TEXTS, st.booleans())
def test_inference_of_any_tree(text: str, reprinted: bool) -> None:
    expr = tree_of(text)
    type_, problems = infer(expr, SCOPE.get, reprinted=reprinted)
    assert str(type_)
    for problem in problems:
        assert expr.span.start <= problem.span.start <= problem.span.end <= expr.span.end
    assert [p.span for p in problems] == sorted(p.span for p in problems)
    value = constant(expr)
    assert value is None or abs(value) < float("inf")


@given(TEXTS)
def test_walk_meets_everything_once(text: str) -> None:
    expr = tree_of(text)
    met = list(walk(expr))
    assert len({id(e) for e in met}) == len(met)
    assert met[0] is expr
    assert len(met) == 1 + sum(len(children(e)) for e in met)


@given(operations())
def test_formatted_and_read_again(tokens: list[str]) -> None:
    """The normal form of an expression has the same meaning, and is its own normal form."""
    tree, _ = parse(Decoded(" ".join(tokens), 0))
    text = format_expr(tree)
    again, problems = parse(Decoded(text, 0))
    assert problems == ()
    assert show(again) == show(tree)
    assert format_expr(again) == text
