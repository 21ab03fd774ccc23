# SPDX-License-Identifier: Apache-2.0
"""`as2fm/expectations`, the expectations that a result suggests; `as2fm/setExpectation`, an edit that sets an
expectation; code actions that set a suggested expectation.

The expectation of a property in XML is its attribute `expect`, that of a property in JANI an entry of the table
`verify.expect` in the configuration.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any, TypedDict

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri, string
from as2fm_lsp.handlers.results import CurrentResults
from as2fm_lsp.handlers.workspace_edit import workspace_edit
from roaml.comparison import read_comparison
from roaml.ide.code_actions.action import REWRITE, CodeAction, WorkspaceEdit
from roaml.ide.expectation import in_configuration, in_property_file, is_written_in_file
from roaml.ide.verifiable import Verifiable, verifiable
from roaml.project.workspace import Snapshot
from roaml.text import Span
from roaml.verification.results import Result
from roaml.verification.suggestions import suggestions

EXPECTATIONS = "as2fm/expectations"
SET_EXPECTATION = "as2fm/setExpectation"


class Expectations(TypedDict):
    """`suggestions` are met by the known result, the strictest first; `current` are the expectations of the property;
    `file` is the name of the file in which an expectation is set."""

    suggestions: list[str]
    current: list[str]
    file: str


class ExpectationSet(TypedDict):
    """`uri` is the changed file. `problem` is the reason if there is no edit; otherwise it is empty."""

    edit: types.WorkspaceEdit | None
    uri: str
    problem: str


def register(context: Context) -> None:
    session = context.session

    @context.feature(EXPECTATIONS)
    def expectations(params: Any) -> Expectations | None:
        """The expectations that a result suggests; null if there is no property with this name."""
        path, name = session.convert.path(document_uri(params)), string(params, "property")
        snapshot = session.moment().snapshot(path)
        property_ = _property(snapshot, path, name)
        if property_ is None:
            return None
        known = CurrentResults(context, snapshot, path).get(name)
        verdicts = () if known is None else known.result.verdicts
        return {
            "suggestions": [] if known is None else list(suggestions(known.result)),
            "current": [verdict.expectation.text for verdict in verdicts],
            "file": os.path.basename(_file(snapshot, path, property_)),
        }

    @context.feature(SET_EXPECTATION)
    def set_expectation(params: Any) -> ExpectationSet:
        context.trust.require(SET_EXPECTATION)
        path, name = session.convert.path(document_uri(params)), string(params, "property")
        expected = string(params, "expected")
        snapshot = session.moment().snapshot(path)
        property_ = _property(snapshot, path, name)
        if property_ is None:
            return _problem(f"there is no property `{name}`")
        if read_comparison(expected) is None:
            return _problem(f"`{expected}` is not an expectation; write a comparison with a number, such as `>= 0.95`")
        file = _file(snapshot, path, property_)
        change = _change(snapshot, file, property_, expected)
        if not change:
            return _problem(f'cannot change {os.path.basename(file)}; add `{name} = "{expected}"` to `verify.expect`')
        uri = session.convert.uri(file)
        return {"edit": workspace_edit(context, snapshot, change), "uri": uri, "problem": ""}


def actions(context: Context, snapshot: Snapshot, path: str, place: Span) -> Iterator[CodeAction]:
    """Code actions that set the expectation of the property at a place, if its result is known and it has no
    expectation."""
    for system in snapshot.analysis.memberships.get(path, ()) if context.results.systems else ():
        current = CurrentResults(context, snapshot, system)
        for property_ in verifiable(snapshot.analysis, system) if context.results.has(system) else ():
            is_here = property_.path == path and property_.span.start <= place.start and place.end <= property_.span.end
            known = current.get(property_.name) if is_here else None
            if known is not None and known.result.has_no_expectation:
                yield from _actions(snapshot, system, property_, known.result)


def _actions(snapshot: Snapshot, system: str, property_: Verifiable, result: Result) -> Iterator[CodeAction]:
    file = _file(snapshot, system, property_)
    creates = ("create",) if snapshot.analysis.source(file) is None else ()
    where = "" if file == property_.path else f" in {os.path.basename(file)}"
    for text in suggestions(result):

        def make(expected: str = text) -> WorkspaceEdit:
            return _change(snapshot, file, property_, expected)

        yield CodeAction(f"Expect {text} of `{property_.name}`{where}", REWRITE, make, resources=creates)


def _property(snapshot: Snapshot, system: str, name: str) -> Verifiable | None:
    return next((p for p in verifiable(snapshot.analysis, system) if p.name == name), None)


def _file(snapshot: Snapshot, system: str, property_: Verifiable) -> str:
    """The file in which the expectation of a property is set; it need not exist."""
    if is_written_in_file(snapshot.analysis, property_):
        return property_.path
    return snapshot.configuration_of(system)


def _change(snapshot: Snapshot, file: str, property_: Verifiable, expected: str) -> WorkspaceEdit:
    if file == property_.path:
        return in_property_file(snapshot.analysis, property_, expected)
    source = snapshot.analysis.source(file)
    return in_configuration(file, None if source is None else source.text, property_.name, expected)


def _problem(text: str) -> ExpectationSet:
    return {"edit": None, "uri": "", "problem": text}
