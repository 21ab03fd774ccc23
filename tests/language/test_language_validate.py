# SPDX-License-Identifier: Apache-2.0
"""Violations of the grammar: every kind, at its place."""

from __future__ import annotations

import re

import pytest
from hypothesis import assume, given
from lxml import etree

import kept_strategies as st
from roaml.language import BEHAVIOR_TREE, HL_SCXML, PLAIN_SCXML, STRUCTS, SYSTEM, XML_PROPERTIES
from roaml.language.grammar import AttributeType, Grammar, SimpleType, ValueChoice
from roaml.language.validate import (
    InvalidValue,
    MisplacedElement,
    MissingAttribute,
    MissingElement,
    SchemaViolation,
    StrayText,
    TooManyElements,
    UnknownAttribute,
    UnknownElement,
    Violation,
    to_lxml,
    unmet,
    validate,
)
from roaml.text import Span
from roaml.xml_syntax import parse

MACHINE = '<ascxml name="m" version="1.0" initial="s">{}</ascxml>'
STATE = MACHINE.format('<state id="s">{}</state>')
TREE = '<root BTCPP_format="4"><BehaviorTree ID="t">{}</BehaviorTree></root>'

CASES = [
    # grammar, document with the place in «», violation
    (HL_SCXML, STATE.format("<«trans» target='s'/>"), "UnknownElement in state"),
    (HL_SCXML, STATE.format("<onentry><if cond='a'><«sned»/></if></onentry>"), "UnknownElement in if"),
    (HL_SCXML, MACHINE.format("<state id='s'/><«assign» location='a' expr='1'/>"), "MisplacedElement in ascxml"),
    (HL_SCXML, STATE.format("<onentry><if cond='a'><else/><«else»/></if></onentry>"), "TooManyElements in if, up to 1"),
    (
        HL_SCXML,
        "<ascxml name='m' version='1.0' initial='s'><state id='s' «x»='1'/></ascxml>",
        "UnknownAttribute of state",
    ),
    (HL_SCXML, MACHINE.format("<«state»/>"), "MissingAttribute id"),
    (HL_SCXML, MACHINE.format("<state id='«»'/>"), "InvalidValue id, wanted something"),
    (HL_SCXML, STATE.format("<transition cond='« »'/>"), "InvalidValue cond, wanted something"),
    (HL_SCXML, STATE.format("«hello»"), "StrayText in state"),
    (HL_SCXML, STATE.format("<onentry/>  \n«a &lt; b»\n <onexit/>"), "StrayText in state"),
    (HL_SCXML, STATE.format("«<![CDATA[x]]>»"), "StrayText in state"),
    (HL_SCXML, STATE.format("<transition><target id='s' prob='«2»'/></transition>"), "InvalidValue prob, wanted *"),
    (
        HL_SCXML,
        MACHINE.format("<ros_topic_publisher name='t' topic='/t' type='«Int32»'/><state id='s'/>"),
        "InvalidValue type, wanted `package/Type`",
    ),
    (STRUCTS, "<types><«struct» id='a'/></types>", "MissingElement member"),
    (STRUCTS, "<types><struct id='a'><member id='b' type='int8'/></struct><«Struct» id='c'/></types>", "Unknown*"),
    (SYSTEM, "<«roaml»/>", "MissingElement properties"),
    (
        SYSTEM,
        "<roaml><properties><input src='p' type='jani'/></properties><«properties»/></roaml>",
        "TooMany*, up to 1",
    ),
    (
        SYSTEM,
        "<roaml><parameters><max_time value='«soon»' unit='s'/></parameters></roaml>",
        "InvalidValue value, *number*",
    ),
    (
        SYSTEM,
        "<roaml><parameters><max_time value='1' unit='«h»'/></parameters></roaml>",
        "InvalidValue unit, wanted `s`*",
    ),
    (PLAIN_SCXML, "<scxml initial='s'><state id='s'/><«foo»/></scxml>", "UnknownElement in scxml"),
    (PLAIN_SCXML, "<scxml initial='s'><state id='s'><«raise»/></state></scxml>", "MisplacedElement in state"),
    (BEHAVIOR_TREE, TREE.format("<Inverter><Action ID='a'/><«Action» ID='b'/></Inverter>"), "TooMany*, up to 1"),
    (BEHAVIOR_TREE, TREE.format("<«Inverter»/>"), "MissingElement any"),
    (BEHAVIOR_TREE, TREE.format("<«Action»/>"), "MissingAttribute ID"),
    (BEHAVIOR_TREE, TREE.format("<Action ID='a'/><«Action» ID='b'/>"), "TooMany*, up to 1"),
]


@pytest.mark.parametrize(("grammar", "marked", "expected"), CASES)
def test_violations(grammar: Grammar, marked: str, expected: str) -> None:
    text = re.sub("[«»]", "", marked)
    start, end = marked.index("«"), marked.index("»") - 1
    document = parse(text)
    assert document.findings == ()
    violations = [(place(v), describe(v)) for v in validate(document, grammar)]
    assert [where for where, _ in violations if re.fullmatch(re.escape(expected).replace(r"\*", ".*"), _)] == [
        (start, end)
    ]


def place(violation: Violation) -> Span:
    match violation:
        case StrayText():
            return violation.span
        case UnknownAttribute():
            return violation.attribute.name_span
        case InvalidValue():
            return violation.attribute.value_span
    return violation.element.name_span


def describe(violation: Violation) -> str:
    name = type(violation).__name__
    match violation:
        case TooManyElements():
            return f"{name} in {violation.parent.name}, up to {violation.most}"
        case UnknownElement() | MisplacedElement() | StrayText():
            return f"{name} in {violation.parent.name}"
        case UnknownAttribute():
            return f"{name} of {violation.type.name}"
        case MissingAttribute():
            return f"{name} {violation.attribute.name}"
        case MissingElement():
            return f"{name} {' '.join(violation.names) or 'any'}"
        case InvalidValue():
            return f"{name} {violation.type.name}, wanted {violation.required}"
        case SchemaViolation():
            return f"{name}: {violation.reason}"


QUIET = [
    # What is no business of the grammar, or still being typed.
    (HL_SCXML, STATE.format("")),
    (
        HL_SCXML,
        '<scxml xmlns="http://www.w3.org/2005/07/scxml" name="m" version="1.0" initial="s"><state id="s"/></scxml>',
    ),
    (HL_SCXML, '<ascxml xmlns="..." name="m" version="1.0" initial="s"><state id="s"/></ascxml>'),
    (
        HL_SCXML,
        '<ascxml name="m" version="1.0" initial="s" xmlns:q="u" q:x="1"><q:b><q:c/></q:b><state id="s"/></ascxml>',
    ),
    (
        HL_SCXML,
        '<x:ascxml xmlns:x="http://www.w3.org/2005/07/scxml" name="m" initial="s" version="1.0">'
        '<x:state id="s"/></x:ascxml>',
    ),
    (HL_SCXML, MACHINE.format("<state id='s'/><state ")),
    (HL_SCXML, MACHINE.format("<state id='s'><transition event</state>")),
    (HL_SCXML, "<other><thing/></other>"),
    (HL_SCXML, ""),
    (HL_SCXML, STATE.format("<!-- a comment -->\n<?pi?>")),
    (BEHAVIOR_TREE, TREE.format("<MyNode any='1'/>")),
    (
        PLAIN_SCXML,
        '<scxml version="1.0" initial="s" xmlns:q="u"><state id="s"><onentry><q:x>text</q:x></onentry></state></scxml>',
    ),
]


@pytest.mark.parametrize(("grammar", "text"), QUIET)
def test_no_violations(grammar: Grammar, text: str) -> None:
    assert [describe(v) for v in validate(parse(text), grammar)] == []


def test_violations_of_the_schema_alone_are_reported() -> None:
    """The tables do not contain the order of elements. libxml2 detects the violation, and xmlschema explains it."""
    document = parse(STATE.format("<onentry><if cond='a'><else/><elseif cond='b'/></if></onentry>"))
    (violation,) = validate(document, HL_SCXML)
    assert isinstance(violation, SchemaViolation)
    assert violation.element.name == "if"
    assert "elseif" in violation.reason


UNMET = [
    # type, value, what is wanted instead
    (SimpleType("integer"), "-3", ""),
    (SimpleType("integer"), " 3 ", ""),
    (SimpleType("integer"), "3.0", "a whole number"),
    (SimpleType("integer"), "٣", "a whole number"),
    (SimpleType("integer"), "1_0", "a whole number"),
    (SimpleType("nonNegativeInteger"), "0", ""),
    (SimpleType("nonNegativeInteger"), "-1", "a whole number, at least 0"),
    (SimpleType("positiveInteger"), "0", "a whole number, at least 1"),
    (SimpleType("positiveInteger"), "+1", ""),
    (SimpleType("positiveInteger"), "9" * 301, "a whole number, at least 1"),
    (SimpleType("decimal"), ".5", ""),
    (SimpleType("decimal"), "5.", ""),
    (SimpleType("decimal"), "1e3", "a number"),
    (SimpleType("decimal"), "", "a number"),
    (SimpleType("double"), "1e3", ""),
    (SimpleType("double"), "1e999", ""),
    (SimpleType("double"), "inf", "a number"),
    (SimpleType("decimal", above=0, most=1), "1", ""),
    (SimpleType("decimal", above=0, most=1), "0", "a number above 0 and at most 1"),
    (SimpleType("decimal", above=0, most=1), "1.1", "a number above 0 and at most 1"),
    (SimpleType("decimal", above=0), "0.0", "a number above 0"),
    (SimpleType("decimal", most=5), "6", "a number up to 5"),
    (SimpleType("string", choices=(ValueChoice("a", ""),)), "a", ""),
    (SimpleType("string", choices=(ValueChoice("a", ""),)), " a", "`a`"),
    (SimpleType("string", choices=(ValueChoice("a", ""), ValueChoice("b", ""))), "c", "`a` or `b`"),
    (SimpleType("string", choices=tuple(ValueChoice(v, "") for v in "abc")), "", "`a`, `b` or `c`"),
    (SimpleType("string", choices=(ValueChoice("a", ""), ValueChoice("b", "", "a"))), "b", ""),
    (SimpleType("string", choices=(ValueChoice("a", ""), ValueChoice("b", "", "a"))), "c", "`a`"),
    (SimpleType("token", non_empty=True), " ", "something"),
    (SimpleType("token", non_empty=True), "x", ""),
    (SimpleType("token"), "", ""),
]


@pytest.mark.parametrize(("simple", "value", "expected"), UNMET)
def test_unmet(simple: SimpleType, value: str, expected: str) -> None:
    assert unmet(simple, value) == expected


ATTRIBUTES = [
    (grammar, element.name, attribute)
    for grammar in (HL_SCXML, PLAIN_SCXML, SYSTEM, STRUCTS, XML_PROPERTIES, BEHAVIOR_TREE)
    for element in grammar.elements.values()
    for attribute in element.attributes.values()
    if ":" not in attribute.name
]
NUMBERS = ["1", "0", "-1", "+1", "1.5", "1.", ".5", "1e3", "1e-9", "NaN", "INF", "inf", "0x1", "9" * 40, "٣", "\t1\n"]
WORDS = ["", " ", "a", "1 2", "a/b", "a/msg/B", "a/b/c", " a/b ", "/", "\n", "true", "é", "\u00a0", "1.0", "2"]
VALUES = st.sampled_from(NUMBERS + WORDS)


@given(st.sampled_from(ATTRIBUTES), VALUES)
def test_tables_and_schema_agree_on_values(case: tuple[Grammar, str, AttributeType], value: str) -> None:
    """The tables and libxml2 accept the same values, except NaN and INF, which XML Schema allows and models do not."""
    grammar, name, attribute = case
    assume(attribute.simple.base != "double" or value not in ("NaN", "INF"))
    grammar.validator.validate(etree.Element(name, {attribute.name: value}))
    assert bool(unmet(attribute.simple, value)) is (
        f"attribute '{attribute.name}':" in str(grammar.validator.error_log)
    )


@st.composite
def documents(draw: st.DrawFn) -> tuple[Grammar, str]:
    """Documents of elements and attributes of one language, at correct or wrong places."""
    grammar = draw(st.sampled_from(GRAMMARS))
    return grammar, element(draw, grammar, draw(st.sampled_from(grammar.roots)), 0)


def element(draw: st.DrawFn, grammar: Grammar, name: str, depth: int) -> str:
    type_ = grammar.find(name)
    known = list(type_.attributes.values()) if type_ else []
    attributes = {a.name: value(draw, a) for a in known if a.required or draw(st.integers(0, 5)) == 0}
    written = "".join(f' {n}="{v}"' for n, v in attributes.items() if draw(st.integers(0, 19)))
    inside = list(type_.children) if type_ else []
    if type_ and type_.any_child:
        inside += ["AlwaysSuccess", "Inverter", "MyNode"]
    text = "text" if draw(st.integers(0, 24)) == 0 else ""
    children = []
    for _ in range(draw(st.integers(0, 3)) if depth < 5 else 0):
        names = st.sampled_from(inside) if bool(inside) and draw(MOSTLY) else st.sampled_from(ANY)
        children.append(element(draw, grammar, draw(names), depth + 1))
    return f"<{name}{written}>{text}{''.join(children)}</{name}>"


def value(draw: st.DrawFn, attribute: AttributeType) -> str:
    choices = [choice.value for choice in attribute.simple.choices] or ["1", "a", "a/B"]
    values = st.sampled_from(choices) if draw(MOSTLY) else VALUES
    return draw(values)


GRAMMARS = [HL_SCXML, PLAIN_SCXML, SYSTEM, STRUCTS, XML_PROPERTIES, BEHAVIOR_TREE]
MOSTLY = st.integers(0, 14).map(bool)
ANY = ["state", "transition", "assign", "input", "Sequence", "struct", "member", "nonsense"]


@given(documents())
def test_violations_are_what_the_schema_forbids(case: tuple[Grammar, str]) -> None:
    grammar, text = case
    document = parse(text)
    assert document.root is not None
    violations = [describe(v) for v in validate(document, grammar)]
    assert bool(violations) is not grammar.validator.validate(to_lxml(document, document.root)[0]), violations


def test_the_way_to_libxml2_drops_what_it_does_not_know() -> None:
    document = parse('<a:b xmlns:a="u" c="&lt;\0" c="2" @="3"> x <!-- y --><z$/>t<w xmlns:q="v"><q:r/><a:s/></w></a:b>')
    assert document.root is not None
    tree, back = to_lxml(document, document.root)
    assert etree.tostring(tree) == b'<b c="2">x<not-a-name/>t<w><s/></w></b>'
    assert {e.name for e in back.values()} == {"b", "z$", "w", "s"}
