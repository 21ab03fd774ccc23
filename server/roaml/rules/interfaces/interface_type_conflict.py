# SPDX-License-Identifier: Apache-2.0
"""The rule `interface-type-conflict`, which interface_type_conflict.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.types import leaves, same_kind
from roaml.interfaces.registry import NotFound
from roaml.model.machine import Declaration
from roaml.model.outline import InterfaceUse
from roaml.model.syntax import Name
from roaml.model.system import CLOCK_TOPIC, CLOCK_TYPE, Channel, System, SystemAutomaton
from roaml.model.value_types import CHANNEL_KINDS, INTERFACE_KINDS
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, TreeContext
from roaml.rules.support.interfaces import declared, find_use, named_by_ports, other_kind, port_span
from roaml.rules.support.types import phrase
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    if context.system is None:
        return
    for kind in CHANNEL_KINDS:
        for declaration, automaton, channel in declared(context, kind):
            use = find_use(automaton, declaration)
            if use is not None and is_misdirected(context.system, automaton, use, channel):
                continue  # reported in the tree
            finding = _conflict(context, context.system, declaration, channel)
            if finding is not None:
                yield finding


def in_tree(context: TreeContext) -> Iterator[Finding]:
    """Report the ports that name a topic, service or action of another type for a node, if other nodes of the plugin
    name right ones: not the type is wrong then, but the name."""
    system = context.system
    if system is None:
        return
    for node, automaton, use in named_by_ports(context):
        channel = system.channel(automaton, use)
        if channel is None or not is_misdirected(system, automaton, use, channel):
            continue
        other = next(end for end in channel.endpoints if end.use.kind is other_kind(use.kind))
        what = CHANNEL_KINDS[use.kind]
        message = (
            f"the {what} `{channel.name}` has the type `{other.use.type}`, but `{automaton.outline.name}` uses it as "
            f"`{use.type}`, the type of the {what}s that its other nodes name; name another one"
        )
        related = [Related(other.symbol, "declared here"), Related(automaton.symbol(use), "used here")]
        severity = Severity.WARNING if what is SymbolKind.TOPIC else Severity.ERROR
        yield RULE.at(port_span(node, use.port), message, severity=severity, related=related)


def is_misdirected(system: System, automaton: SystemAutomaton, use: InterfaceUse, channel: Channel) -> bool:
    """Whether the port of a node names a topic, service or action whose other side has another type, although the same
    declaration has the type of the other side in another node."""

    def agrees(other: Channel) -> bool | None:
        types = {normal(end.use.type) for end in other.endpoints if end.use.kind is other_kind(use.kind)}
        return normal(use.type) in types if types else None

    if not use.port or agrees(channel) is not False:
        return False
    for sibling in system.automata_of(automaton.path):
        same = sibling.outline.use(use.kind, use.handle) if sibling is not automaton else None
        of_sibling = system.channel(sibling, same) if same is not None else None
        if of_sibling is not None and agrees(of_sibling):
            return True
    return False


def _conflict(context: MachineContext, system: System, declaration: Declaration, channel: Channel) -> Finding | None:
    """The finding for a declaration whose type differs from another declaration of the topic, service or action; `None`
    if all types agree."""
    if declaration.type is None:
        return None
    kind, mine = declaration.kind, declaration.type.value
    channel_kind = CHANNEL_KINDS[kind]
    is_topic, has_port = channel_kind is SymbolKind.TOPIC, not isinstance(declaration.interface, Name)
    others = tuple(_others(system, kind, channel))
    has_other_side = not all(is_same_side for _, _, is_same_side in others)
    for type_, related, is_same_side in others:
        if normal(type_) == normal(mine) or not _known(context, kind, mine, type_):
            continue
        # All publishers of a topic share a variable for each field. `type-mismatch` reports a subscriber that reads a
        # field of another type, unless a port names the topic.
        clash = _clash(context, mine, type_) if is_topic and (is_same_side or has_port) else ""
        if is_same_side and has_other_side and not (clash and kind is SymbolKind.PUBLISHER):
            continue
        name = declaration.interface.value if isinstance(declaration.interface, Name) else channel.name
        return RULE.at(
            declaration.type.span,
            f"the {channel_kind.value} `{name}` has the type `{type_}` elsewhere{clash}; use the same type",
            Fix(f"Change to `{type_}`", (TextEdit(declaration.type.span, type_),), preferred=not related),
            # The reference translator does not compare the types of a topic (docs/spec/ros.md#topics).
            severity=Severity.WARNING if is_topic and not clash else Severity.ERROR,
            related=related,
        )
    return None


def _others(system: System, kind: SymbolKind, channel: Channel) -> Iterator[tuple[str, tuple[Related, ...], bool]]:
    """The types in all declarations of `channel`, each with its related places, and whether it is on the side of
    `kind`, for example a publisher. Types on the other side come first, because they take precedence."""
    other = [endpoint for endpoint in channel.endpoints if endpoint.use.kind is other_kind(kind)]
    is_clock = kind is SymbolKind.SUBSCRIBER and channel.name == CLOCK_TOPIC and system.has_timer
    if is_clock:
        yield CLOCK_TYPE, (), False
    for endpoint in other:
        if is_misdirected(system, endpoint.automaton, endpoint.use, channel):
            continue
        yield endpoint.use.type, (Related(endpoint.symbol, "declared here"),), False
    for endpoint in channel.endpoints:
        if endpoint.use.kind is kind:
            yield endpoint.use.type, (Related(endpoint.symbol, "declared here"),), True


def _clash(context: MachineContext, mine: str, other: str) -> str:
    """The part of the finding about a field whose values have different kinds in the two types; an empty string if the
    kinds of all common fields agree."""
    messages = [context.interface(INTERFACE_KINDS[SymbolKind.PUBLISHER], type_) for type_ in (mine, other)]
    fields, theirs = ({} if isinstance(m, NotFound) else dict(leaves(m.part("message"))) for m in messages)
    for path, type_ in fields.items():
        if path in theirs and not same_kind(type_, theirs[path]):
            return f", and its field `{'.'.join(path)}` is {phrase(theirs[path])} there and {phrase(type_)} here"
    return ""


def _known(context: MachineContext, kind: SymbolKind, *types: str) -> bool:
    """Whether all of `types` exist; unknown-ros-type reports those that do not."""
    return not any(isinstance(context.interface(INTERFACE_KINDS[kind], type_), NotFound) for type_ in types)


def normal(type_: str) -> str:
    """The type as `package/Type`, without the kind that may be between them (`package/msg/Type`)."""
    parts = type_.split("/")
    return f"{parts[0]}/{parts[-1]}"


RULE = Rule(
    "interface-type-conflict",
    Severity.ERROR,
    "A topic, service or action is declared with different types.",
    machine=check,
    tree=in_tree,
    whole=True,
)
