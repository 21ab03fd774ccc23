# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-server`, which missing_server.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.gaps import InterfaceAct
from roaml.model.machine import Declaration, Handler, Machine, RosSend
from roaml.model.system import System
from roaml.model.value_types import CHANNEL_KINDS, find_handle
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, TreeContext, close_names, did_you_mean
from roaml.rules.support.interfaces import Naming, named_here, other_kind
from roaml.text import Span, TextEdit


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
            return RULE.at(span, message, *_rename(context, naming, (other.name,)), related=related)
    close = close_names(channel.name, [c.name for c in served])
    message = f"no machine serves the {kind} `{channel.name}`, so its clients never get a response{did_you_mean(close)}"
    return RULE.at(span, message, *_rename(context, naming, close), related=naming.related)


def _rename(context: MachineContext | TreeContext, naming: Naming, names: Iterable[str]) -> Iterator[Fix]:
    """Fixes that rename an interface where it is declared, and where its name is used as the handle."""
    if not naming.literal:
        return
    spans = [naming.span]
    if isinstance(context, MachineContext):
        declared = [d for d in context.machine.declarations if d.interface and d.interface.span == naming.span]
        spans += [s for d in declared if d.handle is d.interface for s in _handle_spans(context.machine, d)]
    for number, name in enumerate(names):
        edits = tuple(TextEdit(span, name) for span in spans)
        yield Fix(f"Change to `{name}`", edits, preferred=number == 0)


def _handle_spans(machine: Machine, declaration: Declaration) -> Iterator[Span]:
    """The places where the rest of the machine refers to a declaration."""
    for chart in machine.charts:
        users: list[Handler | RosSend] = [h for state in chart.states for h in state.handlers]
        users += [s for s in chart.statements if isinstance(s, RosSend)]
        for user in users:
            if user.handle is not None and find_handle(machine, user) is declaration:
                yield user.handle.span


RULE = Rule(
    "missing-server",
    Severity.ERROR,
    "No machine serves a service or action that is used.",
    machine=check,
    tree=check,
    whole=True,
)
