# SPDX-License-Identifier: Apache-2.0
"""Creates properties in XML from a sentence and events: the ports, the property, and the file if there is none.

A sentence is a pattern in a scope; its conditions are events that the system sends.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from xml.sax.saxutils import quoteattr

from roaml.edit.elements import after, first_in, last_in
from roaml.ide.code_actions import new_file
from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.ide.code_actions.inputs import add_input
from roaml.ide.names.in_property_file import SYMBOL_KINDS
from roaml.ide.verifiable import verifiable
from roaml.model.kinds import FileKind
from roaml.model.property_file import (
    NAME_ATTRIBUTES,
    PORTS,
    ObservedPart,
    Port,
    PortKind,
    PortVariableKind,
    PropertyFile,
    PropertySection,
    build_property_file,
)
from roaml.model.property_links import clock_step
from roaml.model.property_ports import EVENTS, PortLinker
from roaml.model.property_sentences import event_clause
from roaml.model.system import System
from roaml.model.system_file import SystemSection
from roaml.model.tree_paths import short_paths
from roaml.observers.properties import CLOSE, LEFT, OPEN, RIGHT, Pattern, PatternProperty, ScopeKind, Window
from roaml.observers.sentences import SentenceClause, Times, pattern_sentence
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout
from roaml.project.paths import folder_of
from roaml.record import Record
from roaml.text import Edit
from roaml.xml_syntax import parse

FILE_NAME = "properties.xml"
PATTERNS = (Pattern.RESPONSE, Pattern.EXISTENCE, Pattern.ABSENCE, Pattern.PRECEDENCE, Pattern.RECURRENCE)
"""The patterns for events. `UNIVERSALITY` is left out, because no event is sent in every step."""
SCOPES = (ScopeKind.GLOBALLY, ScopeKind.AFTER, ScopeKind.BEFORE, ScopeKind.BETWEEN)
_LETTERS = {LEFT: "A", RIGHT: "B", OPEN: "C", CLOSE: "D"}
"""The names of the conditions in a sentence before the user has chosen their events."""


class PropertySentence(Record, frozen=True):
    """A sentence for a new property, with letters instead of the conditions.

    Attributes:
        text: the sentence.
        conditions: the names of the conditions, in the order of their letters A, B, C and D.
        letters: the letter of each condition.
        needs_time: whether the sentence has no meaning without a bound on the time.
    """

    pattern: Pattern
    scope: ScopeKind
    text: str
    conditions: tuple[str, ...]
    letters: tuple[str, ...]
    needs_time: bool


class ObservableEvent(Record, frozen=True):
    """An event that a port of a property file can listen to.

    Attributes:
        port: the start tag of the port, without the angle brackets.
        clause: the clause that the event is sent, such as "a message is published on `/alarm`".
        id: a name for the event variable of the port.
    """

    port: str
    clause: str
    id: str


class NewProperty(Record, frozen=True):
    """The name of a new property, the path of its property file, and the change that creates it."""

    name: str
    path: str
    change: WorkspaceEdit


def sentences(analysis: Analysis, system: str) -> Iterator[PropertySentence]:
    """The sentences to choose from. Those that need time are left out if the system has no clock."""
    model = analysis.system(system)
    for scope, pattern in itertools.product(SCOPES, PATTERNS):
        needs_time = pattern is Pattern.RECURRENCE
        if needs_time and (model is None or clock_step(model) is None):
            continue
        conditions = PatternProperty(pattern, scope, Window(0, 1) if needs_time else Window()).inputs
        clauses = {name: SentenceClause(_LETTERS[name], "happens") for name in conditions}
        text = pattern_sentence(pattern, scope, clauses, Times(within="…" if needs_time else ""))
        letters = tuple(_LETTERS[name] for name in conditions)
        yield PropertySentence(pattern, scope, text.partition(";")[0].rstrip("."), conditions, letters, needs_time)


def observable_events(analysis: Analysis, system: str) -> tuple[ObservableEvent, ...]:
    """The events that a system sends, in the words of its interfaces and of its tree."""
    model = analysis.system(system)
    if model is None:
        return ()
    tags = [*port_tags(model)]
    text = "".join(f"<{tag}/>" for tag in tags)
    file = build_property_file(parse(f"<properties><ports>{text}</ports></properties>"))
    assert file is not None
    linker = PortLinker(model, analysis.interface, analysis.globals(system))
    return tuple(
        ObservableEvent(tag, str(event_clause(port)), _id(port))
        for tag, port in zip(tags, file.ports, strict=True)
        if linker.link(port).events
    )


def port_tags(system: System) -> Iterator[str]:
    """The start tags of ports for all events that a system can send, without the angle brackets. The ports listen to
    all clients."""
    for kind, symbol_kind in SYMBOL_KINDS.items():
        for channel in system.channels(symbol_kind).values():
            names = (endpoint.automaton.interface_name(endpoint.use) for endpoint in channel.endpoints)
            name = next(filter(None, names), channel.name)
            type_ = next((endpoint.use.type for endpoint in channel.endpoints), "")
            for event in EVENTS[kind]:
                yield _tag(kind, name, event.value, type_)
    for path in dict.fromkeys(short_paths(system).values()):
        for event in EVENTS[PortKind.NODE]:
            yield _tag(PortKind.NODE, path, event.value)
    for event_name, plain in system.events.items():
        if plain.senders:
            yield _tag(PortKind.PLAIN, event_name)


def _tag(kind: PortKind, name: str, event: str = "", type_: str = "") -> str:
    """The start tag of a port without the attributes that select clients or servers, without the angle brackets."""
    attributes = [(NAME_ATTRIBUTES[kind], name)]
    attributes += [(key, value) for key, value in (("type", type_), ("event", event)) if value]
    return " ".join((kind.value, *(f"{key}={quoteattr(value)}" for key, value in attributes)))


def _id(port: Port) -> str:
    name = port.name.value if port.name is not None else ""
    part = "" if port.part in (None, ObservedPart.PUBLISH) else f"_{port.part}"
    words = re.sub(r"\W+", "_", f"{name}{part}", flags=re.ASCII).strip("_")
    return words if words[:1].isalpha() else f"event_{words}"


def new_property(
    analysis: Analysis,
    system: str,
    pattern: Pattern,
    scope: ScopeKind,
    events: Mapping[str, ObservableEvent],
    within: str = "",
) -> NewProperty:
    """A new property of a system, with the ports for its events.

    Args:
        events: condition of the pattern and the scope -> its event.
        within: the upper bound on the time in s; "" for none.
    """
    path = next((f.path for f in analysis.listed(system) if f.usable and _is_ours(analysis, f.path)), None)
    file = analysis.property_file(path) if path is not None else None
    taken = {v.id.value for _, v in file.variables if v.id is not None} if file is not None else set()
    known = _known_ids(file) if file is not None else {}
    ids: dict[str, str] = {}
    ports: list[str] = []
    for event in dict.fromkeys(events.values()):
        id_ = known.get(event.port) or _free(event.id, taken)
        if event.port not in known:
            ports += [f"<{event.port}>", f'    <event_var id="{id_}" />', f"</{event.port.partition(' ')[0]}>"]
            taken.add(id_)
        ids[event.port] = id_
    written = {name: ids[event.port] for name, event in events.items()}
    name = _free(f"{written[LEFT]}_{pattern.value}", {p.name for p in verifiable(analysis, system)})
    lines = _property(name, pattern, scope, written, within)
    if file is None or path is None:
        path = new_file.free_path(analysis, folder_of(system), FILE_NAME)
        text = "\n".join(
            lines_of_element(
                "properties",
                [*lines_of_element(PORTS, ports), *lines_of_element(PropertySection.GUARANTEES.value, lines)],
            )
        )
        listing = add_input(analysis, system, SystemSection.PROPERTIES, "xml", path)
        return NewProperty(name, path, WorkspaceEdit({system: listing}, created={path: f"{text}\n"}))
    source = analysis.source(path)
    assert source is not None
    edits = tuple(in_layout(source, _added(file, ports, lines)))
    return NewProperty(name, path, WorkspaceEdit({path: edits}))


def _is_ours(analysis: Analysis, path: str) -> bool:
    return analysis.kind(path) is FileKind.XML_PROPERTIES and analysis.property_file(path) is not None


def _added(file: PropertyFile, ports: Sequence[str], lines: Sequence[str]) -> Iterator[Edit]:
    root, document = file.element, file.document
    written, guarantees = root.find(PORTS), root.find(PropertySection.GUARANTEES.value)
    new: list[str] = []
    if ports and written is not None:
        yield last_in(document, written, *ports)
    elif ports and (guarantees is not None or root.find(PropertySection.ASSUMES.value) is not None):
        yield first_in(document, root, *lines_of_element(PORTS, ports))
    elif ports:
        new = lines_of_element(PORTS, ports)
    if guarantees is not None:
        yield last_in(document, guarantees, *lines)
    else:
        new += lines_of_element(PropertySection.GUARANTEES.value, lines)
        others = root.elements
        yield after(document, others[-1], *new) if others else first_in(document, root, *new)


def lines_of_element(name: str, lines: Sequence[str]) -> list[str]:
    """The lines of an element whose content is `lines`, indented."""
    return [f"<{name}>", *(f"    {line}" for line in lines), f"</{name}>"]


def _known_ids(file: PropertyFile) -> dict[str, str]:
    """The event variables of the ports that select no client or server: start tag as in `ObservableEvent` -> id."""
    ids: dict[str, str] = {}
    for port, variable in file.variables:
        if variable.kind is not PortVariableKind.EVENT or variable.id is None or port.name is None:
            continue
        if port.origin is None and port.target is None:
            event = port.event.value if port.event is not None else ""
            type_ = port.type.value if port.type is not None else ""
            ids.setdefault(_tag(port.kind, port.name.value, event, type_), variable.id.value)
    return ids


def _free(name: str, taken: set[str]) -> str:
    names = (name if number == 1 else f"{name}_{number}" for number in itertools.count(1))
    return next(candidate for candidate in names if candidate not in taken)


def _property(name: str, pattern: Pattern, scope: ScopeKind, conditions: Mapping[str, str], within: str) -> list[str]:
    events = [f"<event>{conditions[side]}</event>" for side in (LEFT, RIGHT) if side in conditions]
    scope_attributes = "".join(
        f' {attribute}="{conditions[side]}"'
        for attribute, side in (("event", OPEN), ("until", CLOSE))
        if side in conditions
    )
    lines = [
        *(lines_of_element("events", events) if pattern.is_binary else events),
        f'<scope type="{scope.value}"{scope_attributes} />',
    ]
    if within:
        lines.append(f'<time_interval within={quoteattr(within)} time_unit="s" />')
    return [f'<property id="{name}" pattern="{pattern.value}">', *(f"    {line}" for line in lines), "</property>"]
