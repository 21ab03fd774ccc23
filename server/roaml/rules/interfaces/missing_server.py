# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-server`, which missing_server.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.gaps import InterfaceAct
from roaml.model.system import System
from roaml.model.value_types import CHANNEL_KINDS
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, TreeContext, did_you_mean
from roaml.rules.support.interfaces import Naming, close_channels, named_here, other_kind, renamings


def check(context: MachineContext | TreeContext) -> Iterator[Finding]:
    system = context.system
    if system is None:
        return
    for kind in (SymbolKind.SERVICE_CLIENT, SymbolKind.ACTION_CLIENT):
        for naming in named_here(context, kind):
            if not naming.channel.sources and not system.may(InterfaceAct(other_kind(kind)), naming.channel.name):
                yield _finding(context, system, naming, CHANNEL_KINDS[kind])


def _finding(context: MachineContext | TreeContext, system: System, naming: Naming, kind: SymbolKind) -> Finding:
    served = [c for c in system.channels(kind).values() if c.sources]
    span, channel = naming.span, naming.channel
    for other in served:
        if other.name.lstrip("/") == channel.name.lstrip("/"):
            message = (
                f"no machine serves `{channel.name}`, only `{other.name}`: the leading `/` makes a difference "
                f"for {kind}s"
            )
            related = (Related(other.sources[0].symbol, "the server"), *naming.related)
            fixes = renamings(context, span, (other.name,) if naming.literal else ())
            return RULE.at(span, message, *fixes, related=related)
    close = close_channels(channel.name, [c.name for c in served])
    message = f"no machine serves the {kind} `{channel.name}`, so its clients never get a response{did_you_mean(close)}"
    fixes = renamings(context, span, close if naming.literal else ())
    return RULE.at(span, message, *fixes, related=naming.related)


RULE = Rule(
    "missing-server",
    Severity.ERROR,
    "No machine serves a service or action that is used.",
    machine=check,
    tree=check,
    whole=True,
)
