# SPDX-License-Identifier: Apache-2.0
"""What holds for any text: the tree is lossless, every place lies in the text, fixes can be applied."""

from __future__ import annotations

import re
from collections.abc import Iterable

from hypothesis import assume, given
from lxml import etree

import kept_strategies as st
from roaml.text import Span, apply_edits
from roaml.xml_syntax import Element, Node, parse
from roaml.xml_syntax.names import is_local_name
from roaml.xml_syntax.parse import MAX_DEPTH, MAX_FINDINGS, MAX_TOLERATED

PIECES = [
    *"<>/=\"'&;! \n\r\t?-[]:ab1é\u00a0\0\ud800",
    *("<a>", "</a>", "<a ", "<b/>", "</b>", "<b", "</", "/>", ' c="d"', " c=e", "='", ' c="', "&lt;", "&x;", "&#0;"),
    *("<!--", "-->", "<![CDATA[", "]]>", "<?", "?>", "<!DOCTYPE", '<?xml version="1.0"?>', "x:", ' xmlns:x="u"'),
]
TEXTS = st.lists(st.sampled_from(PIECES), max_size=25).map("".join) | st.text(max_size=60)
SOUND = '<?xml version="1.0"?>\n<r xmlns:p="u"><p:x p:y="1"/> a &amp; b<c d=\'\'><![CDATA[<]]></c><!-- e --></r>\n'


@st.composite
def damaged(draw: st.DrawFn) -> str:
    """A sound document in which a few places are changed."""
    text = SOUND
    for _ in range(draw(st.integers(1, 3))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.sampled_from((0, 0, 1, 2, 7))))
        text = text[:start] + draw(st.sampled_from(["", *PIECES])) + text[end:]
    return text


@given(TEXTS | damaged())
def test_tree_covers_the_text(text: str) -> None:
    document = parse(text)
    assert_covers(document.nodes, Span(0, len(text)))
    elements = [node for node in document.nodes if isinstance(node, Element)]
    assert document.root is (elements[0] if elements else None)
    for element in elements:
        for inner in element.walk():
            assert_element(text, inner)


def assert_covers(nodes: Iterable[Node], span: Span) -> None:
    at = span.start
    for node in nodes:
        assert node.span.start == at
        assert node.span.end > at
        at = node.span.end
    assert at == span.end


def assert_element(text: str, element: Element) -> None:
    assert element.elements == [node for node in element.nodes if isinstance(node, Element)]
    assert element.span.start == element.open_span.start
    assert element.content_span.start == element.open_span.end
    assert element.span.end == (element.close_span.end if element.close_span else element.content_span.end)
    assert_covers(element.nodes, element.content_span)
    assert text[element.open_span.start] == "<"
    qualified = f"{element.prefix}:{element.name}" if ":" in cut(text, element.name_span) else element.name
    assert cut(text, element.name_span) == qualified
    if element.close_name_span:
        assert element.close_span is not None
        assert element.close_span.start < element.close_name_span.start
        assert element.close_name_span.end <= element.close_span.end
    at = element.name_span.end
    for attribute in element.attributes:
        assert at <= attribute.span.start == attribute.name_span.start
        assert attribute.name_span.end <= attribute.value_span.start <= attribute.value_span.end
        assert attribute.value_span.end <= attribute.span.end <= element.open_span.end
        assert cut(text, attribute.name_span) == attribute.name
        at = attribute.span.end


def cut(text: str, span: Span) -> str:
    return text[span.start : span.end]


@given(TEXTS | damaged())
def test_findings_are_inside_the_text(text: str) -> None:
    document = parse(text)
    assert len(document.findings) <= MAX_FINDINGS + MAX_TOLERATED + 1
    for finding in document.findings:
        assert finding.message
        places = [finding.span, *(edit.span for fix in finding.fixes for edit in fix.edits)]
        places += [related.place for related in finding.related if isinstance(related.place, Span)]
        assert all(0 <= place.start <= place.end <= len(text) for place in places)


@given(TEXTS | damaged())
def test_fixes_can_be_applied(text: str) -> None:
    """The preferred fix of an only mistake leaves none."""
    document = parse(text)
    for finding in document.findings:
        for fix in finding.fixes:
            after = parse(apply_edits(text, fix.edits))
            if fix.preferred and len(document.findings) == 1:
                assert not after.findings


BEYOND = re.compile(r"xmlns:p=(?!\"u\")|<\?xml version=.1\.\D|<!DOCTYPE")
"""libxml2 also judges the form of a namespace's URI; and we of versions and of document types."""


@given(damaged())
def test_well_formed_is_the_same_as_in_libxml2(text: str) -> None:
    assume(not BEYOND.search(text))
    assert (not parse(text).findings) == is_well_formed(text)


def is_well_formed(text: str) -> bool:
    try:
        etree.fromstring(text.encode("utf-8"), etree.XMLParser(resolve_entities=False))
    except (etree.XMLSyntaxError, UnicodeEncodeError):
        return False
    return True


def test_names_are_those_of_libxml2() -> None:
    every = [*range(0x3000), *range(0xD700, 0x10000), 0x10000, 0xEFFFF, 0xF0000, 0x10FFFF]
    names = [form + chr(code) for code in every for form in ("", "a")]
    assert [name for name in names if is_local_name(name) != makes_element(name)] == []


def makes_element(name: str) -> bool:
    try:
        etree.Element(name)
    except ValueError:
        return False
    return True


@given(st.integers(MAX_DEPTH - 2, MAX_DEPTH + 3), st.booleans())
def test_depth_is_bounded(depth: int, closed: bool) -> None:
    document = parse("<a>" * depth + ("</a>" * depth if closed else ""))
    assert document.root is not None
    assert max_depth(document.root) == min(depth, MAX_DEPTH)
    assert any(f.code == "nesting-too-deep" for f in document.findings) is (depth > MAX_DEPTH)


def max_depth(root: Element) -> int:
    depth, level = 0, [root]
    while level:
        depth, level = depth + 1, [child for element in level for child in element.elements]
    return depth


def test_absurd_depth_and_many_mistakes() -> None:
    for text in ("<a>" * 50_000, "<a" * 50_000, "</a>" * 50_000, "<a>" + "&" * 50_000, "<a b='" * 50_000):
        assert len(parse(text).findings) <= MAX_FINDINGS + MAX_TOLERATED + 1
