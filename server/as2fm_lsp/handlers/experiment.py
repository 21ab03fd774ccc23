# SPDX-License-Identifier: Apache-2.0
"""`as2fm/experiment`, what a client asks before an experiment; `as2fm/newParameter`, an edit that makes a number a
parameter; lenses that begin an experiment.

The client runs `as2fm-lsp experiment --live` itself, as it runs the debug adapter. A client that can do this names its
command in its initialization options, as `experiment`: it is called with the URI of a system, and the name of a
parameter, which may be missing; or with the URI of a file that contains the arguments of an experiment.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from typing import Any, TypedDict

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri, natural
from as2fm_lsp.handlers.requested_document import RequestedDocument
from as2fm_lsp.handlers.workspace_edit import workspace_edit
from roaml.ide.code_actions.new_parameter import actions
from roaml.ide.experiment import numbers_of, parameters_of, properties_of
from roaml.ide.verifiable import verifiable
from roaml.model.kinds import EXPERIMENT_SUFFIX
from roaml.project.paths import is_on_disk
from roaml.text import Span

EXPERIMENT = "as2fm/experiment"
NEW_PARAMETER = "as2fm/newParameter"
TITLE, RUN_TITLE = "Experiment", "Run the experiment"


class AskedParameter(TypedDict):
    name: str
    value: str
    proposed: str
    limits: str


class ExperimentProperty(TypedDict):
    name: str
    comment: str
    expected: str


class ExperimentNumber(TypedDict):
    """A number that can become a parameter: `uri` and `offset`, in code points, are its place."""

    text: str
    place: str
    comment: str
    uri: str
    offset: int


class ExperimentForm(TypedDict):
    """What a client asks. `numbers` are those that are no parameters yet."""

    parameters: list[AskedParameter]
    properties: list[ExperimentProperty]
    numbers: list[ExperimentNumber]


def register(context: Context) -> None:
    session = context.session

    @context.feature(EXPERIMENT)
    def experiment(params: Any) -> ExperimentForm:
        path = session.convert.path(document_uri(params))
        analysis = session.moment().snapshot(path).analysis
        return {
            "parameters": [
                {"name": p.name, "value": p.value, "proposed": p.proposed, "limits": p.limits}
                for p in parameters_of(analysis, path)
            ],
            "properties": [
                {"name": p.name, "comment": p.comment, "expected": p.expected} for p in properties_of(analysis, path)
            ],
            "numbers": [
                {
                    "text": place.text,
                    "place": f"{os.path.basename(place.path)}: {place.line}",
                    "comment": place.comment,
                    "uri": session.convert.uri(place.path),
                    "offset": place.span.start,
                }
                for place in numbers_of(analysis, path)
            ],
        }

    @context.feature(NEW_PARAMETER)
    def new_parameter(params: Any) -> types.WorkspaceEdit | None:
        """The edit that makes the number at `offset` a parameter; null if there is no such number, or its file belongs
        to several systems."""
        context.trust.require(NEW_PARAMETER)
        path, offset = session.convert.path(document_uri(params)), natural(params, "offset")
        snapshot = session.moment().snapshot(path)
        action = next(actions(snapshot.analysis, path, Span(offset, offset)), None)
        return None if action is None else workspace_edit(context, snapshot, action.make())


def lenses(context: Context, on: RequestedDocument, broken: Collection[str]) -> Iterator[types.CodeLens]:
    """Lenses that begin an experiment: for a system with properties, and for each of its parameters; for a file that
    contains the arguments of an experiment."""
    file, command = on.analysis.system_file(on.path), context.client.experiment
    if command and on.path.endswith(EXPERIMENT_SUFFIX) and is_on_disk(on.path):
        run = types.Command(RUN_TITLE, command, arguments=[on.convert.uri(on.path)])
        yield types.CodeLens(on.range(Span(0, 0)), run)
    if not command or file is None or on.path in broken or not is_on_disk(on.path):
        return
    if not verifiable(on.analysis, on.path):
        return
    uri = on.convert.uri(on.path)
    yield types.CodeLens(on.range(file.element.name_span), types.Command(TITLE, command, arguments=[uri]))
    for parameter in parameters_of(on.analysis, on.path):
        title = f"Try other values of {parameter.name}"
        yield types.CodeLens(on.range(parameter.span), types.Command(title, command, arguments=[uri, parameter.name]))
