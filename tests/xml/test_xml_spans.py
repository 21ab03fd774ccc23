# SPDX-License-Identifier: Apache-2.0
"""Every token knows its place, and what the tree answers about places."""

from __future__ import annotations

import pytest

from roaml.text import Span
from roaml.xml_syntax import Element, Text, children_text, parse

TEXT = """<?xml version="1.0"?>\r
<!-- start -->
<x:a xmlns:x="u"
     b = 'c "d"'\te="">
  one &lt; two<![CDATA[ <three> ]]>
  <f g="&#10;h&amp;"/><i
  ></i
  >
</x:a>
"""


def cut(span: Span | None) -> str | None:
    return None if span is None else TEXT[span.start : span.end]


def test_nodes_of_the_document() -> None:
    assert [cut(node.span) for node in parse(TEXT).nodes] == [
        '<?xml version="1.0"?>',
        "\r\n",
        "<!-- start -->",
        "\n",
        TEXT[TEXT.index("<x:a") : -1],
        "\n",
    ]


def test_tags() -> None:
    root = parse(TEXT).root
    assert root is not None
    assert (root.prefix, root.name, cut(root.name_span)) == ("x", "a", "x:a")
    assert cut(root.open_span) == '<x:a xmlns:x="u"\n     b = \'c "d"\'\te="">'
    assert (cut(root.close_span), cut(root.close_name_span)) == ("</x:a>", "x:a")
    assert (cut(root.content_span) or "").startswith("\n  one &lt;")
    first, second = root.elements
    assert (cut(first.span), cut(first.open_span), first.close_span) == ('<f g="&#10;h&amp;"/>',) * 2 + (None,)
    assert first.self_closing
    assert first.complete
    assert (cut(second.open_span), cut(second.close_span)) == ("<i\n  >", "</i\n  >")
    assert cut(second.content_span) == ""


CONTENTS = [
    # what is inside, its character data, and for each character the one in the source
    ("", None, ""),
    (" <b/>\n", None, ""),
    (" a &lt; b ", "a < b", "a & b"),
    ("<![CDATA[ a &lt; b ]]>", "a &lt; b", "a &lt; b"),
    ("a<!-- c -->b", "ab", "ab"),
    ("\n<!-- c --> <![CDATA[a]]> &amp;<b>c</b> d ", "a & d", "a & d"),
]


@pytest.mark.parametrize(("inside", "text", "written"), CONTENTS)
def test_content(inside: str, text: str | None, written: str) -> None:
    document = parse(f"<a>{inside}</a>")
    assert document.root is not None
    content = document.content(document.root)
    assert (content and content.text) == text
    if content is not None:
        assert "".join(document.text[content.offset(i)] for i in range(len(content.text))) == written
        assert document.text[content.offset(len(content.text)) - 1] in (written[-1], "]")


ATTRIBUTES = [
    # element, name, value, value as written, whole
    ("a", "xmlns:x", "u", "u", 'xmlns:x="u"'),
    ("a", "b", 'c "d"', 'c "d"', "b = 'c \"d\"'"),
    ("a", "e", "", "", 'e=""'),
    ("f", "g", "\nh&", "&#10;h&amp;", 'g="&#10;h&amp;"'),
]


@pytest.mark.parametrize(("element", "name", "value", "written", "whole"), ATTRIBUTES)
def test_attributes(element: str, name: str, value: str, written: str, whole: str) -> None:
    root = parse(TEXT).root
    assert root is not None
    attribute = next(e for e in root.walk() if e.name == element).get(name)
    assert attribute is not None
    assert (attribute.value, cut(attribute.value_span), cut(attribute.name_span), cut(attribute.span)) == (
        value,
        written,
        name,
        whole,
    )


def test_character_data() -> None:
    root = parse(TEXT).root
    assert root is not None
    assert [n.value for n in root.nodes if not isinstance(n, Element)] == ["\n  one < two", " <three> ", "\n  ", "\n"]
    assert children_text(root) == "\n  one < two <three> \n  \n"


UNFINISHED = [
    # text, name of an element, its span, its start tag
    ("<a><b>\n  <c/>\n</a>", "b", "<b>\n  <c/>\n", "<b>"),
    ("<a><b>t\n", "b", "<b>t\n", "<b>"),
    ("<a>\n <b x='1' \n <c/></a>", "b", "<b x='1' \n ", "<b x='1' \n "),
    ("<a>\n <b", "b", "<b", "<b"),
    ("<a>\n <b \n", "b", "<b \n", "<b \n"),
    ("<a><b <c/></b></a>", "b", "<b <c/></b>", "<b "),
]


@pytest.mark.parametrize(("text", "name", "whole", "start_tag"), UNFINISHED, ids=repr)
def test_unfinished_elements(text: str, name: str, whole: str, start_tag: str) -> None:
    root = parse(text).root
    assert root is not None
    element = next(e for e in root.walk() if e.name == name)
    assert text[element.span.start : element.span.end] == whole
    assert text[element.open_span.start : element.open_span.end] == start_tag
    assert not element.complete


PATHS = [
    # text with `|` at the caret, names of the elements around it
    ("|<a><b/></a>", ""),
    ("<|a><b/></a>", "a"),
    ("<a>|<b/></a>", "a"),
    ("<a><|b/></a>", "a b"),
    ("<a><b/|></a>", "a b"),
    ("<a><b/>|</a>", "a"),
    ("<a></a>|", ""),
    ("<a><b x='|'/></a>", "a b"),
    ("<a><b>t|</b></a>", "a b"),
    ("<a><b>t</b|></a>", "a b"),
    # Where something is still being typed, the caret behind it is inside it.
    ("<a><b>|", "a b"),
    ("<a>\n  |", "a"),
    ("<a>\n<b|\n<c/></a>", "a b"),
    ("<a>\n<b |<c/></a>", "a b"),
    ("<a>\n<b x='1' |\n<c/></a>", "a b"),
    ("<a>\n<b x='|\n<c/></a>", "a b"),
    ("<a>\n<b\n<c/>|</a>", "a"),
    ("<a><b>\n  |\n</a>", "a b"),
    ("<a|", "a"),
    ("<a/><|b/>", "b"),
    ("", ""),
]


@pytest.mark.parametrize(("text", "names"), PATHS)
def test_path_at(text: str, names: str) -> None:
    offset = max(text.find("|"), 0)
    document = parse(text.replace("|", ""))
    assert " ".join(e.name for e in document.path_at(offset)) == names


def test_finding_children_and_attributes() -> None:
    root = parse("<a b='1' b='2'><c/><d x='1'/><c x='2'/></a>").root
    assert root is not None
    first, twice = root.find("c"), root.get("b")
    assert first is not None
    assert first.attributes == []
    assert twice is not None
    assert twice.value == "1"
    assert root.find("e") is None
    assert root.get("e") is None
    assert [e.name for e in root.walk()] == ["a", "c", "d", "c"]


SCXML = "http://www.w3.org/2005/07/scxml"
NAMESPACES = [
    ("<a><b/></a>", []),
    ('<a xmlns="u"><b/></a>', []),
    ('<x:a xmlns="u" xmlns:x="v"><x:b/><c/></x:a>', []),
    ('<x:a xmlns:y="u" xmlns:x="u"><y:b/></x:a>', []),
    ('<a xmlns="u" xmlns:x="u" xmlns:y="v"><x:b/><y:c><x:d/></y:c></a>', ["c"]),
    (f'<a><x:b xmlns:x="{SCXML}"/></a>', []),
    ('<a xmlns:x="u"><x:b/><x:c xmlns:x=""/></a>', ["b", "c"]),
    (f'<a xmlns:x="u"><e xmlns:x="{SCXML}"><x:b/></e><x:b2/></a>', ["b2"]),
    ("<a><undeclared:b/></a>", []),
]


@pytest.mark.parametrize(("text", "expected"), NAMESPACES)
def test_elements_are_foreign_in_another_namespace_than_the_root(text: str, expected: list[str]) -> None:
    root = parse(text).root
    assert root is not None
    assert [element.name for element in root.walk() if element.is_foreign] == expected


def test_text_nodes_are_the_gaps() -> None:
    root = parse("<a> x <b/> y </a>").root
    assert root is not None
    assert [(n.value, n.span) for n in root.nodes if isinstance(n, Text)] == [(" x ", (3, 6)), (" y ", (10, 13))]
