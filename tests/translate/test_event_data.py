# SPDX-License-Identifier: Apache-2.0
"""The types of parameters that events forward to each other."""

from __future__ import annotations

import random
from collections.abc import Mapping

from translating import translated

from roaml.expr.types import INT, REAL, UNKNOWN, Array, Struct, Type, unwrap
from roaml.jani.types import REAL as JANI_REAL
from roaml.scxml.event_data import MAX_DIMENSIONS, Round, infer_in_rounds, parameter_types

LENGTH = 9
MAIN = """\
<roaml>
    <parameters><max_time value="1" unit="s" /></parameters>
    <node_models>{inputs}</node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""
MACHINE = """\
<ascxml name="{name}" version="1.0" initial="s">
    <datamodel><data id="value" type="float64" expr="0.5" /></datamodel>
    <state id="s">{content}</state>
</ascxml>
"""
FIRST = '<onentry><send event="e0"><param name="x" expr="{value}" /></send></onentry>'
SEND = '<send event="{to}"><param name="x" expr="_event.data.x" /></send>'
FORWARD = f'<transition event="{{event}}" target="s">{SEND}</transition>'
LAST = '<transition event="{event}" target="s"><assign location="value" expr="_event.data.x" /></transition>'


def _system(contents: list[str]) -> dict[str, str]:
    random.Random(1).shuffle(contents)
    files = {f"m{i}.ascxml": MACHINE.format(name=f"m{i}", content=content) for i, content in enumerate(contents)}
    inputs = "".join(f'<input type="node-ascxml" src="{file}" />' for file in files)
    return {"main.xml": MAIN.format(inputs=inputs), "properties.jani": '{"properties": []}', **files}


def test_the_type_of_a_value_reaches_the_last_event_that_forwards_it() -> None:
    chain = [FORWARD.format(event=f"e{i}", to=f"e{i + 1}") for i in range(LENGTH)]
    model = translated(_system([FIRST.format(value="value"), *chain, LAST.format(event=f"e{LENGTH}")]))
    types = {variable.name: variable.type for variable in model.variables}
    assert [types[f"e{i}__x"] for i in range(LENGTH + 1)] == [JANI_REAL] * (LENGTH + 1)


def test_a_type_that_changes_after_it_was_forwarded_is_forwarded_again() -> None:
    """The parameter of `b` is an int until the type of that of `a` is known."""

    def infer(known: Mapping[str, Type]) -> Round[Mapping[str, Type], Type]:
        b = parameter_types([("x", INT), ("x", known.get("a", UNKNOWN))])["x"]
        data = {"a": REAL, "b": b, "c": known.get("b", UNKNOWN)}
        return Round(data, data, frozenset({"a", "b"}))

    assert infer_in_rounds(infer) == {"a": REAL, "b": REAL, "c": REAL}


def test_events_that_forward_nothing_need_one_round() -> None:
    rounds = []

    def infer(known: object) -> Round[int, Struct]:
        rounds.append(known)
        return Round(1, {"e": Struct("", (("x", INT),))}, frozenset())

    assert infer_in_rounds(infer) == 1
    assert rounds == [{}]


def test_an_event_that_forwards_itself_in_an_array_has_a_last_round() -> None:
    def infer(known: Mapping[str, Type]) -> Round[Type, Type]:
        type_: Type = Array(known.get("e", UNKNOWN), 1)
        return Round(type_, {"e": parameter_types([("x", type_)])["x"]}, frozenset({"e", "f"}))

    assert len(unwrap(infer_in_rounds(infer))[1]) <= MAX_DIMENSIONS + 1


def test_parameters_have_the_type_of_all_values() -> None:
    sent: list[tuple[str, Type]] = [("x", UNKNOWN), ("y", INT), ("x", INT), ("y", REAL), ("x", Array(INT))]
    assert parameter_types(sent) == {"x": INT, "y": REAL}
