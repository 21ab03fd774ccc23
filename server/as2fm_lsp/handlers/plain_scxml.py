# SPDX-License-Identifier: Apache-2.0
"""`as2fm/plainScxml`: the plain SCXML of a machine in its system, with the places from which its lines come."""

from __future__ import annotations

from typing import Any, TypedDict

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.first_error import counted
from as2fm_lsp.handlers.parameters import document_uri
from roaml import api
from roaml.project.analysis import Analysis
from roaml.scxml.events import Role
from roaml.scxml.writer import WrittenLine, write_lines

METHOD = "as2fm/plainScxml"


class PlainLine(TypedDict):
    """A line, counted from 0, with the place in the models from which it comes."""

    line: int
    uri: str
    range: types.Range


class PlainScxml(TypedDict):
    """`problem` is the reason why there is no text; empty if there is one."""

    text: str
    lines: list[PlainLine]
    problem: str


def register(context: Context) -> None:
    session = context.session

    def convert(analysis: Analysis, lines: list[WrittenLine]) -> PlainScxml:
        places: list[PlainLine] = []
        for number, line in enumerate(lines):
            source = analysis.source(line.origin.path)
            if source is not None:
                uri = session.convert.uri(line.origin.path)
                places.append({"line": number, "uri": uri, "range": session.convert.range(source, line.origin.span)})
        return {"text": "".join(f"{line.text}\n" for line in lines), "lines": places, "problem": ""}

    @context.feature(METHOD)
    def plain_scxml(params: Any) -> PlainScxml:
        """The plain SCXML of a machine. If the tree uses a plugin several times, the result is that of the first node,
        because the others differ only in their ports."""
        path = session.convert.path(document_uri(params))
        snapshot = session.moment().snapshot(path)
        analysis = snapshot.analysis
        systems = analysis.memberships.get(path, ())
        if not systems or analysis.machine(path) is None:
            return _problem("This is not a machine of a system.")
        try:
            network = api.to_scxml(api.loaded(snapshot, systems[0]))
        except api.ModelError as error:
            return _problem(f"The system has {counted(error.result.diagnostics)}, so it has no plain SCXML.")
        linked = analysis.system(systems[0])
        automata = linked.automata_of(path) if linked else ()
        if not automata:
            return _problem("The behavior tree does not use this plugin.")
        documents = [(a.name, list(lines)) for a, lines in write_lines(network) if _is_of(a.role, a.origin.path, path)]
        # The automata of action threads are included with that of the machine.
        first = automata[0].name
        shown = [lines for name, lines in documents if automata[0].instance is None or name.startswith(first)]
        return convert(analysis, [line for lines in shown for line in lines])


def _is_of(role: Role, origin: str, path: str) -> bool:
    return role is Role.MACHINE and origin == path


def _problem(text: str) -> PlainScxml:
    return {"text": "", "lines": [], "problem": text}
