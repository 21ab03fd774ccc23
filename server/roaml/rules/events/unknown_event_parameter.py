# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-event-parameter`, which unknown_event_parameter.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.expr.infer import UnknownMember
from roaml.expr.types import Struct, StructKind
from roaml.model.gaps import GapAct
from roaml.model.system import PlainEvent
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements


def check(context: MachineContext) -> Iterator[Finding]:
    """Report parameters that no sender sends, unless an unreadable sender might send them."""
    if context.system is None:
        return
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, UnknownMember) and isinstance(problem.owner, Struct):
                event = context.system.events.get(problem.owner.event)
                if problem.owner.kind is not StructKind.EVENT or event is None or not event.senders:
                    continue
                if not context.system.may(GapAct.PARAMETER, event.name):
                    yield from _check(problem, event, [name for name, _ in problem.owner.members])


def _check(problem: UnknownMember, event: PlainEvent, params: list[str]) -> Iterator[Finding]:
    if any(name.startswith(f"{problem.name}.") for name in params):
        return  # the first part of a dotted name
    close = close_names(problem.name, params)
    senders = dict.fromkeys(Symbol(automaton.path, SymbolKind.EVENT, event.name) for automaton, _ in event.senders)
    related = [Related(symbol, "sent here") for symbol in [*senders][:3]]
    message = f"no machine sends a parameter `{problem.name}` with the event `{event.name}`{did_you_mean(close)}"
    yield RULE.at(problem.span, message, *replacements(problem.span, close), related=related)


RULE = Rule(
    "unknown-event-parameter",
    Severity.ERROR,
    "No sender of an event sends a parameter that is read.",
    machine=check,
    whole=True,
)
