# SPDX-License-Identifier: Apache-2.0
"""Completion of the names of parameters of models (docs/spec/parameters.md)."""

from __future__ import annotations

from collections.abc import Container, Iterator

from roaml.diagnostics import Symbol
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.describe.parameters import declared_in
from roaml.project.paths import resolve
from roaml.regex import regex
from roaml.roles import SymbolKind
from roaml.text import Span

_SUBSTITUTION = regex(r"\$\(var\s+(\w*)\Z")
_NAME = regex(r"\w*")


def parameters_in_scope(request: Request, hidden: Container[str] = ()) -> Iterator[CompletionItem]:
    """Items for the parameters that the file can use, without those that the variables `hidden` hide."""
    seen: set[str] = set()
    for owner in dict.fromkeys((request.path, request.system_path or request.path)):
        for item in _declared(request, owner):
            if item.label not in hidden and item.label not in seen:
                seen.add(item.label)
                yield item


def parameters_of_input(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """Items for the parameters of the file that the enclosing `<input>` names."""
    src = subject.parents[-1].element.get("src") if subject.parents else None
    if src is not None and src.value:
        yield from _declared(request, resolve(request.path, src.value))


def in_substitution(request: Request, span: Span) -> tuple[Span, list[CompletionItem]] | None:
    """The completions after `$(var `, with the span that they replace; `None` elsewhere.

    Args:
        span: the span of the value that contains the caret.
    """
    text = request.file.document.text
    match = _SUBSTITUTION.search(text, span.start, request.offset)
    if match is None:
        return None
    name = _NAME.match(text, request.offset)
    end = name.end() if name is not None else request.offset
    return Span(request.offset - len(match[1]), end), list(parameters_in_scope(request))


def _declared(request: Request, path: str) -> Iterator[CompletionItem]:
    for declared in declared_in(request.analysis, path):
        about = Symbol(path, SymbolKind.MODEL_PARAMETER, declared.name.value)
        detail = f"parameter: {declared.type}"
        yield CompletionItem(declared.name.value, ItemKind.VARIABLE, detail=detail, about=about, rank=Rank.LIKELY)
