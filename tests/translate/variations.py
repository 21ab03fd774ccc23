# SPDX-License-Identifier: Apache-2.0
"""Small changes that often leave a model valid, and say something that nobody has thought of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from random import Random
from typing import TypeAlias

from fuzz.elements import elements_of, piece, put
from roaml.xml_syntax import Attribute, Element
from roaml.xml_syntax.escapes import escape

Change: TypeAlias = Callable[[Random, str], str]

TYPES = ("bool", "int8", "uint8", "int32", "int64", "float32", "float64", "string", "int32[]", "int32[3]", "bool[2]")
STATEMENTS = ("assign", "send", "ros_topic_publish", "if", "raise", "log", "bt_set_output", "bt_return_status")


def varied(random: Random, texts: Mapping[str, str]) -> dict[str, str]:
    """`texts` with one to three changes in files of XML."""
    actual_texts = dict(texts)
    paths = [path for path in texts if not path.endswith((".jani", ".json"))]
    for _ in range(random.choice((1, 1, 2, 3))):
        path = random.choice(paths)
        actual_texts[path] = random.choice(CHANGES)(random, actual_texts[path])
    return actual_texts


def _attributes(text: str, *names: str) -> list[tuple[Element, Attribute]]:
    return [(e, a) for e in elements_of(text) for a in e.attributes if not names or a.name in names]


def _value(element: Element, name: str) -> str | None:
    attribute = element.get(name)
    return None if attribute is None else attribute.value


def leave_out(random: Random, text: str) -> str:
    elements = elements_of(text)[1:]
    return put(text, random.choice(elements).span, "") if elements else text


def leave_out_attribute(random: Random, text: str) -> str:
    attributes = _attributes(text)
    return put(text, random.choice(attributes)[1].span, "") if attributes else text


def repeat(random: Random, text: str) -> str:
    elements = elements_of(text)[1:]
    if not elements:
        return text
    span = random.choice(elements).span
    return put(text, span, piece(text, span) * 2)


def move(random: Random, text: str) -> str:
    """An element once more, beside another of its name."""
    elements = elements_of(text)[1:]
    if not elements:
        return text
    one = random.choice(elements)
    places = [e for e in elements if e.name == one.name]
    at = random.choice(places).span.end
    return text[:at] + piece(text, one.span) + text[at:]


def swap(random: Random, text: str) -> str:
    """The values of two attributes of one name."""
    attributes = _attributes(text)
    if not attributes:
        return text
    one = random.choice(attributes)[1]
    other = random.choice([a for _, a in attributes if a.name == one.name])
    first, second = sorted((one.value_span, other.value_span))
    if first == second:
        return text
    return put(put(text, second, piece(text, first)), first, piece(text, second))


def copy_value(random: Random, text: str) -> str:
    """The value of one attribute in place of another's of the same name."""
    attributes = _attributes(text)
    if not attributes:
        return text
    one = random.choice(attributes)[1]
    other = random.choice([a for _, a in attributes if a.name == one.name])
    return put(text, one.value_span, piece(text, other.value_span))


_FORMS = (
    "({0})",
    "-({0})",
    "!({0})",
    "({0}) + 1",
    "({0}) * 2",
    "({0}) % 3",
    "({0}) / 2",
    "({0}) - ({0})",
    "({0}) && ({0})",
    "({0}) || true",
    "({0}) == ({0})",
    "({0}) === ({0})",
    "({0}) != ({1})",
    "({0}) < ({1})",
    "true ? ({0}) : ({1})",
    "({0}) ? 1 : 0",
    "Math.abs({0})",
    "Math.floor({0})",
    "Math.max({0}, {1})",
    "Math.pow({0}, 2)",
    "Math.random() * ({0})",
    "Math.random() < 0.5",
    "Math.floor(Math.random() * 3) + ({0})",
    "({0}).length",
    "({0})[0]",
    "[{0}, {1}]",
    "[{0}]",
    "[]",
    "''",
    "0",
    "1.5",
    "true",
    "'abc'",
    "_event.data.data",
    "_msg.data",
    "_event.name == 'x'",
)


def change_expression(random: Random, text: str) -> str:
    attributes = _attributes(text, "expr", "cond")
    if not attributes:
        return text
    one, other = (random.choice(attributes)[1] for _ in range(2))
    form = random.choice(_FORMS)
    return put(text, one.value_span, escape(form.format(one.value, other.value), '"').replace('"', "&quot;"))


def change_type(random: Random, text: str) -> str:
    attributes = _attributes(text, "type")
    return put(text, random.choice(attributes)[1].value_span, random.choice(TYPES)) if attributes else text


def add_condition(random: Random, text: str) -> str:
    """A condition of another element, on a transition without one."""
    conditions = [piece(text, a.value_span) for _, a in _attributes(text, "cond")] or ["false", "1 &lt; 2"]
    handlers = [e for e in elements_of(text) if e.get("target") is not None and e.get("cond") is None]
    if not handlers:
        return text
    at = random.choice(handlers).name_span.end
    return f'{text[:at]} cond="{random.choice(conditions)}"{text[at:]}'


def split_target(random: Random, text: str) -> str:
    """A transition that goes to its target half of the time, and else to any state."""
    handlers = [e for e in elements_of(text) if (target := e.get("target")) is not None and target.value_span]
    states = [state for e in elements_of(text) if e.name == "state" and (state := _value(e, "id"))]
    if not handlers or not states:
        return text
    one = random.choice(handlers)
    target, other = one.get("target"), random.choice(states)
    assert target is not None
    body = "" if one.self_closing else text[one.open_span.end : one.span.end].rpartition("</")[0]
    head = text[one.span.start : target.span.start] + text[target.span.end : one.open_span.end].rstrip("/>")
    targets = f'<target id="{target.value}" prob="0.5">{body}</target><target id="{other}"/>'
    return put(text, one.span, f"{head}>{targets}</{one.name}>")


def wrap_in_if(random: Random, text: str) -> str:
    elements = [e for e in elements_of(text) if e.name in STATEMENTS]
    if not elements:
        return text
    span = random.choice(elements).span
    conditions = [piece(text, a.value_span) for _, a in _attributes(text, "cond")] or ["true"]
    written = f'<if cond="{random.choice(conditions)}">{piece(text, span)}<else/></if>'
    return put(text, span, written)


def to_blackboard(random: Random, text: str) -> str:
    """A port of a tree that is a variable of the blackboard, or a constant."""
    attributes = [
        a for e, a in _attributes(text) if a.name not in ("ID", "name", "src", "type", "main_tree_to_execute")
    ]
    if "<BehaviorTree" not in text or not attributes:
        return text
    new = random.choice(("{a}", "{b}", "1", "0", "true", "abc", "2.5", "[1, 2]", "-1"))
    return put(text, random.choice(attributes).value_span, new)


CHANGES: tuple[Change, ...] = (
    leave_out,
    leave_out_attribute,
    repeat,
    move,
    swap,
    copy_value,
    change_expression,
    change_expression,
    change_expression,
    change_type,
    add_condition,
    split_target,
    wrap_in_if,
    to_blackboard,
)
