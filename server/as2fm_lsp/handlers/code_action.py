# SPDX-License-Identifier: Apache-2.0
"""`textDocument/codeAction` and `codeAction/resolve`: actions at a place, and for a whole system.

- An edit is computed when the client resolves the action, if the client supports that. Nothing is stored in between, so
  an action is resolved against the current text.
- An action that creates or renames files is offered only to clients that support it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers import expectation, translate
from as2fm_lsp.handlers.workspace_edit import workspace_edit
from roaml.diagnostics import Diagnostic
from roaml.facts import Facts, facts_from_json, facts_to_json
from roaml.ide.code_actions import actions
from roaml.ide.code_actions.action import FIX_ALL, KINDS, REWRITE, CodeAction
from roaml.project.workspace import Snapshot
from roaml.rules import BY_CODE
from roaml.text import SourceFile, Span


def register(context: Context) -> None:
    session = context.session
    options = types.CodeActionOptions([*KINDS, types.CodeActionKind.Source], resolve_provider=True)

    @context.feature(types.TEXT_DOCUMENT_CODE_ACTION, options)
    def code_action(params: types.CodeActionParams) -> list[types.CodeAction]:
        path = session.convert.path(params.text_document.uri)
        snapshot = session.moment().snapshot(path)
        source = snapshot.analysis.source(path)
        if source is None:
            return []
        place, only = session.convert.span(source, params.range), params.context.only
        shown = _ClientDiagnostics(context, source, params.context.diagnostics)
        offered = [
            _converted(context, snapshot, path, place, shown, action)
            for action in _all(context, snapshot, path, place, lambda kind: _is_requested(kind, only))
            if _can(context, action)
        ]
        if _is_requested(types.CodeActionKind.Source, only):
            offered += translate.actions(snapshot, path, session.convert)
        return offered

    @context.feature(types.CODE_ACTION_RESOLVE)
    def resolve(action: types.CodeAction) -> types.CodeAction:
        data: Any = action.data
        if action.edit is not None or not isinstance(data, dict):
            return action
        try:
            uri, place = str(data["uri"]), Span(int(data["start"]), int(data["end"]))
        except (KeyError, TypeError, ValueError):  # a client may send anything
            return action
        path = session.convert.path(uri)
        snapshot = session.moment().snapshot(path)
        for candidate in _all(context, snapshot, path, place, lambda kind: kind == action.kind):
            if (candidate.title, candidate.kind, _identity(candidate)) == (
                action.title,
                action.kind,
                data.get("fixes"),
            ):
                action.edit = workspace_edit(context, snapshot, candidate.make())
                break
        return action


def _all(
    context: Context, snapshot: Snapshot, path: str, place: Span, is_requested: Callable[[str], bool]
) -> Iterator[CodeAction]:
    """The actions at a place: those for the models, and those for known results of properties."""
    yield from actions(snapshot, path, place, is_requested)
    if is_requested(REWRITE):
        yield from expectation.actions(context, snapshot, path, place)


def _converted(
    context: Context, snapshot: Snapshot, path: str, place: Span, shown: _ClientDiagnostics, action: CodeAction
) -> types.CodeAction:
    converted = types.CodeAction(
        action.title,
        kind=action.kind,
        diagnostics=shown.of(action.diagnostic),
        is_preferred=action.preferred or None,
    )
    if _resolves(context):
        uri = context.session.convert.uri(path)
        converted.data = {"uri": uri, "start": place.start, "end": place.end, "fixes": _identity(action)}
    else:
        converted.edit = workspace_edit(context, snapshot, action.make())
    return converted


def _identity(action: CodeAction) -> dict[str, Any] | None:
    """The key that distinguishes actions with equal titles: the diagnostic that they fix."""
    fixed = action.diagnostic
    if fixed is None:
        return None
    facts = facts_to_json(fixed.facts) if fixed.facts else None
    return {"code": fixed.code, "start": fixed.span.start, "facts": facts}


class _ClientDiagnostics:
    """The diagnostics that actions fix, in the protocol's types. A diagnostic that the client has sent is used as it
    is; other diagnostics are converted.

    The client's data may be outdated or wrong. It is used only if a current diagnostic has the same code, place and
    facts.
    """

    def __init__(self, context: Context, source: SourceFile, sent: Iterable[types.Diagnostic]) -> None:
        self._context, self._source = context, source
        self._sent: dict[tuple[str, Span, Facts | None], list[types.Diagnostic]] = {}
        for diagnostic in sent:
            self._sent.setdefault(self._identity(diagnostic), []).append(diagnostic)

    def _identity(self, sent: types.Diagnostic) -> tuple[str, Span, Facts | None]:
        code, rule = str(sent.code), BY_CODE.get(str(sent.code))
        facts = facts_from_json(rule.facts, sent.data) if rule and rule.facts else None
        return code, self._context.session.convert.span(self._source, sent.range), facts

    def of(self, diagnostic: Diagnostic | None) -> list[types.Diagnostic] | None:
        if diagnostic is None:
            return None
        known = self._sent.get((diagnostic.code, diagnostic.span, diagnostic.facts), [])
        if len(known) == 1:
            return known
        return [self._context.session.convert.diagnostic(diagnostic, self._source)]


def _resolves(context: Context) -> bool:
    """Whether the client requests the edit of an action when it is selected."""
    document = context.client.capabilities.text_document
    action = document.code_action if document else None
    support = action.resolve_support if action else None
    return bool(action and action.data_support and support and "edit" in support.properties)


def _can(context: Context, action: CodeAction) -> bool:
    """Whether the client supports the creation or renaming of files that an action needs."""
    workspace = context.client.capabilities.workspace
    edit = workspace.workspace_edit if workspace else None
    operations: Sequence[str] = (edit.resource_operations if edit and edit.document_changes else None) or ()
    return all(resource in operations for resource in action.resources)


def _is_requested(kind: str, only: Sequence[str] | None) -> bool:
    """Whether actions of `kind` are requested. A request for `quickfix` includes `quickfix.x`; a request for the empty
    kind includes all. Without `only`, every kind is requested except the one that fixes the whole file."""
    if not only:
        return kind != FIX_ALL
    return any(requested in ("", kind) or kind.startswith(f"{requested}.") for requested in only)
