# SPDX-License-Identifier: Apache-2.0
"""Completion of the parameters of an event: the parameters that receivers read, or that other senders send."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, Snippet
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.model.machine import Send
from roaml.roles import SymbolKind


def parameter_names(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The names that a `<param>` may have: the parameters that the `<send>` around the caret does not send yet."""
    for statement in request.chart.statements if request.chart else ():
        if isinstance(statement, Send) and any(typed.element is statement.element for typed in subject.parents):
            yield from _missing(request, statement, subject)


def parameters_to_add(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The `<param>` elements for a `<send>`: one item for each missing parameter, and one item for all of them."""
    for statement in request.chart.statements if request.chart else ():
        if not isinstance(statement, Send) or statement.element is not subject.element:
            continue
        missing = list(_missing(request, statement, subject))
        if len(missing) > 1:
            made = Snippet()
            for number, item in enumerate(missing):
                _param(made.text("\n" if number else ""), item.label)
            detail = ", ".join(item.label for item in missing)
            yield CompletionItem("all parameters", ItemKind.SKELETON, str(made), detail, None, Rank.BEST, "param all")
        for item in missing:
            insert = str(_param(Snippet(), item.label))
            yield CompletionItem(f"param {item.label}", ItemKind.SKELETON, insert, item.detail, item.about, Rank.LIKELY)


def _param(made: Snippet, name: str) -> Snippet:
    return made.text(f'<param name="{name}" expr="').stop().text('"/>')


def _missing(request: Request, send: Send, subject: CompletionSubject) -> Iterator[CompletionItem]:
    if send.event is None:
        return
    given = {param.name.value for param in send.params if param.name and param.element is not subject.element}
    for system in request.systems:
        event = system.events.get(send.event.value)
        if event is None:
            continue
        types = dict(event.data.members)
        reads = dict.fromkeys(name for _, received in event.receivers for name in sorted(received.reads))
        for name in dict.fromkeys((*reads, *types)):
            if name not in given:
                about = Symbol(system.path, SymbolKind.PARAMETER, name, event.name)
                detail = str(types[name]) if name in types else "read by a receiver"
                rank = Rank.BEST if name in reads else Rank.USUAL
                yield CompletionItem(name, ItemKind.MEMBER, detail=detail, about=about, rank=rank)
