# SPDX-License-Identifier: Apache-2.0
"""Completion in property files in XML: ports and properties as a whole, and the values of their attributes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.types import BASE_TYPES, BOOL, UNKNOWN, Struct, Type
from roaml.expr.zero import zero_text
from roaml.ide.completion.fields import fields_of
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, Snippet
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.names.in_property_file import SYMBOL_KINDS
from roaml.ide.property_values import names_of_port
from roaml.ide.syntax import Typed
from roaml.language import XML_PROPERTIES, AttributeType, ElementType
from roaml.model.property_file import Port, PortKind, PortVariableKind, PropertySection
from roaml.model.property_ports import EVENTS, LinkedVariable, names_of, part_of
from roaml.model.system import Channel, System
from roaml.model.tree_paths import instance_of, label_of, short_paths
from roaml.observers.properties import Pattern, ScopeKind
from roaml.observers.sentences import Times, pattern_sentence
from roaml.regex import regex
from roaml.roles import SymbolKind
from roaml.text import Span
from roaml.xml_syntax import Element

_COMPARED = regex(r"([A-Za-z_]\w*)\s*(?:[=!]==?|&lt;=?|&gt;=?|>=?)\s*\Z", re.ASCII)
_FORMULA_OPERATORS = {
    "H": "at all times until now",
    "O": "at some time until now",
    "S": "since",
    "&&": "and",
    "||": "or",
    "!": "not",
    "->": "implies",
}


def is_property_file(request: Request) -> bool:
    return request.file.grammar is XML_PROPERTIES


# -------------------------------------------------------------------- elements


def skeletons(request: Request, parents: tuple[Typed, ...]) -> Iterator[CompletionItem]:
    """Complete ports for the messages and events of the system, complete properties for each pattern, and time
    intervals for a property."""
    if not is_property_file(request) or not parents:
        return
    match parents[-1].element.name:
        case "ports":
            for system in request.systems[:1]:
                yield from _ports(system)
        case PropertySection.GUARANTEES.value | PropertySection.ASSUMES.value:
            yield from _properties()
        case "property":
            yield from _intervals(parents[-1].element)


def _properties() -> Iterator[CompletionItem]:
    """Items that insert properties. For each pattern, the label of one item is the name of the pattern, and the labels
    of the others are its sentences: one for each scope, with and without a bound on the time."""
    texts = {choice.value: choice.documentation for choice in _attribute("property", "pattern").simple.choices}
    for pattern in Pattern:
        insert = _property(pattern, ScopeKind.GLOBALLY, is_timed=pattern is Pattern.RECURRENCE)
        label = f"property {pattern.value}"
        yield CompletionItem(label, ItemKind.SKELETON, insert, texts[pattern.value], None, Rank.LIKELY)
    for scope in ScopeKind:
        rank = Rank.LIKELY if scope is ScopeKind.GLOBALLY else Rank.USUAL
        for pattern in Pattern:
            for is_timed in (True,) if pattern is Pattern.RECURRENCE else (False, True):
                label = pattern_sentence(pattern, scope, {}, Times(within="…" if is_timed else ""))
                label = label.partition(";")[0].rstrip(".")
                insert = _property(pattern, scope, is_timed=is_timed)
                detail = f"{pattern.value}, {scope.value}"
                yield CompletionItem(
                    label, ItemKind.SKELETON, insert, detail, None, rank, f"property {detail} {label.lower()}"
                )


def _property(pattern: Pattern, scope: ScopeKind, *, is_timed: bool) -> str:
    """A complete property, in snippet syntax."""
    snippet = Snippet().text('property id="').stop(["name"]).text(f'" pattern="{pattern.value}">\n\t')
    if pattern.is_binary:
        snippet.text("<events>\n\t\t<event>").stop().text("</event>\n\t\t<event>").stop()
        snippet.text("</event>\n\t</events>")
    else:
        snippet.text("<event>").stop().text("</event>")
    snippet.text(f'\n\t<scope type="{scope.value}"')
    if scope.has_event:
        snippet.text(' event="').stop().text('"')
    if scope.has_until:
        snippet.text(' until="').stop().text('"')
    snippet.text("/>")
    if is_timed:
        attribute = "time" if pattern is Pattern.RECURRENCE else "within"
        snippet.text(f'\n\t<time_interval {attribute}="').stop(["1"]).text('" time_unit="')
        snippet.stop(["s", "ms", "us", "ns"]).text('"/>')
    return str(snippet.text("\n</property>").end())


def _attribute(element: str, name: str) -> AttributeType:
    return XML_PROPERTIES.elements[element].attributes[name]


def _intervals(element: Element) -> Iterator[CompletionItem]:
    if element.find("time_interval") is not None:
        return
    for labels, attributes in (("within", ("within",)), ("after and within", ("after", "within"))):
        snippet = Snippet().text("time_interval")
        for name in attributes:
            snippet.text(f' {name}="').stop(["1"]).text('"')
        insert = str(snippet.text(' time_unit="').stop(["s", "ms", "us", "ns"]).text('"/>').end())
        yield CompletionItem(f"time_interval {labels}", ItemKind.SKELETON, insert, "", None, Rank.LIKELY)


def _ports(system: System) -> Iterator[CompletionItem]:
    for kind, name, channel in _channels(system):
        type_ = next((endpoint.use.type for endpoint in channel.endpoints), "")
        for event in EVENTS[kind]:
            attribute = f"{kind.value.removeprefix('ros_')}_name"
            snippet = Snippet().text(f'{kind} {attribute}="{name}" type="{type_}" event="{event}">\n\t')
            insert = str(snippet.text('<event_var id="').stop(["name"]).text(f'"/>\n</{kind}>').end())
            symbol = Symbol(system.path, SYMBOL_KINDS[kind], channel.name)
            yield CompletionItem(f"{kind} {name} {event}", ItemKind.SKELETON, insert, type_, symbol, Rank.LIKELY)
    for number, path in short_paths(system).items():
        label = label_of(system, instance_of(system, number))
        snippet = Snippet().text(f'bt_node node="{path}" event="').stop(["response", "tick", "halt"]).text('">\n\t')
        insert = str(snippet.text('<event_var id="').stop(["name"]).text('"/>\n</bt_node>').end())
        yield CompletionItem(f"bt_node {path}", ItemKind.SKELETON, insert, label, None, Rank.USUAL)


def _channels(system: System) -> Iterator[tuple[PortKind, str, Channel]]:
    """The kind of port, the name as written in a machine, and the channel, for each channel of a system."""
    for kind, symbol_kind in SYMBOL_KINDS.items():
        for channel in system.channels(symbol_kind).values():
            names = (endpoint.automaton.interface_name(endpoint.use) for endpoint in channel.endpoints)
            yield kind, next(filter(None, names), channel.name), channel


def is_usual(parents: tuple[Typed, ...], type_: ElementType, attribute: AttributeType) -> bool:
    """Whether a completion that inserts an element includes an attribute."""
    if type_.name == PortVariableKind.STATE.value and attribute.name in ("field", "param"):
        in_plain = bool(parents) and parents[-1].element.name == PortKind.PLAIN.value
        return (attribute.name == "param") == in_plain
    return attribute.required or attribute.name in ("pattern", "within")


def has_effect(parents: tuple[Typed, ...], type_: ElementType, attribute: AttributeType) -> bool:
    """Whether an attribute has an effect in an element with these parents."""
    return (
        type_.name != PortVariableKind.STATE.value
        or attribute.name not in ("field", "param")
        or is_usual(parents, type_, attribute)
    )


# ---------------------------------------------------------------------- values


def port_at(request: Request, subject: CompletionSubject) -> Port | None:
    """The port that the element of `subject` declares, or inside which the element is; `None` if there is none."""
    elements = [*(parent.element for parent in subject.parents), *([subject.element] if subject.element else [])]
    ports = request.property_file.ports if request.property_file is not None else ()
    return next((port for port in ports if any(port.element is element for element in elements)), None)


def referred(request: Request, kind: SymbolKind, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The symbols of a kind that ports of a property file can name."""
    system, port = next(iter(request.systems), None), port_at(request, subject)
    if system is None:
        return
    match kind:
        case SymbolKind.TREE_NODE:
            for number, path in short_paths(system).items():
                detail = label_of(system, instance_of(system, number))
                yield CompletionItem(path, ItemKind.PLUGIN, detail=detail, filter=detail)
        case SymbolKind.MACHINE:
            yield from _ends(system, port)
        case SymbolKind.EVENT:
            variables = request.analysis.globals(system.path)
            for event in dict.fromkeys(variable.event for variable in variables.values()):
                rank = Rank.LIKELY if event in system.events else Rank.LATE
                yield CompletionItem(event, ItemKind.EVENT, rank=rank)
        case SymbolKind.PARAMETER if port is not None and port.name is not None:
            prefix = f"{port.name.value}__"
            for variable in request.analysis.globals(system.path).values():
                if variable.name.startswith(prefix) and variable.event == port.name.value:
                    label = variable.name.removeprefix(prefix)
                    yield CompletionItem(label, ItemKind.MEMBER, detail=str(variable.type))


def _ends(system: System, port: Port | None) -> Iterator[CompletionItem]:
    """The machines that use the topic, service or action that a port names; all machines if none uses it."""
    kind = SYMBOL_KINDS.get(port.kind) if port is not None else None
    channels = system.channels(kind).values() if kind is not None else ()
    named = [channel for channel in channels if port is not None and _is_named(channel, port)]
    automata = [endpoint.automaton for channel in named for endpoint in channel.endpoints]
    for automaton in automata or system.automata:
        names = names_of(automaton)
        node = automaton.instance
        yield CompletionItem(names[0], ItemKind.PLUGIN, detail=label_of(system, node) if node is not None else "")


def _is_named(channel: Channel, port: Port) -> bool:
    name = port.name.value if port.name is not None else ""
    written = (endpoint.automaton.interface_name(endpoint.use) or "" for endpoint in channel.endpoints)
    if port.kind is PortKind.TOPIC:
        return name.strip("/") in (text.strip("/") for text in written)
    return name in written


def fields(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The fields of the message or event to which a port listens."""
    for path, type_, owner in _observed_fields(request, port_at(request, subject)):
        symbol = Symbol("", SymbolKind.FIELD, path.rpartition(".")[2], owner) if owner else None
        yield CompletionItem(path, ItemKind.MEMBER, detail=str(type_), about=symbol)


def _observed_fields(request: Request, port: Port | None) -> Iterator[tuple[str, Type, str]]:
    if port is not None and port.kind is PortKind.NODE:
        yield "status", BASE_TYPES["int32"], ""
        return
    yield from fields_of(part_of(port, request.environment.interface) if port is not None else None)


def port_types(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The types that the machines declare for the topic, service or action that a port names."""
    port = port_at(request, subject)
    kind = SYMBOL_KINDS.get(port.kind) if port is not None else None
    for system in request.systems:
        for channel in system.channels(kind).values() if kind is not None else ():
            if port is not None and _is_named(channel, port):
                for endpoint in channel.endpoints:
                    yield CompletionItem(endpoint.use.type, ItemKind.TYPE, detail="declared", rank=Rank.BEST)


def variable_type(request: Request, subject: CompletionSubject) -> Type:
    """The type of the value of a variable; `UNKNOWN` if it is not known."""
    match subject.type.name:
        case "goal_id" | "result_code":
            return BASE_TYPES["int32"]
        case "accepted":
            return BOOL
    field = subject.element.get("field") if subject.element is not None else None
    known = {path: type_ for path, type_, _ in _observed_fields(request, port_at(request, subject))}
    if field is not None and field.value.strip() in known:
        return known[field.value.strip()]
    written = subject.element.get("type") if subject.element is not None else None
    return BASE_TYPES.get(written.value.strip(), UNKNOWN) if written is not None else UNKNOWN


def field_type(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    type_ = variable_type(request, subject)
    if type_ != UNKNOWN and subject.element is not None and subject.element.get("field") is not None:
        yield CompletionItem(str(type_), ItemKind.TYPE, detail="of the field", rank=Rank.BEST)


def new_ids(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """A name for a new variable: the name of its field, or of its port."""
    field = subject.element.get("field") if subject.element is not None else None
    port = port_at(request, subject)
    text = field.value if field is not None else port.name.value if port is not None and port.name is not None else ""
    name = re.sub(r"\W+", "_", text.strip("/"), flags=re.ASCII).strip("_")
    if name and not name[0].isdigit():
        yield CompletionItem(name, ItemKind.VARIABLE, detail="the name of its field or port", rank=Rank.LATE)


# ----------------------------------------------------------------- expressions


def variables(request: Request) -> Mapping[str, Type]:
    """The variables of the ports with their types."""
    return {name: variable.type for name, variable in _linked(request).items()}


def _linked(request: Request) -> Mapping[str, LinkedVariable]:
    system = request.systems[0].path if request.systems else None
    linked = request.analysis.linked_properties(request.path, system) if system is not None else None
    return {v.id: v for port in linked.ports for v in port.variables} if linked is not None else _written(request)


def _written(request: Request) -> Mapping[str, LinkedVariable]:
    """The variables of a file that belongs to no system."""
    variables: dict[str, LinkedVariable] = {}
    for _, written in request.property_file.variables if request.property_file is not None else ():
        if written.id is not None:
            text = written.type.text.strip() if written.type is not None else ""
            type_ = BASE_TYPES.get(
                text,
                BASE_TYPES["int32"]
                if written.kind in (PortVariableKind.GOAL_ID, PortVariableKind.RESULT_CODE)
                else UNKNOWN,
            )
            is_bool = written.kind in (PortVariableKind.EVENT, PortVariableKind.ACCEPTED)
            variables[written.id.value] = LinkedVariable(
                written.id.value, written.kind, BOOL if is_bool else type_, "", written
            )
    return variables


def compared_values(request: Request, start: int) -> Iterator[CompletionItem]:
    """Values for the right side of a comparison with a variable: its named values (statuses of nodes, codes of
    results), and the neutral value of its type."""
    compared = _COMPARED.search(request.file.document.text[start : request.offset])
    variable = _linked(request).get(compared[1]) if compared is not None else None
    if variable is None:
        return
    ports = request.property_file.ports if request.property_file is not None else ()
    port = next((port for port in ports if variable.written in port.variables), None)
    for number, name in names_of_port(port, variable.written).items() if port is not None else ():
        yield CompletionItem(str(number), ItemKind.VALUE, detail=name, rank=Rank.BEST, filter=f"{number} {name}")
    if variable.type != UNKNOWN and not isinstance(variable.type, Struct):
        yield CompletionItem(zero_text(variable.type), ItemKind.VALUE, detail=str(variable.type), rank=Rank.LIKELY)


def in_formula(request: Request, span: Span) -> tuple[Span, list[CompletionItem]] | None:
    """The completions outside of the braces of a formula: a new condition, and the operators of formulas. `None` inside
    of braces."""
    before = request.file.document.text[span.start : request.offset]
    if before.count("{") > before.count("}"):
        return None
    place = Span(request.offset, request.offset)
    operators: Iterable[CompletionItem] = (
        CompletionItem(operator, ItemKind.OPERATOR, detail=text) for operator, text in _FORMULA_OPERATORS.items()
    )
    condition = str(Snippet().text("{ ").stop().text(" }").end())
    return place, [CompletionItem("{ }", ItemKind.SKELETON, condition, "condition", rank=Rank.BEST), *operators]


def formula_start(request: Request, span: Span) -> int:
    """The offset at which the condition around the caret begins."""
    return span.start + request.file.document.text[span.start : request.offset].rfind("{") + 1
