# SPDX-License-Identifier: Apache-2.0
"""What is known of the thing at a place, as Markdown.

A name says what it denotes: its type, who writes and who reads it, what it becomes in the translation. Elements and
attributes say what the schemas say.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from roaml.diagnostics import Symbol
from roaml.expr.types import INTEGER_RANGES, Scalar, Type
from roaml.ide.find import Thing, occurrences_at, systems_of, thing
from roaml.ide.occurrence import Access, Occurrence
from roaml.ide.syntax import path_at, xml_file
from roaml.interfaces.registry import NotFound
from roaml.language import AttributeType
from roaml.model.system import Endpoint, System
from roaml.project.analysis import Analysis
from roaml.text import Span
from roaml.xml import Attribute


@dataclass(frozen=True, slots=True)
class Hover:
    """`span` is what `text` is about."""

    span: Span
    text: str


def hover(analysis: Analysis, path: str, offset: int) -> Hover | None:
    """What to tell about a place; None if nothing is known of it."""
    names = occurrences_at(analysis, path, offset)
    known = dict.fromkeys(part for each in names for part in _symbol(analysis, path, each))
    written = _written(analysis, path, offset)
    text = "\n\n---\n\n".join(filter(None, ("\n\n".join(known), written[1] if written else "")))
    span = names[0].span if known else written[0] if written else None
    return Hover(span, text) if span is not None and text else None


# ---------------------------------------------------------------------- names


def _symbol(analysis: Analysis, path: str, occurrence: Occurrence) -> Iterator[str]:
    symbol = occurrence.symbol
    match symbol.kind:
        case "variable":
            yield from _variable(analysis, symbol)
        case "state":
            yield from _state(analysis, symbol)
        case "event":
            yield from _uses(analysis, symbol, "sent", "received")
        case "topic" | "service" | "action":
            source = analysis.source(path)
            written = source.text[occurrence.span.start : occurrence.span.end] if source else symbol.name
            yield from (part for system in _systems(analysis, path) for part in _channel(system, symbol, written))
        case "blackboard":
            yield from _uses(analysis, symbol, "written", "read")
        case "ros-type":
            yield from _ros_type(analysis, symbol)


def _variable(analysis: Analysis, symbol: Symbol) -> Iterator[str]:
    for system in systems_of(analysis, symbol.path):
        type_ = analysis.typed_in(symbol.path, system).variables.get(symbol.scope, {}).get(symbol.name)
        if type_ is not None:
            yield _code(f"{symbol.name} : {type_}")
            if (around := _range(type_)) is not None:
                yield around


def _range(type_: Type) -> str | None:
    if not isinstance(type_, Scalar) or type_.name not in INTEGER_RANGES:
        return None
    least, most = INTEGER_RANGES[type_.name]
    return f"from {least} to {most}"


def _state(analysis: Analysis, symbol: Symbol) -> Iterator[str]:
    machine = analysis.machine(symbol.path)
    charts = [chart for chart in machine.charts if chart.scope == symbol.scope] if machine else []
    yield f"state `{symbol.name}`"
    for chart in charts:
        edges = [
            (state.id.value, target.state.value)
            for state in chart.states
            for handler in state.handlers
            for target in handler.targets
            if state.id and target.state
        ]
        sources = dict.fromkeys(source for source, target in edges if target == symbol.name)
        targets = dict.fromkeys(target for source, target in edges if source == symbol.name)
        yield f"from {_list(sources)} · to {_list(targets)}"


def _uses(analysis: Analysis, symbol: Symbol, given: str, taken: str) -> Iterator[str]:
    found = thing(analysis, [symbol])
    yield f"{symbol.kind} `{symbol.name}`"
    for verb, access in ((given, Access.WRITE), (taken, Access.READ)):
        yield f"{verb} by {_list(_files(analysis, found, access))}"


def _files(analysis: Analysis, found: Thing, access: Access) -> dict[str, None]:
    """The machines and trees that use a thing in one way."""
    paths = (use.path for use in found.uses if use.occurrence.access is access)
    return dict.fromkeys(_name(analysis, path) for path in paths)


def _name(analysis: Analysis, path: str) -> str:
    machine = analysis.machine(path)
    return machine.name.value if machine and machine.name else path.replace("\\", "/").rpartition("/")[2]


def _channel(system: System, symbol: Symbol, written: str) -> Iterator[str]:
    channels = {"topic": system.topics, "service": system.services, "action": system.actions}[symbol.kind]
    channel = channels.get(symbol.name)
    if channel is None:
        return
    yield _code(f"{symbol.kind} {written} : {', '.join(dict.fromkeys(e.use.type for e in channel.endpoints))}")
    given, taken = ("published", "heard") if symbol.kind == "topic" else ("served", "used")
    yield f"{given} by {_list(_machines(channel.sources))} · {taken} by {_list(_machines(channel.users))}"
    if symbol.kind == "topic":
        event = f"topic_{symbol.name}_msg"
        yield f"in properties: `{event}.valid`, `{event}__ros_fields__FIELD`"


def _machines(endpoints: Iterable[Endpoint]) -> dict[str, None]:
    return dict.fromkeys(endpoint.automaton.name for endpoint in endpoints)


def _systems(analysis: Analysis, path: str) -> Iterator[System]:
    for name in systems_of(analysis, path):
        linked = analysis.system(name) if name else None
        if linked is not None:
            yield linked


def _ros_type(analysis: Analysis, symbol: Symbol) -> Iterator[str]:
    definition = analysis.registry.resolve(symbol.scope, symbol.name)  # type: ignore[arg-type]
    if isinstance(definition, NotFound):
        return
    lines = []
    for number, section in enumerate(definition.sections):
        lines += ["---"] if number else []
        lines += [f"{field.type} {field.name}".strip() for field in section.fields]
    yield _code("\n".join((f"# {definition.full_name}", *lines)))
    if definition.comment:
        yield definition.comment


def _code(text: str) -> str:
    return f"```\n{text}\n```"


def _list(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names) or "nothing"


# ------------------------------------------------------------- what is written


def _written(analysis: Analysis, path: str, offset: int) -> tuple[Span, str] | None:
    """The documentation of the element, attribute or value at a place."""
    file = xml_file(analysis, path)
    around = path_at(file, offset) if file else []
    element, type_ = around[-1] if around else (None, None)
    if element is None or type_ is None:
        return None
    if element.name_span.contains(offset):
        return element.name_span, type_.documentation
    for attribute in element.attributes:
        known = type_.attributes.get(attribute.name)
        if known is not None and attribute.name_span.contains(offset):
            return attribute.name_span, known.documentation
        if known is not None and attribute.value_span.contains(offset):
            return attribute.value_span, _value(attribute, known)
    return None


def _value(attribute: Attribute, known: AttributeType) -> str:
    """What the schema says of the value; of the attribute, if the value is not one of a few."""
    chosen = (choice.documentation for choice in known.simple.choices if choice.value == attribute.value)
    return next(chosen, "") or known.documentation
