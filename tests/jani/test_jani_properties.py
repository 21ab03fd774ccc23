# SPDX-License-Identifier: Apache-2.0
"""Property lists: reading and writing."""

from __future__ import annotations

import json

import pytest
from hypothesis import HealthCheck, given, settings
from jani_strategies import FORMULAS

from roaml.jani.expressions import Binary, Integer, Name, Real
from roaml.jani.infer import TypeScope
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import (
    Accumulation,
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    Expectation,
    ExpectationOperator,
    Filter,
    FilterFunction,
    Formula,
    Interval,
    Predicate,
    Probability,
    ProbabilityOperator,
    Property,
    RewardBound,
    StatePredicate,
    UnaryPath,
    UnaryPathOperator,
    children,
    identifiers,
    walk,
)
from roaml.jani.reader import read_properties
from roaml.jani.typecheck import check_property
from roaml.jani.types import BOOL, INT
from roaml.jani.writer import write_properties
from roaml.json_syntax import parse
from roaml.model.kinds import FileKind, kind_of
from roaml.text import apply_edits


def read(expression: str) -> tuple[str, Property]:
    """The text of a property file with `expression`, with `'` in place of `"`, and the property in it."""
    text = f"{{'properties': [{{'name': 'p', 'expression': {expression}}}]}}".replace("'", '"')
    value, findings = parse(text)
    (property_,), more = read_properties(value, "p.jani")
    assert (findings, more) == ((), ())
    return text, property_


TRUE_UNTIL_SEEN = "{'op': 'U', 'left': true, 'right': 'seen.valid', 'step-bounds': {'lower': 100}}"

PROPERTIES: list[tuple[str, Formula]] = [
    (
        f"{{'op': 'filter', 'fun': 'values', 'values': {{'op': 'Pmin', 'exp': {TRUE_UNTIL_SEEN}}},"
        " 'states': {'op': 'initial'}}",
        Filter(
            FilterFunction.VALUES,
            Probability(
                ProbabilityOperator.PMIN,
                BinaryPath(
                    BinaryPathOperator.UNTIL,
                    read("true")[1].expression,
                    Name("seen.valid"),
                    step_bounds=Interval(Integer(100)),
                ),
            ),
            Predicate(StatePredicate.INITIAL),
        ),
    ),
    (
        "{'op': '>=', 'left': {'op': 'Pmax', 'exp': {'op': 'G', 'exp': {'op': '==', 'left': 'x', 'right': 2}}},"
        " 'right': 0.95}",
        BinaryFormula(
            BinaryOperator.GREATER_EQUAL,
            Probability(
                ProbabilityOperator.PMAX,
                UnaryPath(UnaryPathOperator.GLOBALLY, Binary(BinaryOperator.EQUAL, Name("x"), Integer(2))),
            ),
            Real(0.95),
        ),
    ),
    (
        "{'op': 'Emin', 'exp': 'cost', 'accumulate': ['steps', 'exit'], 'reach': {'op': 'deadlock'}}",
        Expectation(
            ExpectationOperator.EMIN,
            Name("cost"),
            (Accumulation.STEPS, Accumulation.EXIT),
            Predicate(StatePredicate.DEADLOCK),
        ),
    ),
    (
        "{'op': 'F', 'exp': 'x', 'reward-bounds': [{'exp': 'cost', 'accumulate': [],"
        " 'bounds': {'upper': 3, 'upper-exclusive': true}}]}",
        UnaryPath(
            UnaryPathOperator.FINALLY,
            Name("x"),
            reward_bounds=(RewardBound(Name("cost"), (), Interval(upper=Integer(3), upper_exclusive=True)),),
        ),
    ),
]


@pytest.mark.parametrize(("text", "formula"), PROPERTIES)
def test_reading(text: str, formula: Formula) -> None:
    assert read(text)[1].expression == formula


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("{'op': '&&', 'left': 'a', 'right': 'b'}", "{'op':'∧','left':'a','right':'b'}"),
        ("{'op': '=>', 'left': 'a', 'right': 'b'}", "{'op':'⇒','left':'a','right':'b'}"),
        ("{'op': '!', 'exp': 'a'}", "{'op':'¬','exp':'a'}"),
        ("{'comment': 'why', 'exp': 'a', 'op': 'F'}", "{'comment':'why','op':'F','exp':'a'}"),
        ("{'op': 'F', 'exp': 'a', 'step-bounds': {}}", "{'op':'F','exp':'a','step-bounds':{}}"),
        (
            "{'op': 'F', 'exp': 'a', 'time-bounds': {'comment': 's', 'lower-exclusive': false, 'lower': 2.0}}",
            "{'op':'F','exp':'a','time-bounds':{'comment':'s','lower':2.0,'lower-exclusive':false}}",
        ),
        ("{'op': 'F', 'exp': 'a', 'reward-bounds': []}", "{'op':'F','exp':'a','reward-bounds':[]}"),
        ("{'op': 'Emax', 'exp': 'a', 'accumulate': []}", "{'op':'Emax','exp':'a','accumulate':[]}"),
        (
            "{'op': 'Emax', 'exp': 'a', 'reward-instants': [{'exp': 'b', 'instant': 2, 'accumulate': ['time']}]}",
            "{'op':'Emax','exp':'a','reward-instants':[{'exp':'b','accumulate':['time'],'instant':2}]}",
        ),
    ],
)
def test_writing(text: str, written: str) -> None:
    expected = f"[{{'name':'p','expression':{written}}}]".replace("'", '"')
    assert write_properties([read(text)[1]]) == expected


def test_layout_for_people() -> None:
    property_ = read(PROPERTIES[0][0])[1]
    compact = write_properties([property_])
    assert write_properties([property_], indent=4) == json.dumps(json.loads(compact), indent=4)


def test_members_of_a_property_file() -> None:
    """Other members of the file are ignored, comments of properties are kept."""
    text = '{"jani-version": "?", "properties": [{"name": "p", "expression": true, "comment": "c"}], "automata": 3}'
    (property_,), findings = read_properties(parse(text)[0])
    assert findings == ()
    assert (property_.name, property_.comment) == ("p", "c")


@pytest.mark.parametrize(
    ("expression", "names"),
    [
        ("'x'", ["x"]),
        (
            "{'op': 'Pmin', 'exp': {'op': 'U', 'left': 'a', 'right': {'op': '=', 'left': 'b', 'right': 'a'}}}",
            ["a", "b", "a"],
        ),
        ("{'op': 'ac', 'var': 'i', 'length': 'i', 'exp': {'op': '+', 'left': 'i', 'right': 'k'}}", ["i", "k"]),
        ("{'op': 'nondet', 'var': 'i', 'exp': {'op': '<', 'left': 'i', 'right': 'k'}}", ["k"]),
        ("{'op': 'F', 'exp': 'a', 'step-bounds': {'upper': 'N'}}", ["a", "N"]),
        (
            "{'op': 'G', 'exp': true, 'reward-bounds': [{'exp': 'r', 'accumulate': [], 'bounds': {'lower': 'l'}}]}",
            ["r", "l"],
        ),
        ("{'op': 'Emin', 'exp': 'e', 'reach': 'g', 'step-instant': 's', 'time-instant': 't'}", ["e", "g", "s", "t"]),
        ("{'op': 'Emin', 'exp': 1, 'reward-instants': [{'exp': 'a', 'accumulate': [], 'instant': 'b'}]}", ["a", "b"]),
        ("{'op': 'Smin', 'exp': {'op': 'der', 'var': 'c'}}", ["c"]),
        ("{'op': '∀', 'exp': {'op': 'X', 'exp': {'op': '¬', 'exp': {'op': 'deadlock'}}}}", []),
        ("{'op': 'dv', 'type': 'P', 'values': [{'member': 'x', 'value': 'y'}]}", ["y"]),
        ("{'op': 'filter', 'fun': 'max', 'values': 'v', 'states': 's'}", ["v", "s"]),
        ("{'op': 'ite', 'if': 'a', 'then': {'op': 'initial'}, 'else': 'c'}", ["a", "c"]),
    ],
)
def test_identifiers(expression: str, names: list[str]) -> None:
    text, property_ = read(expression)
    pairs = list(identifiers(property_.expression))
    assert [name for name, _ in pairs] == names
    assert [text[slice(*span)] for _, span in pairs] == names
    assert len({span for _, span in pairs}) == len(pairs)


def test_identifiers_in_a_half_typed_file() -> None:
    text = '{"properties": [{"name": "p", "expression": {"op": "∧", "left": "topic_level, "right": \n "topic_al'
    properties, _ = read_properties(parse(text)[0])
    spans = [span for property_ in properties for _, span in identifiers(property_.expression)]
    assert all(0 <= start <= end <= len(text) for start, end in spans)
    text = '{"properties": [{"name": "p", "expression": {"op": "F", "exp": "topic_al'
    (property_,), _ = read_properties(parse(text)[0])
    assert list(identifiers(property_.expression)) == [("topic_al", (64, 72))]


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(FORMULAS)
def test_walking(formula: Formula) -> None:
    """Every node is visited once, before its children."""
    nodes = list(walk(formula))
    assert nodes[0] is formula
    assert len(nodes) == 1 + sum(len(children(node)) for node in nodes)


def test_names_and_types_of_a_property_are_checked_elsewhere() -> None:
    """The variables of a property file are those of the translation."""
    text, property_ = read(
        "{'op': 'Pmin', 'exp': {'op': 'F', 'exp': {'op': '∧', 'left': 'sen.valid', 'right': 'level'}}}"
    )
    findings = check_property(property_, TypeScope({"seen.valid": BOOL, "level": INT}))
    assert [(finding.code, text[slice(*finding.span)]) for finding in findings] == [
        ("jani-name", "sen.valid"),
        ("jani-type", "level"),
    ]
    assert "seen.valid" in apply_edits(text, findings[0].fixes[0].edits)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ('{"properties": []}', FileKind.PROPERTIES),
        ('{"jani-version": 1, "properties": []}', FileKind.PROPERTIES),
        ('{"jani-version": 1, "properties": [], "automata": []}', FileKind.JANI_MODEL),
        ('{"automata": []}', FileKind.JANI_MODEL),
        ('{"jani-version": 1}', FileKind.JANI_MODEL),
    ],
)
def test_a_file_with_properties_may_state_a_version(text: str, kind: FileKind) -> None:
    assert kind_of("p.jani", text) is kind
