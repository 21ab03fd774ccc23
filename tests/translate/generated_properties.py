# SPDX-License-Identifier: Apache-2.0
"""Properties in XML for any system, made from its own interfaces, events and nodes: every pattern, scope and kind of
time comes up, and the choice depends on nothing but the name of the system."""

from __future__ import annotations

import random
import re
from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from roaml import api
from roaml.expr.types import BASE_TYPES, Scalar, ScalarKind, Struct, leaves
from roaml.ide.code_actions.inputs import add_input
from roaml.model.property_links import clock_step
from roaml.model.system import Channel, System
from roaml.model.system_file import SystemSection
from roaml.model.tree_paths import short_paths
from roaml.observers.properties import Pattern, ScopeKind
from roaml.project.analysis import Analysis
from roaml.roles import ProtocolPart
from roaml.text import apply_edits

FILE_NAME = "generated.xml"
NUMBERS = (0, 1, 2, 5, 10, 30)
FORMULAS = ("{{ {0} }} -> O {{ {1} }}", "O {{ {1} }} || !{{ {0} }}", "{{ {0} }} -> !{{ {1} }} S {{ {0} }}")
TIMED_FORMULAS = (
    "{{ {0} }} -> O[:{2}] {{ {1} }}",
    "{{ {0} }} -> (!{{ {1} }} S[1:] {{ {0} }}) || H[1:] !{{ {1} }}",
    "O {{ {1} }} || H[:{2}] !{{ {0} }}",
)


@dataclass(frozen=True)
class ListeningPort:
    """
    Attributes:
        event: the id of the event variable.
        values: the ids of the state variables, with their types.
    """

    text: str
    event: str
    values: tuple[tuple[str, Scalar], ...]


def with_properties(
    path: Path, interfaces: Iterable[str], count: int, chosen: Container[str] | None = None
) -> api.LoadedSystem:
    """A system with generated properties beside its own; its files do not change.

    Args:
        count, chosen: see `property_file`.
    """
    plain = api.load(str(path), interfaces)
    analysis = plain.analysis
    added = str(path.with_name(FILE_NAME))
    edits = add_input(analysis, plain.path, SystemSection.PROPERTIES, "xml", added)
    source = analysis.source(plain.path)
    assert source is not None
    texts = {plain.path: apply_edits(source.text, edits), added: property_file(plain, path.parent.name, count, chosen)}
    return api.load(str(path), interfaces, texts=texts)


def property_file(source: api.LoadedSystem, label: str, count: int, chosen: Container[str] | None = None) -> str:
    """The text of a file with properties `g0`, `g1`, …

    Args:
        label: determines the choice.
        count: the number of properties.
        chosen: the names of the properties that the file contains; `None` for all.
    """
    system = source.analysis.system(source.path)
    assert system is not None
    random_ = random.Random(f"{label} {Path(source.path).name}")
    ports = [*_ports(source.analysis, system)]
    random_.shuffle(ports)
    step = clock_step(system)
    guarantees: dict[str, str] = {}
    patterns = [pattern for pattern in Pattern if pattern is not Pattern.RECURRENCE or step is not None]
    scopes = list(ScopeKind)
    random_.shuffle(scopes)
    for i in range(count):
        conditions = [_condition(random_, ports[(i + k) % len(ports)]) for k in range(4)]
        if i == count - 1:
            formula = random_.choice(FORMULAS if step is None else TIMED_FORMULAS)
            text = formula.format(*conditions[:2], random_.randint(1, 3))
            guarantees[f"g{i}"] = f'<property id="g{i}" logic="pmtl" expr={quoteattr(text)} />'
            continue
        pattern = patterns[i % len(patterns)]
        if pattern is Pattern.UNIVERSALITY:
            conditions[0] = f"!({conditions[0]})"  # events are not true at the start
        guarantees[f"g{i}"] = _property(random_, f"g{i}", pattern, scopes[i % len(scopes)], conditions, step)
    texts = "\n".join(port.text for port in ports)
    return (
        f"<properties>\n<ports>\n{texts}\n</ports>\n<guarantees>\n"
        + "\n".join(text for name, text in guarantees.items() if chosen is None or name in chosen)
        + ("\n</guarantees>\n</properties>\n")
    )


def _property(
    random_: random.Random, name: str, pattern: Pattern, scope: ScopeKind, conditions: Sequence[str], step: int | None
) -> str:
    events = "".join(f"<event>{escape(text)}</event>" for text in conditions[: 2 if pattern.is_binary else 1])
    scope_events = f" event={quoteattr(conditions[2])}" if scope.has_event else ""
    scope_events += f" until={quoteattr(conditions[3])}" if scope.has_until else ""
    interval = ""
    is_timed = pattern is Pattern.RECURRENCE or random_.random() < 0.5
    if step is not None and is_timed:
        lower = 0 if pattern is Pattern.RECURRENCE else random_.choice((0, 0, 1))
        within = f'within="{step * (lower + random_.randint(0, 4))}" time_unit="ns"'
        interval = f'<time_interval after="{step * lower}" {within} />' if lower else f"<time_interval {within} />"
    head = f'<property id="{name}" pattern="{pattern.value}">'
    body = f"<events>{events}</events>" if pattern.is_binary else events
    return f'{head}{body}<scope type="{scope.value}"{scope_events} />{interval}</property>'


def _condition(random_: random.Random, port: ListeningPort) -> str:
    if not port.values or random_.random() < 0.5:
        return port.event
    id_, type_ = random_.choice(port.values)
    if type_.kind is ScalarKind.BOOL:
        compared = id_
    else:
        compared = f"{id_} {random_.choice(('<=', '>=', '=='))} {random_.choice(NUMBERS)}"
    return random_.choice((compared, f"{port.event} && {compared}"))


# ------------------------------------------------------------------------ ports


def _ports(analysis: Analysis, system: System) -> Iterator[ListeningPort]:
    find = analysis.environment(system.path).interface

    def port(kind: str, channel: Channel, event: str, part: ProtocolPart, struct: str) -> Iterator[ListeningPort]:
        """The port, if something sends its event."""
        senders = [endpoint for endpoint in channel.endpoints if part in endpoint.use.sends]
        if not senders:
            return
        use = senders[0].use
        written = senders[0].automaton.interface_name(use)
        type_ = find({"topic": "msg", "service": "srv", "action": "action"}[kind], use.type)
        sent = {field.name for field in dict(use.fields).get(part, ())}
        fields = [(path, t) for path, t in _scalars(type_.part(struct) if type_ and struct else None) if path in sent]
        attributes = f'{kind}_name="{written}" type="{use.type}" event="{event}"'
        yield _port(f"ros_{kind}", attributes, f"{channel.name}_{event}", "field", fields)

    for channel in system.topics.values():
        yield from port("topic", channel, "publish", ProtocolPart.MESSAGE, "message")
    for channel in system.services.values():
        yield from port("service", channel, "request", ProtocolPart.REQUEST, "request")
        yield from port("service", channel, "response", ProtocolPart.RESPONSE, "response")
    for channel in system.actions.values():
        yield from port("action", channel, "goal_request", ProtocolPart.GOAL, "goal")
        yield from port("action", channel, "goal_response", ProtocolPart.GOAL_ACCEPTED, "")
        yield from port("action", channel, "feedback", ProtocolPart.FEEDBACK, "feedback")
        yield from port("action", channel, "result", ProtocolPart.RESULT, "result")
    paths = short_paths(system)
    for number, path in paths.items():
        # Siblings of one name have no path of their own.
        is_named = [*paths.values()].count(path) == 1
        events = ("tick", "response") if system.by_instance[number].outline.plugin.answers_tick else ("tick",)
        for event in events:
            fields = [("status", BASE_TYPES["int32"])] if event == "response" else []
            if is_named:
                yield _port("bt_node", f'node="{path}" event="{event}"', f"node{number}_{event}", "field", fields)
            elif event == "response":
                name = f"bt_{number}_{event}"
                yield _port("scxml_event_send", f'event="{name}"', name, "param", fields)
    for event in system.events.values():
        if event.senders:
            params = [(path.replace(".", "__"), type_) for path, type_ in _scalars(event.data)]
            yield _port("scxml_event_send", f'event="{event.name}"', event.name, "param", params)


def _scalars(struct: Struct | None) -> Iterator[tuple[str, Scalar]]:
    for path, type_ in leaves(struct) if struct is not None else ():
        if isinstance(type_, Scalar) and type_.kind is not ScalarKind.STRING:
            yield ".".join(path), type_


def _port(element: str, attributes: str, name: str, key: str, fields: Sequence[tuple[str, Scalar]]) -> ListeningPort:
    id_ = re.sub(r"\W", "_", name.strip("/"), flags=re.ASCII)
    variables = [f'<event_var id="{id_}" />']
    values = []
    for path, type_ in fields:
        variable = f"{id_}__{re.sub(r'[^a-zA-Z0-9]', '_', path)}"
        initial = {ScalarKind.BOOL: "false", ScalarKind.REAL: "0.0"}.get(type_.kind, "0")
        variables.append(f'<state_var id="{variable}" type="{type_}" {key}="{path}" expr="{initial}" />')
        values.append((variable, type_))
    return ListeningPort(f"<{element} {attributes}>{''.join(variables)}</{element}>", id_, tuple(values))
