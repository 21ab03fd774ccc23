# SPDX-License-Identifier: Apache-2.0
"""Descriptions, as Markdown, of the names that are local to one state machine: variables, states, handles, ports, and
the machine itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Symbol
from roaml.exact_number import exact_number
from roaml.expr.tree import access_path
from roaml.expr.types import UNKNOWN, EmptyArray, Type, join, leaves, unwrap
from roaml.ide.describe.comment import remark
from roaml.ide.describe.language import array_size, value_range
from roaml.ide.describe.markdown import code, file, lines, name, names, paragraphs, prose, sentence
from roaml.ide.describe.system import channel
from roaml.ide.names.in_machine import interface_symbol
from roaml.ide.names.occurrence import Access
from roaml.ide.names.occurrences import uses
from roaml.language import ElementType
from roaml.model.expand import PortConstant
from roaml.model.machine import Chart, Data, Declaration, Handler
from roaml.model.outline import MachineOutline
from roaml.model.syntax import Expression, Name, PortRead, Value
from roaml.model.system import System, SystemAutomaton
from roaml.model.timing import NANOSECONDS_PER_SECOND, period
from roaml.model.value_types import TypedMachine, ValueUse
from roaml.project.analysis import Analysis
from roaml.roles import ProtocolPart, SymbolKind
from roaml.scxml.names import sanitise
from roaml.text import Span
from roaml.xml_syntax import Element

_OCCASIONS = {
    None: "by itself",
    ProtocolPart.MESSAGE: "a message on",
    ProtocolPart.REQUEST: "a request to",
    ProtocolPart.RESPONSE: "the response of",
    ProtocolPart.GOAL: "a goal for",
    ProtocolPart.CANCEL: "a request to cancel a goal of",
    ProtocolPart.GOAL_RESPONSE: "the response to a goal of",
    ProtocolPart.FEEDBACK: "feedback of",
    ProtocolPart.RESULT: "the result of",
    ProtocolPart.TICK: "the timer",
    ProtocolPart.THREAD_START: "the start of a thread of",
    ProtocolPart.THREAD_FREE: "the end of a thread of",
    ProtocolPart.BT_TICK: "a tick",
    ProtocolPart.BT_HALT: "a halt",
    ProtocolPart.CHILD_STATUS: "the status of child",
    ProtocolPart.CHILD_HALTED: "the halt of child",
}

_KINDS = {
    SymbolKind.SERVICE_CLIENT: "service client",
    SymbolKind.SERVICE_SERVER: "service server",
    SymbolKind.ACTION_CLIENT: "action client",
    SymbolKind.ACTION_SERVER: "action server",
}


def automata(analysis: Analysis, path: str, scope: str = "") -> tuple[str, ...]:
    """The names of the automata of a machine, or of one of its threads, in all its systems."""
    machine = analysis.machine(path)
    threads = [thread for thread in machine.threads if thread.chart.scope == scope] if machine and scope else []
    automata_names: dict[str, None] = {}
    for system in linked_systems(analysis, path):
        for automaton in system.automata_of(path):
            if not scope:
                automata_names[automaton.name] = None
            for thread in threads:
                action = _action(automaton, thread.server.value if thread.server else "")
                automata_names.update(
                    (f"{sanitise(action)}_thread_{k}", None) for k in range(thread.count or 0) if action
                )
    return tuple(automata_names)


def _action(automaton: SystemAutomaton, handle: str) -> str:
    uses_of_handle = (
        use for use in automaton.outline.interfaces if (use.kind, use.handle) == (SymbolKind.ACTION_SERVER, handle)
    )
    return next((automaton.interface_name(use) or "" for use in uses_of_handle), "")


def linked_systems(analysis: Analysis, path: str) -> Iterator[System]:
    for owner in analysis.systems_of(path):
        system = analysis.system(owner) if owner else None
        if system is not None:
            yield system


def _remark(analysis: Analysis, path: str, element: Element) -> str:
    document = analysis.document(path)
    return prose(remark(document, element)) if document else ""


# ------------------------------------------------------------------- variables


def variable(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a variable: type, range, initial value, assigned values, number of uses, and names in the
    translation."""
    machine = analysis.machine(symbol.path)
    data_by_name = {
        (c.scope, d.id.value): d for c in reversed(machine.charts if machine else ()) for d in c.data if d.id
    }
    data = data_by_name.get((symbol.scope, symbol.name))
    parts: dict[str, None] = {}
    for system in analysis.systems_of(symbol.path):
        typed = analysis.typed_in(symbol.path, system) if machine else None
        if typed is not None:
            parts[_variable(analysis, symbol, data, typed)] = None
    return paragraphs(*parts)


def _variable(analysis: Analysis, symbol: Symbol, data: Data | None, typed: TypedMachine) -> str:
    type_ = typed.variables.get(symbol.scope, {}).get(symbol.name, UNKNOWN)
    inferred = data is None or data.type is None
    if inferred:
        type_ = inferred_type(typed, symbol.scope, symbol.name)
    _, bounds = unwrap(type_)
    initial = _initial(data.value if data else None)
    around = _bounds(data) or value_range(type_)
    facts = (around, array_size(bounds), f"starts as {initial}" if initial else "")
    unknown = "not declared" if data is None else "type inferred from its values"
    shown = sentence(" · ".join(filter(None, (unknown if inferred else "", *facts))))
    return paragraphs(
        code(f"{symbol.name} : {type_}"),
        _remark(analysis, symbol.path, data.element) if data else "",
        lines(shown, _gets(typed, symbol), _counted(analysis, symbol), _becomes(analysis, symbol, type_)),
    )


def inferred_type(typed: TypedMachine, scope: str, name: str) -> Type:
    """The common type of the values that are assigned to a variable; `UNKNOWN` if there are no values, or if they have
    no common type."""
    result: Type = UNKNOWN
    for value in typed.values:
        if value.use is ValueUse.ASSIGNED and value.place.chart.scope == scope and value.target == name:
            joined = join(result, value.type)
            if joined is None:
                return UNKNOWN
            result = joined
    return UNKNOWN if isinstance(result, EmptyArray) else result


def _initial(value: Value | None) -> str:
    if isinstance(value, PortRead):
        return f"port {name(value.key.value)}" if value.key else ""
    return name(_short(value.text)) if value and value.text.strip() else ""


def _short(text: str, most: int = 40) -> str:
    text = " ".join(text.split())
    return text if len(text) <= most else f"{text[:most].rpartition(' ')[0] or text[:most]} …"


def _bounds(data: Data | None) -> str:
    lower, upper = (
        (limit.text if isinstance(limit, Expression) else "" for limit in (data.lower, data.upper))
        if data
        else ("", "")
    )
    if lower and upper:
        return f"intended range {name(lower)} to {name(upper)}"
    return f"intended minimum {name(lower)}" if lower else f"intended maximum {name(upper)}" if upper else ""


def _gets(typed: TypedMachine, symbol: Symbol) -> str:
    """A line that lists the values that are assigned to a variable or to a part of it; "" if there are none."""
    sources: dict[str, None] = {}
    target: Expression | None = None
    for value in typed.values:
        if value.place.chart.scope != symbol.scope:
            continue
        if value.use is ValueUse.LOCATION:
            target = value.value if isinstance(value.value, Expression) else None
        elif value.use is ValueUse.ASSIGNED and target is not None:
            path = access_path(target.tree)
            if path is not None and path[0] == symbol.name:
                sources[_source(value.value)] = None
            target = None
    return f"Gets {names(sources, 4)}" if sources else ""


def _source(value: Value) -> str:
    if isinstance(value, Expression):
        return _short(value.text)
    return f"port {value.key.value}" if value.key else "a port"


def _counted(analysis: Analysis, symbol: Symbol) -> str:
    reads: set[Span] = set()
    writes: set[Span] = set()
    for system in analysis.systems_of(symbol.path):
        for use in uses(analysis, symbol.path, system).by_symbol.get(symbol, ()):
            if not use.defines:
                (writes if use.access is Access.WRITE else reads).add(use.span)
    counts = [f"{verb} {_times(len(places))}" for verb, places in (("read", reads), ("written", writes)) if places]
    return sentence(", ".join(counts)) or "Never used"


def _times(count: int) -> str:
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def _becomes(analysis: Analysis, symbol: Symbol, type_: Type) -> str:
    owners = automata(analysis, symbol.path, symbol.scope)
    if not owners:
        return ""
    flat = ["__".join((symbol.name, *path)) for path, _ in leaves(type_)]
    return f"In JANI {names(flat, 4)} of {names(owners, 3)}"


# ---------------------------------------------------------------------- states


def state(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a state: the transitions to it and from it, with their triggers; "" if its machine is not
    found."""
    machine = analysis.machine(symbol.path)
    chart = next((chart for chart in machine.charts if chart.scope == symbol.scope), None) if machine else None
    if machine is None or chart is None:
        return ""
    definition = next(
        (candidate for candidate in chart.states if candidate.id and candidate.id.value == symbol.name), None
    )
    incoming, outgoing = _edges(chart, symbol.name, into=True), _edges(chart, symbol.name, into=False)
    initial = chart.initial is not None and chart.initial.value == symbol.name
    owners = automata(analysis, symbol.path, symbol.scope)
    return paragraphs(
        code(f"{'initial ' if initial else ''}state {symbol.name}"),
        _remark(analysis, symbol.path, definition.element) if definition else "Not defined",
        lines(
            f"**From** {incoming}" if incoming else "" if initial else "No transition leads here",
            f"**To** {outgoing}" if outgoing else "No transition leads away",
            f"In JANI location {name(symbol.name)} of {names(owners, 3)}" if owners and definition else "",
        ),
    )


def _edges(chart: Chart, of: str, *, into: bool) -> str:
    """The states that are connected with the state `of` by transitions, each with the triggers. `into` selects the
    transitions that lead to the state; otherwise, those that start in it."""
    ends: dict[str, dict[str, None]] = {}
    for state in chart.states:
        source = state.id.value if state.id else ""
        for handler in state.handlers:
            for target in handler.targets:
                to = target.state.value if target.state else ""
                if (to if into else source) == of and source and to:
                    share = f" ({target.probability.value})" if target.probability else _rest(handler)
                    ends.setdefault(source if into else to, {})[f"{occasion(handler)}{share}"] = None
    return " · ".join(f"{name(end)} on {_any(triggers)}" for end, triggers in ends.items()).replace(
        " without an event", " by itself"
    )


def _rest(handler: Handler) -> str:
    return " (the rest)" if handler.is_probabilistic else ""


def _any(occasions: Iterable[str]) -> str:
    triggers = list(occasions)
    return ", ".join(triggers[:3]) + (f" and {len(triggers) - 3} more" if len(triggers) > 3 else "")


def occasion(handler: Handler) -> str:
    """A phrase for the trigger of a transition, such as "a message on `/level`"."""
    if handler.event is not None:
        return name(handler.event.value)
    words = _OCCASIONS[handler.trigger]
    about = handler.handle or handler.child
    return (
        f"{words} {name(about.value)}" if about else words.removesuffix(" on").removesuffix(" of").removesuffix(" to")
    )


_PROTOCOL = {
    ProtocolPart.BT_TICK: "tick",
    ProtocolPart.BT_HALT: "halt",
    ProtocolPart.BT_STATUS: "response",
    ProtocolPart.BT_HALTED: "halt_response",
}
"""The parts of the tree protocol between a plugin and its parent -> the end of the event's name in plain SCXML."""


def protocol(analysis: Analysis, path: str, type_: ElementType) -> str:
    """The events of plain SCXML into which an element of the tree protocol is translated, as text; "" for other
    elements, and if no system executes the plugin."""
    part = type_.receives or type_.sends
    end = _PROTOCOL.get(part) if part else None
    nodes = [a for s in linked_systems(analysis, path) for a in s.automata_of(path) if a.instance] if end else []
    events = names((f"{node_id(node)}_{end}" for node in nodes), 4)
    return f"In plain SCXML {events}" if events else ""


# -------------------------------------------------------- handles, ports, machines


def handle(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a declared ROS interface or timer, and its connections in the systems of its machine; "" if
    there is no declaration."""
    declared = declaration(analysis, symbol)
    if declared is None:
        return ""
    kind = _KINDS.get(symbol.kind, symbol.kind.value)
    head = f"{kind} {symbol.name}" + (f" : {declared.type.value}" if declared.type else "")
    return paragraphs(
        code(head), _remark(analysis, symbol.path, declared.element), *_connections(analysis, symbol, declared)
    )


def declaration(analysis: Analysis, symbol: Symbol) -> Declaration | None:
    """The declaration of a handle; `None` if there is none."""
    machine = analysis.machine(symbol.path)
    of_kind = (
        (candidate for candidate in machine.declarations if candidate.kind == symbol.kind) if machine else iter(())
    )
    return next(
        (candidate for candidate in of_kind if candidate.handle and candidate.handle.value == symbol.name), None
    )


def _connections(analysis: Analysis, symbol: Symbol, declared: Declaration) -> Iterator[str]:
    if declared.kind is SymbolKind.TIMER:
        yield rate(declared.rate.value) if isinstance(declared.rate, Name) else _from_port(declared.rate, "rate")
        return
    yield _from_port(declared.interface, "name")
    done: dict[str, None] = {}
    for system in linked_systems(analysis, symbol.path):
        for automaton in system.automata_of(symbol.path):
            for use in automaton.outline.interfaces:
                interface = (
                    automaton.interface_name(use) if (use.kind, use.handle) == (symbol.kind, symbol.name) else None
                )
                if interface:
                    done[channel(analysis, interface_symbol(system.path, use.kind, interface), interface, system)] = (
                        None
                    )
    yield from done
    if not done and isinstance(declared.interface, Name):
        yield f"{sentence(interface_symbol('', declared.kind, '').kind.value)} {name(declared.interface.value)}"


def _from_port(value: Name | PortRead | None, subject: str) -> str:
    return f"Its {subject} comes from port {name(value.key.value)}" if isinstance(value, PortRead) and value.key else ""


def rate(text: str) -> str:
    """The rate and the period of a timer, as text; "" if `text`, its rate in Hz, is not a positive number."""
    hertz = exact_number(text)
    if hertz is None or hertz <= 0:
        return ""
    return f"{float(hertz):g} Hz: every {duration(period(hertz).nanoseconds / NANOSECONDS_PER_SECOND)}"


def duration(seconds: float) -> str:
    """A duration in the greatest unit, from s to ns, in which it is at least 1."""
    for unit, factor in (("s", 1.0), ("ms", 1e3), ("µs", 1e6)):
        if seconds * factor >= 1:
            return f"{seconds * factor:.9g} {unit}"
    return f"{seconds * 1e9:.9g} ns"


def port(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a port of a plugin: type, default, and its values in the nodes of the tree; "" if there is no
    declaration."""
    machine = analysis.machine(symbol.path)
    declared = next((p for p in machine.ports if p.key and p.key.value == symbol.name), None) if machine else None
    if declared is None:
        return ""
    type_ = f" : {declared.type.text}" if declared.type else ""
    bound: dict[str, list[str]] = {}
    for system in linked_systems(analysis, symbol.path):
        for automaton in system.automata_of(symbol.path):
            value = automaton.port(symbol.name)
            shown = "" if value is None else value.text if isinstance(value, PortConstant) else f"{{{value.variable}}}"
            bound.setdefault(shown, []).append(node_id(automaton))
    held = [
        f"{name(value) if value else 'not set'} in {names(nodes, 3)}"
        for value, nodes in list(bound.items())[:_MAX_VALUES]
    ]
    rest = f" and {len(bound) - _MAX_VALUES} other values" if len(bound) > _MAX_VALUES else ""
    return paragraphs(
        code(f"{declared.direction} {symbol.name}{type_}"),
        _remark(analysis, symbol.path, declared.element),
        lines(
            f"Port of {name(machine.name.value)}" if machine and machine.name else "",
            f"**Holds** {' · '.join(held)}{rest}" if held else "",
        ),
    )


_MAX_VALUES = 5
"""The maximum number of values of a port that are listed; further values are counted."""


def node_id(automaton: SystemAutomaton) -> str:
    """The identifier of a node of the executed tree in the names of its events."""
    assert automaton.instance is not None
    return f"bt_{automaton.instance.number}"


def machine(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a machine: its ports and interfaces, its automata in its systems, and its file; that of an
    executed tree, if the symbol is its name; "" if the file is neither."""
    model = analysis.machine(symbol.path)
    if model is None:
        return _executed_tree(analysis, symbol)
    outlines = [a.outline for s in linked_systems(analysis, symbol.path) for a in s.automata_of(symbol.path)]
    listed = [o for s in linked_systems(analysis, symbol.path) for p, o in (*s.nodes, *s.plugins) if p == symbol.path]
    plugins = {p for s in linked_systems(analysis, symbol.path) for p, _ in s.plugins}
    is_plugin = symbol.path in plugins or bool(model.ports)
    nodes = [a for s in linked_systems(analysis, symbol.path) for a in s.automata_of(symbol.path)]
    ports = "".join(
        f"\n  {port.direction} {port.key.value}{f' : {port.type.text}' if port.type else ''}"
        for port in model.ports
        if port.key
    )
    outline = next(iter((*outlines, *listed)), None)
    return paragraphs(
        code(f"{'plugin' if is_plugin else 'node'} {symbol.name}{ports}"),
        _remark(analysis, symbol.path, model.element),
        lines(
            *(_interfaces(outline) if outline else ()),
            _instances(nodes) if is_plugin else f"In JANI automaton {names(a.name for a in nodes)}" if nodes else "",
            file(symbol.path),
        ),
    )


def _executed_tree(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a tree to which a system gives the name of the symbol; "" if there is none."""
    for system in linked_systems(analysis, symbol.path):
        root = next((root for root in system.roots if root.tree == symbol.name), None)
        if root is not None:
            plugins = dict.fromkeys(n.plugin for n in system.instances if n.tree == symbol.name)
            own = (name for name in plugins if system.plugin(name, symbol.name)[0])
            return paragraphs(
                code(f"tree {symbol.name} : {system.tree_uses[root.use].tree}"),
                lines(
                    f"Ticked at {system.tick_rate(symbol.name):g} Hz",
                    f"Plugins {used}" if (used := names(own)) else "",
                    f"Topmost node bt_{root.number}",
                    file(symbol.path),
                ),
            )
    return ""


_VERBS = {
    SymbolKind.PUBLISHER: "Publishes",
    SymbolKind.SUBSCRIBER: "Listens to",
    SymbolKind.SERVICE_SERVER: "Serves",
    SymbolKind.SERVICE_CLIENT: "Calls",
    SymbolKind.ACTION_SERVER: "Offers",
    SymbolKind.ACTION_CLIENT: "Sends goals to",
}


def _interfaces(outline: MachineOutline) -> Iterator[str]:
    for kind, verb in _VERBS.items():
        interfaces = [use.name or f"port {use.port}" for use in outline.interfaces if use.kind == kind]
        yield f"{verb} {names(interfaces)}" if interfaces else ""
    sent, received = (
        (event_use.event for event_use in outline.sent),
        (event_use.event for event_use in outline.received),
    )
    yield f"Sends {found_names}" if (found_names := names(sent)) else ""
    yield f"Receives {found_names}" if (found_names := names(received)) else ""


def _instances(nodes: list[SystemAutomaton]) -> str:
    if not nodes:
        return "No node of the tree uses this plugin"
    trees = names(dict.fromkeys(a.instance.source.tree for a in nodes if a.instance and a.instance.source.tree))
    count = "One node" if len(nodes) == 1 else f"{len(nodes)} nodes"
    return f"{count}{f' in {trees}' if trees else ''}: {names((a.name for a in nodes), 4)}"
