# SPDX-License-Identifier: Apache-2.0
"""interface-type-conflict: see interface_type_conflict.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.interfaces.registry import NotFound
from roaml.model.syntax import Name
from roaml.model.system import CLOCK_TOPIC, CLOCK_TYPE, Channel, System
from roaml.model.value_types import CHANNEL_KINDS, INTERFACE_KINDS
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import declared, other_kind
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    if context.system is None:
        return
    for kind, channel_kind in CHANNEL_KINDS.items():
        for declaration, _, channel in declared(context, kind):
            if declaration.type is None:
                continue
            mine = normal(declaration.type.value)
            for type_, related in _others(context.system, kind, channel):
                if normal(type_) != mine and _known(context, kind, declaration.type.value, type_):
                    name = declaration.interface.value if isinstance(declaration.interface, Name) else channel.name
                    yield RULE.at(
                        declaration.type.span,
                        f"the {channel_kind.value} `{name}` has the type `{type_}` elsewhere",
                        Fix(f"Change to `{type_}`", (TextEdit(declaration.type.span, type_),), preferred=not related),
                        # The reference translator does not compare the types of a topic (docs/spec/ros.md#topics).
                        severity=Severity.WARNING if channel_kind is SymbolKind.TOPIC else Severity.ERROR,
                        related=related,
                    )
                    break


def _others(system: System, kind: SymbolKind, channel: Channel) -> Iterator[tuple[str, tuple[Related, ...]]]:
    """The types at the other side; if there are none, those at the same side."""
    other = [endpoint for endpoint in channel.endpoints if endpoint.use.kind is other_kind(kind)]
    is_clock = kind is SymbolKind.SUBSCRIBER and channel.name == CLOCK_TOPIC and system.has_timer
    if is_clock:
        yield CLOCK_TYPE, ()
    for endpoint in other if other or is_clock else channel.endpoints:
        yield endpoint.use.type, (Related(endpoint.symbol, "declared here"),)


def _known(context: MachineContext, kind: SymbolKind, *types: str) -> bool:
    """Whether all these types exist; unknown-ros-type reports those that do not."""
    return not any(isinstance(context.interface(INTERFACE_KINDS[kind], type_), NotFound) for type_ in types)


def normal(type_: str) -> str:
    """`package/Type`, whether or not the kind is written in between."""
    parts = type_.split("/")
    return f"{parts[0]}/{parts[-1]}"


RULE = Rule(
    "interface-type-conflict",
    Severity.ERROR,
    "A topic, service or action is declared with different types.",
    machine=check,
)
