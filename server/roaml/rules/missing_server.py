# SPDX-License-Identifier: Apache-2.0
"""missing-server: see missing_server.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.machine import Communicate, Declaration, Handler, Machine
from roaml.model.syntax import Name
from roaml.model.system import Channel, System
from roaml.model.typing import find_handle
from roaml.rules.interfaces import declared, name_span
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean
from roaml.text import Span, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    system = context.system
    if system is None or not system.complete:
        return
    for kind, what in (("service-client", "service"), ("action-client", "action")):
        for declaration, _, channel in declared(context, kind):
            if not channel.sources:
                yield _finding(context.machine, system, declaration, channel, what)


def _finding(machine: Machine, system: System, declaration: Declaration, channel: Channel, what: str) -> Finding:
    channels = system.services if what == "service" else system.actions
    served = [c for c in channels.values() if c.sources]
    span = name_span(declaration)
    for other in served:
        if other.name.lstrip("/") == channel.name.lstrip("/"):
            message = (
                f"nobody serves `{channel.name}`, but `{other.name}`: the leading `/` makes a difference for {what}s"
            )
            related: list[Related] = [Related(other.sources[0].symbol, "the server")]
            return RULE.at(span, message, *_rename(machine, declaration, (other.name,)), related=related)
    close = close_names(channel.name, [c.name for c in served])
    message = f"nobody serves the {what} `{channel.name}`{did_you_mean(close)}"
    return RULE.at(span, message, *_rename(machine, declaration, close))


def _rename(machine: Machine, declaration: Declaration, names: Iterable[str]) -> Iterator[Fix]:
    """Another interface for a declaration, unless its name comes from a port."""
    if not isinstance(declaration.interface, Name):
        return
    spans = [declaration.interface.span]
    if declaration.handle is declaration.interface:
        spans += _handle_spans(machine, declaration)
    for number, name in enumerate(names):
        edits = tuple(TextEdit(span, name) for span in spans)
        yield Fix(f"Change to `{name}`", edits, preferred=number == 0)


def _handle_spans(machine: Machine, declaration: Declaration) -> Iterator[Span]:
    """Where the rest of the machine names a declaration."""
    for chart in machine.charts:
        users: list[Handler | Communicate] = [h for state in chart.states for h in state.handlers]
        users += [s for s in chart.statements if isinstance(s, Communicate)]
        for user in users:
            if user.handle is not None and find_handle(machine, user) is declaration:
                yield user.handle.span


RULE = Rule("missing-server", Severity.ERROR, "A service or action is used that nobody serves.", machine=check)
