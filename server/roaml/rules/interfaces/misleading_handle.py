# SPDX-License-Identifier: Apache-2.0
"""The rule `misleading-handle`, which misleading_handle.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.property_links import LinkedFile
from roaml.model.property_problems import ProblemKind
from roaml.model.syntax import Name
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import declared, find_use, intended, renamings
from roaml.rules.support.property_problems import problems

_WORDS = {
    SymbolKind.PUBLISHER: "publishes on the topic",
    SymbolKind.SUBSCRIBER: "subscribes to the topic",
    SymbolKind.SERVICE_CLIENT: "calls the service",
    SymbolKind.ACTION_CLIENT: "is a client of the action",
}


def check(context: MachineContext) -> Iterator[Finding]:
    """Report declarations whose handle is the name of another interface of the same type, which has no other side."""
    if context.system is None:
        return
    for kind, does in _WORDS.items():
        for declaration, automaton, current in declared(context, kind):
            use = find_use(automaton, declaration)
            other = intended(context.system, use, current) if use is not None else None
            if use is None or other is None or not isinstance(declaration.interface, Name):
                continue
            endpoint = other.endpoints[0]
            name = endpoint.use.name
            lonely = {
                SymbolKind.PUBLISHER: "nothing publishes on",
                SymbolKind.SUBSCRIBER: "nothing subscribes to",
            }.get(kind, "nothing uses")
            message = (
                f"`{use.handle}` {does} `{use.name}`, but {lonely} `{name}`, which has the same type; did you mean "
                f"`{name}`?"
            )
            span = declaration.interface.span
            related = (Related(endpoint.symbol, "the other side"),)
            yield RULE.at(span, message, *renamings(context, span, (name,)), related=related)


def _ports(file: LinkedFile) -> Iterator[Finding]:
    return problems(RULE, ProblemKind.MISLEADING, file)


RULE = Rule(
    "misleading-handle",
    Severity.WARNING,
    "A handle has the name of another topic, service or action, which has no other side.",
    machine=check,
    xml_properties=_ports,
    whole=True,
)
