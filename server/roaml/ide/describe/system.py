# SPDX-License-Identifier: Apache-2.0
"""Descriptions, as Markdown, of names that several files share: events, topics, services, actions, blackboard
variables, trees and structs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Symbol
from roaml.expr.types import UNKNOWN, Struct, Type, unwrap
from roaml.ide.describe.language import builtin_node, members, value_range
from roaml.ide.describe.markdown import code, file, lines, name, names, paragraphs, sentence
from roaml.ide.names.lookup import symbol_group
from roaml.ide.names.occurrence import Access
from roaml.ide.names.occurrences import trees_of
from roaml.ide.names.translated import global_variables
from roaml.language import BEHAVIOR_TREE
from roaml.model.expand import Reference
from roaml.model.globals import GlobalVariable
from roaml.model.structs import StructDeclaration, resolve_structs
from roaml.model.system import CLOCK_TOPIC, BoundPort, Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.model.tree import nodes
from roaml.project.analysis import Analysis
from roaml.regex import regex
from roaml.roles import Direction, SymbolKind
from roaml.scxml.names import BLACKBOARD_WRITE_PREFIX, is_blackboard_answer, sanitise

_NODE = regex(r"bt_(\d{1,9})_")


def node_of(system: System, variable: str) -> SystemAutomaton | None:
    """The node of the tree to whose event a global variable belongs; `None` if the event is not that of a node."""
    number = _NODE.match(variable)
    return system.by_instance.get(int(number[1])) if number else None


def _system(analysis: Analysis, symbol: Symbol) -> System | None:
    """The system of a symbol; `None` if the file of the symbol belongs to no system."""
    return analysis.system(symbol.path) if symbol.path in analysis.system_paths else None


def _who(automata: Iterable[SystemAutomaton]) -> str:
    """The names of automata. For a node of the tree, the name of its plugin is used."""
    return names(automaton.outline.name if automaton.instance else automaton.name for automaton in automata)


def _in_properties(variables: Iterable[GlobalVariable]) -> str:
    variable_names = [variable.name for variable in variables]
    return f"In properties {names(variable_names, 3)}" if variable_names else ""


# ---------------------------------------------------------------------- events


def event(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a plain event: its parameters, its senders and receivers, and its variables in properties."""
    system = _system(analysis, symbol)
    system_event = system.events.get(symbol.name) if system else None
    if system_event is None:
        return paragraphs(code(f"event {symbol.name}"), _in_files(analysis, symbol))
    parameters = ", ".join(f"{key} : {type_}" for key, type_ in system_event.data.members)
    senders, receivers = _who(a for a, _ in system_event.senders), _who(a for a, _ in system_event.receivers)
    return paragraphs(
        code(f"event {symbol.name}({parameters})" if parameters else f"event {symbol.name}"),
        lines(
            f"**Sent by** {senders or 'nobody'} · **received by** {receivers or 'nobody'}",
            _in_properties(global_variables(analysis, symbol)),
        ),
    )


def _in_files(analysis: Analysis, symbol: Symbol) -> str:
    """The number of uses of an event in a file that belongs to no system."""
    uses = symbol_group(analysis, (symbol,)).uses
    counts = [
        f"{verb} {count} times" if count != 1 else f"{verb} once"
        for verb, access in (("sent", Access.WRITE), ("received", Access.READ))
        if (count := sum(use.occurrence.access is access for use in uses))
    ]
    return sentence(", ".join(counts))


def parameter(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a parameter of an event; `symbol.scope` is the event."""
    system = _system(analysis, symbol)
    system_event = system.events.get(symbol.scope) if system else None
    type_ = system_event.data.member(symbol.name) if system_event else None
    senders = (
        [a for a, sent in system_event.senders if any(p.name == symbol.name for p in sent.params)]
        if system_event
        else []
    )
    readers = [a for a, received in system_event.receivers if symbol.name in received.reads] if system_event else []
    return paragraphs(
        code(f"{symbol.name} : {type_ or UNKNOWN}"),
        lines(
            sentence(
                " · ".join(filter(None, (f"parameter of event {name(symbol.scope)}", value_range(type_ or UNKNOWN))))
            ),
            f"**Sent by** {_who(senders) or 'nobody'} · **read by** {_who(readers) or 'nobody'}" if system else "",
            _in_properties(global_variables(analysis, symbol)),
        ),
    )


# -------------------------------------------------------------------- interfaces

_VERBS = {
    SymbolKind.TOPIC: ("published by", "subscribed to by"),
    SymbolKind.SERVICE: ("served by", "called by"),
    SymbolKind.ACTION: ("served by", "goals sent by"),
}


def interface(analysis: Analysis, symbol: Symbol, written: str = "") -> str:
    """The description of a topic, service or action, with the name as `written`: its type, the automata that provide
    and use it, and its names in the translation."""
    system = _system(analysis, symbol)
    connected = find_channel(system, symbol) if system else None
    shown = written or symbol.name
    if system is None or connected is None:
        return code(f"{symbol.kind.value} {shown}")
    types = ", ".join(dict.fromkeys(endpoint.use.type for endpoint in connected.endpoints))
    return paragraphs(code(f"{symbol.kind.value} {shown} : {types}"), _sides(analysis, symbol, connected, system))


def channel(analysis: Analysis, symbol: Symbol, written: str, system: System) -> str:
    """The description of a topic, service or action without its type, as a part of other descriptions."""
    connected = find_channel(system, symbol)
    head = f"{sentence(symbol.kind.value)} {name(written)}"
    return head if connected is None else lines(head, _sides(analysis, symbol, connected, system))


def find_channel(system: System, symbol: Symbol) -> Channel | None:
    return system.channels(symbol.kind).get(symbol.name)


def _sides(analysis: Analysis, symbol: Symbol, connected: Channel, system: System) -> str:
    given, taken = _VERBS[symbol.kind]
    sources = "the clock of the system" if is_clock(system, symbol) else _ends(connected.sources)
    return lines(
        f"**{sentence(given)}** {sources} · **{taken}** {_ends(connected.users)}",
        _plain_events(symbol, connected),
        _in_properties(global_variables(analysis, symbol)),
    )


def is_clock(system: System, symbol: Symbol) -> bool:
    """Whether a topic is the clock: the topic of the simulated time, which the translation publishes."""
    return symbol.kind is SymbolKind.TOPIC and symbol.name == CLOCK_TOPIC and system.has_timer


def _ends(endpoints: Iterable[ChannelEndpoint]) -> str:
    return _who(endpoint.automaton for endpoint in endpoints) or "nobody"


def _plain_events(symbol: Symbol, connected: Channel) -> str:
    if symbol.kind is SymbolKind.TOPIC:
        return f"In plain SCXML event {name(f'topic_{symbol.name}_msg')}"
    called = sanitise(symbol.name)
    if symbol.kind is SymbolKind.ACTION:
        return f"In plain SCXML events {name(f'action_{called}_…')}"
    there = ("req_client_…", "request") if connected.users else ()
    back = ("response", "response_client_…") if connected.sources else ()
    return f"In plain SCXML {' → '.join(name(f'srv_{called}_{step}') for step in (*there, *back))}"


# -------------------------------------------------------------------- blackboard


def blackboard(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a blackboard variable: its type, and the ports that write and read it."""
    variables = global_variables(analysis, symbol)
    full = dict.fromkeys(_full_name(variable) for variable in variables)
    bound: list[BoundPort] = []
    types: dict[str, None] = {}
    for owner in analysis.systems_of(symbol.path):
        system = analysis.system(owner) if owner else None
        for variable in full if system else ():
            assert system is not None
            ports = system.blackboard.get(variable, ())
            bound += ports
            types.update({system.variable_type(variable): None} if ports else {})
    type_ = f" : {', '.join(types)}" if types else ""
    return paragraphs(
        code(f"{{{symbol.name}}}{type_}"),
        lines(
            f"Blackboard variable of tree {name(symbol.scope)}" if symbol.scope else "Blackboard variable",
            f"**Written by** {_ports(bound, Direction.OUT)} · **read by** {_ports(bound, Direction.IN)}"
            if bound
            else "",
            _in_properties(variables),
        ),
    )


def _full_name(variable: GlobalVariable) -> str:
    """The full name of a blackboard variable, from the name of its global variable."""
    return (
        variable.event.removeprefix(BLACKBOARD_WRITE_PREFIX)
        if not is_blackboard_answer(variable.event)
        else variable.parameter
    )


def _ports(bound: Iterable[BoundPort], direction: Direction) -> str:
    port_names = (f"{b.automaton.outline.name}.{b.port.key}" for b in bound if b.port.direction is direction)
    return names(port_names) or "nobody"


# ------------------------------------------------------------------------- trees


def plugin(symbol: Symbol) -> str:
    """The description of a type of node that no machine of the system declares: a node of BehaviorTree.CPP, or an
    unknown name."""
    known = BEHAVIOR_TREE.elements.get(symbol.name)
    if known is not None and known.node:
        return builtin_node(known)
    return paragraphs(code(f"plugin {symbol.name}"), "No plugin of the system has this name")


def tree(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a behavior tree: its size, its file, and how often it is used."""
    for place in symbol_group(analysis, (symbol,)).definitions:
        trees = analysis.tree(place.path)
        for candidate in trees.trees if trees else ():
            if candidate.id is not None and candidate.id.span == place.span:
                count = sum(1 for _ in nodes(candidate))
                size = "one node" if count == 1 else f"{count} nodes"
                return paragraphs(
                    code(f"tree {symbol.name}"),
                    lines(sentence(f"{size} · {file(place.path)}"), _use(analysis, symbol)),
                )
    return paragraphs(code(f"tree {symbol.name}"), "No tree has this name")


def _use(analysis: Analysis, symbol: Symbol) -> str:
    if is_main(analysis, symbol):
        return "The main tree"
    uses = [use for use in symbol_group(analysis, (symbol,)).uses if use.occurrence.symbol.kind is SymbolKind.TREE]
    count = sum(not use.occurrence.defines and analysis.tree(use.path) is not None for use in uses)
    return f"Used {count} times" if count > 1 else "Used once" if count else "Never used"


def is_main(analysis: Analysis, symbol: Symbol) -> bool:
    """Whether a tree is the main tree, which is executed."""
    system = symbol.path if symbol.path in analysis.system_paths else None
    main = trees_of(analysis, symbol.path, system).main
    return main is not None and (main[1].id.value if main[1].id else "") == symbol.name


def tree_node(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a node of a tree that has a name: its names in the translation."""
    inside, _, position = symbol.scope.rpartition(":")
    return paragraphs(code(f"node {symbol.name}"), becomes(analysis, symbol.path, inside, int(position or 0)))


def becomes(analysis: Analysis, path: str, tree: str, position: int) -> str:
    """The names of a node in the translation, for each instance of its tree. The node is identified by the path of its
    file, the ID of its tree, and its position in the tree."""
    descriptions = list(
        dict.fromkeys(node(system, automaton) for system, automaton in instances(analysis, path, tree, position))
    )
    rest = f"… and {len(descriptions) - _MAX_USES} more" if len(descriptions) > _MAX_USES else ""
    return paragraphs(*descriptions[:_MAX_USES], rest)


_MAX_USES = 3
"""The maximum number of instances of a node that are described; further instances are counted."""


def instances(analysis: Analysis, path: str, tree: str, position: int) -> Iterator[tuple[System, SystemAutomaton]]:
    """The instances of a node of a file in the executed trees of all systems of the file."""
    for owner in analysis.systems_of(path):
        system = analysis.system(owner) if owner else None
        for automaton in system.automata if system else ():
            source = automaton.instance.source if automaton.instance else None
            if system and source and (source.path, source.tree, source.position) == (path, tree, position):
                yield system, automaton


def node(system: System, automaton: SystemAutomaton) -> str:
    """The description of a node of the executed tree: its name in the translation, and the values of its ports."""
    instance = automaton.instance
    assert instance is not None
    ports = [(key, value) for key, value in instance.ports if automaton.outline.port(key) is not None]
    bound = (f"{key} ← {{{v.variable}}}" if isinstance(v, Reference) else f"{key} = {v.text}" for key, v in ports)
    return lines(f"In JANI automaton {name(automaton.name)}", names(bound))


# ----------------------------------------------------------------------- structs


def struct(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a struct: its members, and its file; "" if there is no definition."""
    type_ = _struct(analysis, symbol, symbol.name)
    if type_ is None:
        return ""
    files = dict.fromkeys(file(place.path) for place in symbol_group(analysis, (symbol,)).definitions)
    return paragraphs(code(members(type_)), ", ".join(files))


def member(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a member of the struct `symbol.scope`; "" if the struct does not have the member."""
    owner = _struct(analysis, symbol, symbol.scope)
    type_: Type | None = owner.member(symbol.name) if owner else None
    if type_ is None:
        return ""
    inner, _ = unwrap(type_)
    return paragraphs(
        code(f"{symbol.name} : {type_}"),
        sentence(" · ".join(filter(None, (f"member of struct {name(symbol.scope)}", value_range(type_))))),
        code(members(inner)) if isinstance(inner, Struct) else "",
    )


def _struct(analysis: Analysis, symbol: Symbol, struct_name: str) -> Struct | None:
    """The struct `struct_name` in the system of a symbol, or in the file of the symbol if this file belongs to no
    system; `None` if there is none."""
    if symbol.path in analysis.system_paths:
        struct = analysis.structs(symbol.path).types.get(struct_name)
        return struct if isinstance(struct, Struct) else None
    declared: tuple[StructDeclaration, ...] = analysis.struct_declarations(symbol.path)
    outlines = tuple(outline for declaration in declared if (outline := declaration.outline) is not None)
    struct = resolve_structs(outlines).get(struct_name)
    return struct if isinstance(struct, Struct) else None
