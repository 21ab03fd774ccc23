# SPDX-License-Identifier: Apache-2.0
"""The rule `duplicate-handle`, which duplicate_handle.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import removal
from roaml.model.machine import Declaration, Handler, RosSend
from roaml.model.syntax import Name, PortRead
from roaml.model.value_types import find_handle
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, unused
from roaml.text import Span, TextEdit

CLIENTS = {SymbolKind.SERVICE_CLIENT: "service", SymbolKind.ACTION_CLIENT: "action"}


def check(context: MachineContext) -> Iterator[Finding]:
    handles: dict[str, Declaration] = {}
    clients: dict[tuple[SymbolKind, str], Declaration] = {}
    for declaration in context.machine.declarations:
        if declaration.handle is None:
            continue
        before = handles.setdefault(declaration.handle.value, declaration)
        if before is not declaration:
            yield _same_handle(context, declaration, declaration.handle, before)
        elif declaration.kind in CLIENTS and isinstance(declaration.interface, Name):
            client = clients.setdefault((declaration.kind, declaration.interface.value), declaration)
            if client is not declaration:
                yield _same_client(declaration, declaration.interface, client)
    yield from _same_threads(context)


def _same_handle(context: MachineContext, declaration: Declaration, handle: Name, before: Declaration) -> Finding:
    assert before.handle is not None
    related = (Related(before.handle.span, "declared first here"),)
    if _meaning(declaration) == _meaning(before):
        message = f"`{handle.value}` is declared again with the same meaning; remove one of the declarations"
        remove = Fix("Remove this declaration", (removal(context.source.text, declaration.element.span),), safe=True)
        # The reference translator rejects two timers with one name, even if their rates are equal
        # (docs/spec/ros.md#timers).
        severity = Severity.ERROR if declaration.kind is SymbolKind.TIMER else Severity.WARNING
        return RULE.at(handle.span, message, remove, severity=severity, related=related)
    return RULE.at(
        handle.span,
        f"`{handle.value}` is declared twice; give one of the declarations another `name`",
        _rename(context, declaration, handle),
        # If the declarations are of different kinds, each use still has one meaning here; the reference translator
        # uses the first declaration (docs/spec/ros.md#handles).
        severity=Severity.ERROR if before.kind == declaration.kind else Severity.WARNING,
        related=related,
    )


def _rename(context: MachineContext, declaration: Declaration, handle: Name) -> Fix:
    """A fix that renames a declaration and all its uses."""
    machine = context.machine
    new = unused(handle.value.strip("/").replace("/", "_"), (d.handle.value for d in machine.declarations if d.handle))
    users: list[Handler | RosSend] = []
    for chart in machine.charts:
        users += [h for state in chart.states for h in state.handlers]
        users += [s for s in chart.statements if isinstance(s, RosSend)]
    named = [user.handle.span for user in users if user.handle and find_handle(machine, user) is declaration]
    if declaration.element.get("name") is not None:
        edit = TextEdit(handle.span, new)
    else:
        end = declaration.element.name_span.end
        edit = TextEdit(Span(end, end), f' name="{new}"')
    return Fix(f"Rename this declaration to `{new}`", (edit, *(TextEdit(span, new) for span in named)), preferred=False)


def _meaning(declaration: Declaration) -> tuple[SymbolKind, tuple[str, ...]]:
    values = (declaration.interface, declaration.type, declaration.rate)
    return declaration.kind, tuple(map(_written, values))


def _written(value: Name | PortRead | None) -> str:
    if isinstance(value, PortRead):
        return f"<{value.key.value if value.key else ''}>"
    return value.value if value else ""


def _same_client(declaration: Declaration, interface: Name, before: Declaration) -> Finding:
    """The finding for a service or action that a client declares twice (docs/spec/ros.md#services)."""
    assert before.handle is not None
    message = (
        f"the {CLIENTS[declaration.kind]} `{interface.value}` is already declared as `{before.handle.value}`; "
        "use that declaration"
    )
    return RULE.at(interface.span, message, related=(Related(before.handle.span, "declared first here"),))


def _same_threads(context: MachineContext) -> Iterator[Finding]:
    """Report repeated declarations of threads, which would create two threads for each number
    (docs/spec/ros.md#threads)."""
    known: dict[str, Name] = {}
    for thread in context.machine.threads:
        if thread.server is None:
            continue
        before = known.setdefault(thread.server.value, thread.server)
        if before is not thread.server:
            message = f"the threads of `{thread.server.value}` are already declared; set their number in `n_threads`"
            yield RULE.at(thread.server.span, message, related=(Related(before.span, "declared first here"),))


RULE = Rule("duplicate-handle", Severity.ERROR, "Two declarations have the same name.", machine=check)
