# SPDX-License-Identifier: Apache-2.0
"""Reading models: every error is reported at its position, and the reader continues.

In the examples, ⟦ ⟧ enclose the place of a finding, `'` stands for `"`, and each example is inserted into a small
correct model at the place that its first word names.
"""

from __future__ import annotations

import json
import re
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jani_strategies import MODELS

from roaml.diagnostics import Finding, Severity
from roaml.jani.expressions import Binary, Integer, Missing, Name, Real
from roaml.jani.model import Edge, Model
from roaml.jani.operators import BinaryOperator
from roaml.jani.reader import read_model, read_properties
from roaml.jani.writer import write
from roaml.json_syntax import MAX_DEPTH, parse
from roaml.text import Span, apply_edits

PLACES = {
    "type": "'mdp'",
    "features": "['arrays', 'datatypes', 'functions', 'x-mine']",
    "metadata": "{'author': 'me'}",
    "actions": "[{'name': 'go'}]",
    "constants": "[{'name': 'C', 'type': 'int', 'value': 3}]",
    "variables": "[{'name': 'n', 'type': 'int'}, {'name': 'r', 'type': 'real'}, {'name': 'ok', 'type': 'bool'},"
    " {'name': 'a', 'type': {'kind': 'array', 'base': 'int'}}, {'name': 'p', 'type': {'kind': 'datatype', 'ref': 'P'}},"
    " {'name': 'o', 'type': {'kind': 'option', 'base': 'int'}}, {'name': 'c', 'type': 'continuous'}]",
    "datatypes": "[{'name': 'P', 'members': [{'name': 'x', 'type': 'int'}]}]",
    "functions": "[{'name': 'f', 'type': 'int', 'parameters': [{'name': 'k', 'type': 'int'}], 'body': 'k'}]",
    "locals": "[]",
    "locations": "[{'name': 'idle'}]",
    "initial": "['idle']",
    "guard": "true",
    "assignments": "[]",
    "edges": "[{'location': 'idle', 'action': 'go', 'guard': {'exp': GUARD},"
    " 'destinations': [{'location': 'idle', 'assignments': ASSIGNMENTS}]}]",
    "elements": "[{'automaton': 'A'}]",
    "syncs": "[{'synchronise': ['go'], 'result': 'go'}]",
    "property": "{'op': 'initial'}",
    "properties": "[{'name': 'q', 'expression': PROPERTY}]",
}
MODEL = (
    "{'jani-version': 1, 'name': 'm', 'type': TYPE, 'features': FEATURES, 'metadata': METADATA, 'actions': ACTIONS,"
    " 'constants': CONSTANTS, 'variables': VARIABLES, 'datatypes': DATATYPES, 'functions': FUNCTIONS,"
    " 'automata': [{'name': 'A', 'variables': LOCALS, 'locations': LOCATIONS, 'initial-locations': INITIAL,"
    " 'edges': EDGES}], 'system': {'elements': ELEMENTS, 'syncs': SYNCS}, 'properties': PROPERTIES}"
)


def model_with(place: str, text: str) -> str:
    places = {**PLACES, place: text}
    whole = MODEL
    while match := re.search(r"\b[A-Z]{4,}\b", whole):
        whole = whole[: match.start()] + places[match[0].lower()] + whole[match.end() :]
    return whole.replace("'", '"')


def marked(text: str) -> tuple[str, list[Span]]:
    """The text without its marks, and the marked texts."""
    spans = []
    while "⟦" in text:
        start, end = text.index("⟦"), text.index("⟧")
        spans.append(Span(start, end - 1))
        text = text[:start] + text[start + 1 : end] + text[end + 1 :]
    return text, spans


def read(text: str) -> tuple[Model, tuple[Finding, ...]]:
    value, findings = parse(text)
    assert findings == ()
    model, findings = read_model(value, "m.jani")
    assert model is not None
    return model, findings


def test_the_model_of_the_examples_is_sound() -> None:
    model, findings = read(model_with("guard", "true"))
    assert findings == ()
    assert model.variables[0].name == "n"


SYNTAX = [
    ("type", "⟦'mdpp'⟧", "there is no model type `mdpp`; did you mean `mdp`?"),
    ("type", "⟦1⟧", "a model type must be a string, not a number"),
    ("features", "['⟦array⟧']", "there is no feature `array`; did you mean `arrays`?"),
    ("features", "[⟦'edge-priorities'⟧]", "the feature `edge-priorities` of JANI is not supported"),
    ("features", "[⟦1⟧]", "a feature must be a string, not a number"),
    ("metadata", "⟦'me'⟧", "metadata must be an object `{ }`, not a string"),
    ("metadata", "{'⟦autor⟧': 'me'}", "metadata has no member `autor`; did you mean `author`?"),
    ("metadata", "{'url': ⟦1⟧}", "`url` must be a string, not a number"),
    (
        "constants",
        "[{'name': 'C', 'type': {'kind': 'bounded', 'base': ⟦'bool'⟧}}]",
        "only int and real can have bounds",
    ),
    ("variables", "⟦{}⟧", "`variables` must be a list `[ ]`, not an object"),
    ("variables", "[⟦1⟧]", "a variable must be an object `{ }`, not a number"),
    ("variables", "[⟦{⟧}]", "a variable needs `name` and `type`"),
    ("variables", "[{'name': ⟦''⟧, 'type': 'int'}]", "`name` must not be empty"),
    ("variables", "[{'name': 'n', 'type': ⟦'integer'⟧}]", "there is no type `integer`"),
    (
        "variables",
        "[{'name': 'n', 'type': {'kind': '⟦aray⟧'}}]",
        "there is no kind of type `aray`; did you mean `array`?",
    ),
    ("variables", "[{'name': 'n', 'type': ⟦{⟧'base': 'int'}}]", "a type needs `kind`"),
    ("variables", "[{'name': 'n', 'type': ⟦{⟧'kind': 'array'}}]", "an array type needs `base`"),
    ("variables", "[{'name': 'n', 'type': 'int', 'transient': ⟦1⟧}]", "`transient` must be true or false"),
    ("guard", "⟦null⟧", "an expression must be a number, true, false, a name or an object `{ }`, not null"),
    ("guard", "⟦1e999⟧", "this number is too large; the greatest real number is about 1.8e308"),
    ("guard", "⟦''⟧", "a name must not be empty"),
    ("guard", "⟦{⟧}", "an expression needs `op`"),
    ("guard", "{'op': ⟦1⟧}", "`op` must be a string, not a number"),
    ("guard", "{'op': '⟦xor⟧', 'left': true, 'right': true}", "there is no operator `xor`; did you mean `or`?"),
    ("guard", "⟦{⟧'op': '∧', 'left': true}", "`∧` needs `right`"),
    (
        "guard",
        "{'op': '¬', 'exp': true, '⟦left⟧': true}",
        "`¬` has no member `left`",
    ),
    ("guard", "⟦{'op': 'deadlock'}⟧", "this is only allowed in a property, not in an expression"),
    ("guard", "{'constant': '⟦pi⟧'}", "there is no constant `pi`"),
    ("guard", "{'constant': ⟦3⟧}", "`constant` must be a string, not a number"),
    ("guard", "{'op': '=', 'left': {'distribution': '⟦Uniforn⟧', 'args': []}, 'right': 1}", "did you mean `Uniform`?"),
    (
        "guard",
        "{'op': '=', 'left': {'distribution': 'Uniform', 'args': ⟦[1]⟧}, 'right': 1}",
        "wrong number of arguments of `Uniform`: 1 instead of 2",
    ),
    ("guard", "{'op': '=', 'left': {'op': 'av', 'elements': ⟦1⟧}, 'right': 'a'}", "`elements` must be a list"),
    (
        "assignments",
        "[{'ref': ⟦{'op': '+', 'left': 'n', 'right': 1}⟧, 'value': 1}]",
        "the target of an assignment must be a variable or a part of one",
    ),
    (
        "assignments",
        "[{'ref': ⟦{'op': 'aa', 'exp': 1, 'index': 0}⟧, 'value': 1}]",
        "the target of an assignment must be a variable or a part of one",
    ),
    ("assignments", "[{'ref': 'n', 'value': 1, 'index': ⟦1.5⟧}]", "`index` must be a whole number"),
    ("assignments", "[{'ref': 'n', 'value': 1, 'index': ⟦true⟧}]", "`index` must be a whole number, not true"),
    ("assignments", "[{'ref': 'n', 'value': 1, '⟦guard⟧': 1}]", "an assignment has no member `guard`"),
    ("edges", "[⟦{⟧'location': 'idle'}]", "an edge needs `destinations`"),
    (
        "syncs",
        "[{'synchronise': ⟦['go', null]⟧}]",
        "the vector must have an entry for each element of the system: 1, not 2",
    ),
    ("syncs", "[{'synchronise': [⟦1⟧]}]", "an action must be a string or null, not a number"),
    (
        "property",
        "{'op': '⟦Pmn⟧', 'exp': {'op': 'F', 'exp': true}}",
        "there is no operator `Pmn`; did you mean `Pmin`?",
    ),
    (
        "property",
        "{'op': 'filter', 'fun': '⟦value⟧', 'values': 1, 'states': true}",
        "there is no filter function `value`; did you mean `values`?",
    ),
    (
        "property",
        "{'op': 'Pmin', 'exp': {'op': 'F', 'exp': true, 'step-bounds': {'⟦uper⟧': 3}}}",
        "an interval has no member `uper`; did you mean `upper`?",
    ),
    (
        "property",
        "{'op': 'Pmin', 'exp': {'op': 'F', 'exp': true, 'step-bounds': ⟦3⟧}}",
        "an interval must be an object `{ }`, not a number",
    ),
    (
        "property",
        "{'op': 'Emin', 'exp': 1, 'accumulate': ['⟦step⟧']}",
        "there is no kind of accumulation `step`; did you mean `steps`?",
    ),
]

NAMES = [
    ("actions", "[{'name': 'go'}, {'name': '⟦go⟧'}]", "action `go` is declared twice"),
    ("variables", "[{'name': '⟦C⟧', 'type': 'int'}]", "variable `C` is declared twice"),
    ("locals", "[{'name': '⟦n⟧', 'type': 'int'}]", "variable `n` hides the variable of the model with the same name"),
    ("locations", "[{'name': 'idle'}, {'name': '⟦idle⟧'}]", "location `idle` is declared twice"),
    ("initial", "['⟦idel⟧']", "there is no location `idel`; did you mean `idle`?"),
    ("initial", "[⟦3⟧]", "an entry of `initial-locations` must be a string, not a number"),
    ("edges", "[{'location': '⟦x⟧', 'destinations': []}]", "there is no location `x`"),
    ("edges", "[{'location': 'idle', 'destinations': [{'location': '⟦x⟧'}]}]", "there is no location `x`"),
    ("edges", "[{'location': 'idle', 'action': '⟦goo⟧', 'destinations': []}]", "there is no action `goo`; did you"),
    ("elements", "[{'automaton': '⟦B⟧'}]", "there is no automaton `B`"),
    ("elements", "[{'automaton': 'A', 'input-enable': ['⟦stop⟧']}]", "there is no action `stop`"),
    ("syncs", "[{'synchronise': ['⟦stop⟧']}]", "there is no action `stop`"),
    ("syncs", "[{'synchronise': ['go'], 'result': '⟦stop⟧'}]", "there is no action `stop`"),
    ("properties", "[{'name': 'q', 'expression': 'ok'}, {'name': '⟦q⟧', 'expression': 'ok'}]", "declared twice"),
    ("datatypes", "[{'name': 'P', 'members': [{'name': 'x', 'type': {'kind': 'datatype', 'ref': 'P'}}]}]", ""),
    (
        "functions",
        "[{'name': 'f', 'type': 'int', 'body': '⟦j⟧', 'parameters': [{'name': 'k', 'type': 'int'}]}]",
        "there is no variable `j`",
    ),
    ("guard", "{'op': '∧', 'left': '⟦okay⟧', 'right': '⟦unknown⟧'}", "there is no variable"),
    ("guard", "'⟦okk⟧'", "there is no variable `okk`; did you mean `ok`?"),
    (
        "guard",
        "{'op': '=', 'left': ⟦{'op': 'call', 'function': 'g', 'args': []}⟧, 'right': 1}",
        "there is no function `g`",
    ),
    (
        "guard",
        "{'op': '=', 'right': 1, 'left': ⟦{'op': 'da', 'exp': 'p', 'member': 'y'}⟧}",
        "`P` has no member `y`",
    ),
    (
        "guard",
        "{'op': '=', 'right': 'p', 'left': ⟦{'op': 'dv', 'type': 'Q', 'values': []}⟧}",
        "there is no datatype `Q`",
    ),
    ("assignments", "[{'ref': '⟦m⟧', 'value': '⟦k⟧'}]", "there is no variable"),
    ("assignments", "[{'ref': 'a', 'value': {'op': 'ac', 'var': 'i', 'length': '⟦i⟧', 'exp': 'i'}}]", None),
    (
        "property",
        "{'op': 'Pmin', 'exp': {'op': 'F', 'exp': '⟦okk⟧'}}",
        "there is no variable `okk`; did you mean `ok`?",
    ),
    ("variables", "[⟦{'name': 'p', 'type': {'kind': 'datatype', 'ref': 'Pt'}}⟧]", "there is no datatype `Pt`"),
]

TYPES = [
    ("guard", "⟦1⟧", "a guard must be true or false, not an int"),
    (
        "guard",
        "{'op': '∧', 'left': ⟦'n'⟧, 'right': true}",
        "an operand of `∧` must be true or false, not an int",
    ),
    ("guard", "{'op': '<', 'left': 'n', 'right': ⟦'ok'⟧}", "an operand of `<` must be a number, not a bool"),
    (
        "guard",
        "⟦{'op': '=', 'left': 'n', 'right': 'ok'}⟧",
        "the two values must have the same type, but they are an int and a bool",
    ),
    ("guard", "{'op': '=', 'left': {'op': 'aa', 'exp': 'a', 'index': ⟦'r'⟧}, 'right': 1}", "an index must be an int"),
    ("guard", "{'op': '=', 'left': {'op': 'aa', 'exp': ⟦'n'⟧, 'index': 0}, 'right': 1}", "only an array has elements"),
    (
        "guard",
        "{'op': '=', 'left': {'op': 'da', 'exp': ⟦'n'⟧, 'member': 'x'}, 'right': 1}",
        "only a datatype has members",
    ),
    (
        "guard",
        "{'op': '=', 'left': {'op': 'oa', 'exp': ⟦'n'⟧}, 'right': 1}",
        "this must be an option, not an int",
    ),
    (
        "guard",
        "{'op': '=', 'left': {'op': 'call', 'function': 'f', 'args': [⟦true⟧]}, 'right': 1}",
        "`k` of `f` must be an int, not a bool",
    ),
    (
        "guard",
        "{'op': '=', 'left': ⟦{'op': 'call', 'function': 'f', 'args': []}⟧, 'right': 1}",
        "wrong number of arguments of `f`: 0 instead of 1",
    ),
    (
        "guard",
        "{'op': '=', 'left': ⟦{'op': 'dv', 'type': 'P', 'values': []}⟧, 'right': 'p'}",
        "a value of `P` needs the member `x`",
    ),
    ("guard", "{'op': 'ite', 'if': ⟦1⟧, 'then': true, 'else': false}", "a condition must be true or false"),
    (
        "assignments",
        "[{'ref': 'n', 'value': ⟦'r'⟧}]",
        "`n` must be an int, not a real; use `floor` or `ceil` for an int",
    ),
    (
        "assignments",
        "[{'ref': 'n', 'value': ⟦{'op': '/', 'left': 4, 'right': 2}⟧}]",
        "`n` must be an int, not a real",
    ),
    (
        "assignments",
        "[{'ref': 'n', 'value': ⟦{'op': 'pow', 'left': 2, 'right': 'n'}⟧}]",
        "`n` must be an int, not a real",
    ),
    ("assignments", "[{'ref': 'r', 'value': 'n'}, {'ref': 'n', 'value': {'op': 'pow', 'left': 2, 'right': 2}}]", None),
    ("assignments", "[{'ref': '⟦C⟧', 'value': '⟦k⟧'}]", None),
    (
        "assignments",
        "[{'ref': {'op': 'aa', 'exp': 'a', 'index': 0}, 'value': ⟦true⟧}]",
        "this must be an int, not a bool",
    ),
    (
        "assignments",
        "[{'ref': 'a', 'value': {'op': 'av', 'elements': []}}, {'ref': 'o', 'value': {'op': 'empty'}}]",
        None,
    ),
    (
        "assignments",
        "[{'ref': 'a', 'value': ⟦{'op': 'av', 'elements': [1.5]}⟧}]",
        "`a` must be an array of int, not an array of real",
    ),
    (
        "assignments",
        "[{'ref': 'a', 'value': {'op': 'av', 'elements': [1, ⟦true⟧]}}]",
        "the two values must have the same type",
    ),
    ("assignments", "[{'ref': 'n', 'value': {'distribution': 'DiscreteUniform', 'args': [0, 9]}}]", None),
    (
        "assignments",
        "[{'ref': 'n', 'value': ⟦{'distribution': 'Uniform', 'args': [0, 9]}⟧}]",
        "`n` must be an int, not a real",
    ),
    ("assignments", "[{'ref': 'n', 'value': {'op': 'nondet', 'var': 'i', 'exp': 'i'}}]", None),
    ("assignments", "[{'ref': 'r', 'value': {'op': 'der', 'var': 'c'}}]", None),
    ("variables", "[{'name': 'v', 'type': 'int', 'initial-value': ⟦true⟧}]", "`v` must be an int, not a bool"),
    (
        "variables",
        "[{'name': 'v', 'type': {'kind': 'bounded', 'base': 'int', 'upper-bound': ⟦1.5⟧}}]",
        "a bound of this type must be an int, not a real",
    ),
    ("constants", "[{'name': 'C', 'type': 'bool', 'value': ⟦3⟧}]", "the constant `C` must be a bool, not an int"),
    (
        "functions",
        "[{'name': 'f', 'type': 'bool', 'parameters': [], 'body': ⟦3⟧}]",
        "`f` must return a bool, not an int",
    ),
    (
        "property",
        "⟦{'op': 'F', 'exp': 'ok'}⟧",
        "a property cannot be a path formula; use it in `Pmin` or `Pmax`",
    ),
    ("property", "{'op': 'Pmin', 'exp': ⟦'ok'⟧}", "`Pmin` needs a path formula, such as one with `F`, `G` or `U`"),
    (
        "property",
        "{'op': 'Pmax', 'exp': {'op': 'U', 'left': ⟦'n'⟧, 'right': 'ok'}}",
        "an operand of `U` must be true or false",
    ),
    (
        "property",
        "{'op': '≥', 'left': {'op': 'Pmin', 'exp': {'op': 'G', 'exp': 'ok'}}, 'right': ⟦'ok'⟧}",
        "an operand of `≥` must be a number, not a bool",
    ),
    (
        "property",
        "{'op': 'Pmin', 'exp': {'op': '∧', 'left': {'op': 'F', 'exp': 'ok'}, 'right': {'op': '¬', 'exp':"
        " {'op': 'G', 'exp': {'op': 'deadlock'}}}}}",
        None,
    ),
    (
        "property",
        "{'op': 'Pmin', 'exp': {'op': 'F', 'exp': 'ok', 'step-bounds': {'upper': ⟦1.5⟧}}}",
        "a bound must be an int, not a real",
    ),
    (
        "property",
        "{'op': 'filter', 'fun': '∀', 'values': ⟦'n'⟧, 'states': {'op': 'initial'}}",
        "the argument of `∀` must be true",
    ),
    (
        "property",
        "{'op': 'filter', 'fun': 'max', 'values': ⟦'ok'⟧, 'states': true}",
        "the argument of `max` must be a number",
    ),
    ("property", "{'op': 'filter', 'fun': 'count', 'values': ⟦1⟧, 'states': ⟦1⟧}", None),
    ("property", "{'op': 'Emin', 'exp': ⟦'ok'⟧, 'reach': ⟦1⟧, 'step-instant': ⟦0.5⟧}", None),
    ("property", "{'op': 'Smax', 'exp': 'ok'}", None),
    (
        "property",
        "{'op': 'Smax', 'exp': ⟦'a'⟧, 'accumulate': ['steps']}",
        "the value of a steady-state formula must be a number",
    ),
]


@pytest.mark.parametrize(
    ("code", "place", "example", "message"),
    [
        *(("jani-syntax", *case) for case in SYNTAX),
        *(("jani-name", *case) for case in NAMES),
        *(("jani-type", *case) for case in TYPES),
    ],
)
def test_mistakes(code: str, place: str, example: str, message: str | None) -> None:
    text, expected = marked(model_with(place, example))
    _, findings = read(text)
    # A quoted name is reported with or without its quotes.
    spans = [finding.span for finding in findings]
    assert [text[slice(*span)].strip('"') for span in spans] == [text[slice(*span)].strip('"') for span in expected]
    for span, expected_text in zip(spans, expected, strict=True):
        assert expected_text.start - 1 <= span.start <= expected_text.start + 1
    if message is not None:
        assert all(message in finding.message for finding in findings)
        assert {finding.code for finding in findings} <= {code, "jani-syntax"}


@pytest.mark.parametrize(
    ("place", "example", "mended"),
    [
        ("initial", "['idel']", "['idle']"),
        ("guard", "{'op': 'xor', 'left': true, 'right': true}", "{'op': 'or', 'left': true, 'right': true}"),
        ("guard", "'okk'", "'ok'"),
        ("assignments", "[{'ref': 'n', 'value': 1, 'indx': 0}]", "[{'ref': 'n', 'value': 1, 'index': 0}]"),
    ],
)
def test_suggestions_fix_the_text(place: str, example: str, mended: str) -> None:
    text = model_with(place, example)
    _, (finding,) = read(text)
    assert apply_edits(text, finding.fixes[0].edits) == model_with(place, mended)


def test_only_parts_without_effect_are_warnings() -> None:
    _, findings = read(model_with("metadata", "{'autor': 'me'}"))
    assert [finding.severity for finding in findings] == [Severity.WARNING]
    _, findings = read(model_with("initial", "['idel']"))
    assert [finding.severity for finding in findings] == [None]


UNKNOWN_MEMBERS = [
    ("a model", lambda m: m),
    ("an action", lambda m: m["actions"][0]),
    ("a constant", lambda m: m["constants"][0]),
    ("a variable", lambda m: m["variables"][0]),
    ("a bounded type", lambda m: m["constants"][0]["type"]),
    ("a function", lambda m: m["functions"][0]),
    ("a parameter", lambda m: m["functions"][0]["parameters"][0]),
    ("a system", lambda m: m["system"]),
    ("an element", lambda m: m["system"]["elements"][0]),
    ("a synchronisation", lambda m: m["system"]["syncs"][0]),
    ("an automaton", lambda m: m["automata"][0]),
    ("a location", lambda m: m["automata"][0]["locations"][0]),
    ("an edge", lambda m: m["automata"][0]["edges"][0]),
    ("an expression with a comment", lambda m: m["automata"][0]["edges"][0]["guard"]),
    ("`<`", lambda m: m["automata"][0]["edges"][0]["guard"]["exp"]),
    ("a destination", lambda m: m["automata"][0]["edges"][0]["destinations"][0]),
    ("an assignment", lambda m: m["automata"][0]["edges"][0]["destinations"][0]["assignments"][0]),
    ("a property", lambda m: m["properties"][0]),
    ("`filter`", lambda m: m["properties"][0]["expression"]),
    ("`F`", lambda m: m["properties"][0]["expression"]["values"]["exp"]),
]


def everything() -> dict[str, Any]:
    """A model with every kind of part."""
    bounded = {"kind": "bounded", "base": "int", "lower-bound": 0}
    goal = {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "=", "left": "n", "right": 1}}}
    way = {"location": "l", "assignments": [{"ref": "n", "value": 1}]}
    guard = {"exp": {"op": "<", "left": "n", "right": "C"}}
    parameter = {"name": "x", "type": "int"}
    return {
        "jani-version": 1,
        "name": "m",
        "type": "mdp",
        "features": ["functions"],
        "actions": [{"name": "a"}],
        "constants": [{"name": "C", "type": bounded, "value": 3}],
        "variables": [{"name": "n", "type": "int", "initial-value": 0}],
        "functions": [{"name": "f", "type": "int", "parameters": [parameter], "body": "x"}],
        "automata": [
            {
                "name": "A",
                "locations": [{"name": "l"}],
                "initial-locations": ["l"],
                "edges": [{"location": "l", "action": "a", "guard": guard, "destinations": [way]}],
            }
        ],
        "system": {"elements": [{"automaton": "A"}], "syncs": [{"synchronise": ["a"], "result": "a"}]},
        "properties": [
            {"name": "p", "expression": {"op": "filter", "fun": "max", "values": goal, "states": {"op": "initial"}}}
        ],
    }


@pytest.mark.parametrize(("what", "part"), UNKNOWN_MEMBERS, ids=[what for what, _ in UNKNOWN_MEMBERS])
def test_unknown_parts_that_may_have_a_meaning_are_errors(what: str, part: Any) -> None:
    for key, is_harmless in (("plugins", False), ("comment", True), ("metadata", True)):
        written = everything()
        part(written)[key] = {} if key == "metadata" else [] if key == "plugins" else "for people"
        _, findings = read_model(parse(json.dumps(written))[0])
        if is_harmless:
            assert not findings
        else:
            assert [finding.message for finding in findings] == [f"{what} has no member `plugins`"]
            assert findings[0].severity is None


def test_origins() -> None:
    text = model_with("guard", "{'op': '<', 'left': 'n', 'right': 2.5}")
    model, _ = read(text)
    edge = model.automata[0].edges[0]
    guard = edge.guard
    assert guard is not None
    assert guard.exp == Binary(BinaryOperator.LESS, Name("n"), Real(2.5))
    assert isinstance(guard.exp, Binary)
    destination = edge.destinations[0]
    places = {
        '{"op": "<", "left": "n", "right": 2.5}': guard.exp.origin,
        "n": guard.exp.left.origin,
        "2.5": guard.exp.right.origin,
        '{"location": "idle", "assignments": []}': destination.origin,
        '{"name": "idle"}': model.automata[0].locations[0].origin,
        '{"synchronise": ["go"], "result": "go"}': model.system.syncs[0].origin,
        '{"name": "q", "expression": {"op": "initial"}}': model.properties[0].origin,
    }
    for expected, origin in places.items():
        assert origin is not None
        assert origin.path == "m.jani"
        assert text[slice(*origin.span)] == expected
    assert Edge("idle", (destination,), "go", guard) == edge


def test_what_is_readable_is_read() -> None:
    """Half-typed properties keep their other parts."""
    text = '{"properties": [{"name": "p", "expression": {"op": "∧", "left": , "right": {"op": "<", "left": "x"}}}, {"na'
    value, findings = parse(text)
    assert {finding.code for finding in findings} == {"json-syntax"}
    properties, findings = read_properties(value)
    assert [(finding.message, text[slice(*finding.span)]) for finding in findings] == [
        ("`<` needs `right`", "{"),
        ("a property needs `expression` and `name`", "{"),
        ("a property has no member `na`", "na"),
    ]
    expected = Binary(BinaryOperator.AND, Missing(), Binary(BinaryOperator.LESS, Name("x"), Missing()))
    assert properties[0].expression == expected


@pytest.mark.parametrize("text", ["[]", "1", "", "nonsense", '"x"', "null"])
def test_no_object_at_all(text: str) -> None:
    value, syntax = parse(text)
    model, findings = read_model(value)
    assert model is None
    assert syntax or findings
    properties, findings = read_properties(value)
    assert properties == ()
    assert syntax or findings


def test_an_empty_object_lacks_everything() -> None:
    _, findings = read("{}")
    assert [finding.message for finding in findings] == [
        "a model needs `automata` and `jani-version` and `system` and `type`"
    ]


def test_other_versions() -> None:
    text = model_with("guard", "true").replace('"jani-version": 1', '"jani-version": 2')
    _, findings = read(text)
    assert [finding.message for finding in findings] == ["only version 1 of JANI is supported"]


def test_deep_expressions() -> None:
    """Expressions may be nested as deeply as JSON, and no deeper."""
    depth = MAX_DEPTH - 20
    text = model_with("guard", "{'op': '¬', 'exp': " * depth + "true" + "}" * depth)
    _, findings = read(text)
    assert findings == ()
    value, findings = parse(model_with("guard", "{'op': '¬', 'exp': " * 5000 + "true" + "}" * 5000))
    assert ["nested too deeply" in finding.message for finding in findings] == [True]
    read_model(value)


def test_deep_types() -> None:
    depth = MAX_DEPTH - 20
    type_ = "{'kind': 'array', 'base': " * depth + "'int'" + "}" * depth
    model, findings = read(model_with("locals", f"[{{'name': 'deep', 'type': {type_}}}]"))
    assert findings == ()
    assert type_.replace("'", '"').replace(" ", "") in "".join(write(model))


def test_integers_and_reals_are_distinguished() -> None:
    model, _ = read(model_with("assignments", "[{'ref': 'r', 'value': 2}, {'ref': 'r', 'value': 2.0}]"))
    assignments = model.automata[0].edges[0].destinations[0].assignments
    assert [assignment.value for assignment in assignments] == [Integer(2), Real(2.0)]


SCRAPS = st.sampled_from(
    ["{", "}", "[", "]", ",", ":", "1", "true", "null", '"x"', '"op"', '"exp"', '"name"', '"automata"', '"∧"', '"type"']
)


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(MODELS, st.data())
def test_damaged_models(model: object, data: st.DataObject) -> None:
    """Any removed or inserted part of a model: no exception, and all places are in the text."""
    assert isinstance(model, Model)
    text = "".join(write(model))
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = min(len(text), start + data.draw(st.integers(0, 30)))
        text = text[:start] + data.draw(SCRAPS | st.just("")) + text[end:]
    value, _ = parse(text)
    _, findings = read_model(value)
    _, more = read_properties(value)
    for finding in (*findings, *more):
        assert 0 <= finding.span.start <= finding.span.end <= len(text)
