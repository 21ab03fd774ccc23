# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-client`, which missing_client.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.gaps import InterfaceAct
from roaml.model.syntax import Name
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, did_you_mean
from roaml.rules.support.interfaces import close_channels, declared, intended_channels, name_span, other_kind, renamings


def check(context: MachineContext) -> Iterator[Finding]:
    system = context.system
    if system is None:
        return
    for kind, kind_name, channels in (
        (SymbolKind.SERVICE_SERVER, "service", system.services),
        (SymbolKind.ACTION_SERVER, "action", system.actions),
    ):
        unused = [(declaration, channel) for declaration, _, channel in declared(context, kind) if not channel.users]
        unserved = [c.name for c in channels.values() if c.users and not c.sources] if unused else []
        intended = intended_channels(system, other_kind(kind)) if unused else frozenset()
        for declaration, channel in unused:
            if channel.name in intended:
                continue  # misleading-handle reports the client
            if not system.may(InterfaceAct(other_kind(kind)), channel.name):
                close = close_channels(channel.name, unserved)
                message = f"no machine uses the {kind_name} `{channel.name}`, so the server is never called"
                message += did_you_mean(close)
                names = close if isinstance(declaration.interface, Name) else ()
                fixes = renamings(context, name_span(declaration), names)
                yield RULE.at(name_span(declaration), message, *fixes)


RULE = Rule(
    "missing-client", Severity.WARNING, "No machine uses a service or action that is served.", machine=check, whole=True
)
