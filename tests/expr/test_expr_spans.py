# SPDX-License-Identifier: Apache-2.0
"""Spans of expressions in the file, which take XML references before them into account; and fixes at these spans."""

from __future__ import annotations

import pytest

from roaml.expr.parse import parse, tokens
from roaml.expr.tree import Binary, Member, walk
from roaml.text import Decoded, apply_edits
from roaml.xml_syntax import parse as parse_xml

SPANS = [
    # attribute value as written, the parts of it that the subexpressions are, outer before inner
    ("a", ["a"]),
    (" a ", ["a"]),
    ("a &lt; b", ["a &lt; b", "a", "b"]),
    ("a &amp;&amp; b", ["a &amp;&amp; b", "a", "b"]),
    ("&#97; &gt;= &quot;x&quot;", ["&#97; &gt;= &quot;x&quot;", "&#97;", "&quot;x&quot;"]),
    ("!(a)", ["!(a)", "a"]),
    ("(a).b", ["(a).b", "a"]),
    ("(a)[ (b) ]", ["(a)[ (b) ]", "a", "b"]),
    ("(f)(a, b)", ["(f)(a, b)", "f", "a", "b"]),
    ("((a) + b) * c", ["((a) + b) * c", "(a) + b", "a", "b", "c"]),
    ("a ? (b) : c", ["a ? (b) : c", "a", "b", "c"]),
    ("[ a , {x: b} ]", ["[ a , {x: b} ]", "a", "{x: b}", "b"]),
    ("a. ", ["a.", "a"]),
    ("a +", ["a +", "a", ""]),
    ("a &amp; b", ["a &amp; b", "a", "b"]),
    ("-&#32;1", ["-&#32;1", "1"]),
]


def expression(written: str, quote: str = '"') -> tuple[str, Decoded]:
    """A document with the value as written in an attribute, and that value decoded."""
    document = parse_xml(f"<a b={quote}{written}{quote}/>")
    assert document.root is not None
    return document.text, document.decoded(document.root.attributes[0].value_span)


@pytest.mark.parametrize(("written", "parts"), SPANS)
def test_spans(written: str, parts: list[str]) -> None:
    text, source = expression(written)
    assert [text[e.span.start : e.span.end] for e in walk(parse(source)[0])] == parts


def test_spans_of_operators_and_members() -> None:
    text, source = expression("a.bc &lt;= d")
    expr = parse(source)[0]
    assert isinstance(expr, Binary)
    assert text[expr.operator_span.start : expr.operator_span.end] == "&lt;="
    assert isinstance(expr.left, Member)
    assert text[expr.left.name_span.start : expr.left.name_span.end] == "bc"


def test_tokens_cover_the_text() -> None:
    text = " a.b<=1.5e3 + 'x y' #`t` "
    expression_tokens = tokens(text)
    assert [t.text for t in expression_tokens] == ["a", ".", "b", "<=", "1.5e3", "+", "'x y'", "#", "`t`"]
    kinds = "name punctuator name punctuator number punctuator string junk template"
    assert " ".join(t.kind.value for t in expression_tokens) == kinds
    gaps = [*(t.start for t in expression_tokens), len(text)]
    ends = [0, *(t.end for t in expression_tokens)]
    assert all(not text[end:gap].strip() for end, gap in zip(ends, gaps, strict=True))


FIXED = [
    # attribute value as written, its quote, the same after the first fix
    ("a &amp; b", '"', "a &amp;&amp; b"),
    ("a | b", '"', "a || b"),
    ("a = b", '"', "a == b"),
    ("a &lt;> b", '"', "a != b"),
    ("a =&lt; b", '"', "a &lt;= b"),
    ("a and b", '"', "a &amp;&amp; b"),
    ("a or b", '"', "a || b"),
    ("not a", '"', "! a"),
    ("(a + b", '"', "(a + b)"),
    ("v[1 ", '"', "v[1] "),
    ("a)", '"', "a"),
    ("a;", '"', "a"),
    ("'x", '"', "'x'"),
    ('"x', "'", '"x"'),
    ("&quot;x", '"', "&quot;x&quot;"),
    ("&apos;x", "'", "&apos;x&apos;"),
]


@pytest.mark.parametrize(("written", "quote", "fixed"), FIXED)
def test_fixes_are_valid(written: str, quote: str, fixed: str) -> None:
    text, source = expression(written, quote)
    finding = parse(source)[1][0]
    after = apply_edits(text, finding.fixes[0].edits)
    assert after == f"<a b={quote}{fixed}{quote}/>"
    document = parse_xml(after)
    assert document.findings == ()
    assert document.root is not None
    assert parse(document.decoded(document.root.attributes[0].value_span))[1] == ()


@pytest.mark.parametrize(("written", "parts"), SPANS)
def test_the_same_expression_elsewhere(written: str, parts: list[str]) -> None:
    """A cached expression is reused with the positions of its new place."""
    texts = [f'<a b="{written}"/>', f'<a  c="&gt;" b="{written}"/>', f'<a b="{" " * 1000}{written}"/>']
    for text in texts:
        document = parse_xml(text)
        assert document.root is not None
        tree, _ = parse(document.decoded(document.root.attributes[-1].value_span))
        actual_texts = [text[e.span.start : e.span.end] for e in walk(tree)]
        assert actual_texts == parts
        assert tree.span.start >= text.index('b="')
