# SPDX-License-Identifier: Apache-2.0
"""`as2fm/coverage`: which parts of a picture the traces of the known results have executed."""

from __future__ import annotations

from typing import Any, TypedDict

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri
from as2fm_lsp.handlers.pictures import asked_picture
from as2fm_lsp.verification import background
from as2fm_lsp.verification.known_results import KnownResult
from roaml.debugging.covered import CoveredNode, covered_picture
from roaml.ide.diagrams import DiagramKind
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.verification.coverage import Coverage, coverage

METHOD = "as2fm/coverage"


class CoveredNodeRow(TypedDict):
    """A state or a node of the tree: the number of traces that have entered or ticked it, and for each status that a
    node has returned, the number of traces in which it did."""

    traces: int
    statuses: dict[str, int]


class CoverageRow(TypedDict):
    """`traces` is the number of traces that were read, `simulated` that of the verification, and `system` the URI of
    the system or tree that was verified. `nodes` and `edges` belong to those of the picture, in their order; null for a
    part that is not executed. All are empty if `isStale`: the files have changed since the verification."""

    traces: int
    simulated: int
    isStale: bool
    system: str
    nodes: list[CoveredNodeRow | None]
    edges: list[int | None]


class _Read(Record, frozen=True):
    """The coverage that was computed last, and its results."""

    results: tuple[KnownResult, ...]
    coverage: Coverage | None


def register(context: Context) -> None:
    session, last = context.session, [_Read((), None)]

    @context.feature(METHOD)
    async def covered(params: Any) -> CoverageRow | None:
        """The coverage of a picture, whose parameters are those of `as2fm/picture`, by the system that was verified
        last; null if the picture is not about states or a tree, or if nothing was verified."""
        shown = asked_picture(session, params)
        if shown is None or shown[1] is DiagramKind.ROS:
            return None
        analysis, kind, picture = shown
        system = _verified_system(context, analysis, session.convert.path(document_uri(params)))
        known = [one for one in context.results.of(system) if one.result.traces is not None]
        valid = tuple(one for one in known if not context.results.is_stale(one, analysis, system))
        if not valid:
            nothing: CoverageRow = {
                "traces": 0,
                "simulated": 0,
                "isStale": True,
                "system": session.convert.uri(system),
                "nodes": [],
                "edges": [],
            }
            return nothing if known else None
        if list(map(id, last[0].results)) != list(map(id, valid)):
            results = [one.result for one in valid]
            read = await background.in_thread(lambda checked: coverage(results, checked), context.requests.checkpoint)
            last[0] = _Read(valid, read)
        read, traces = last[0].coverage, valid[0].result.traces
        if read is None or traces is None:
            return None
        automata = [instance.automaton for instance in traces.checker.legend.layout.instances]
        parts = covered_picture(kind, picture, read, valid[0].analysis, automata)
        return {
            "traces": read.traces,
            "simulated": read.simulated,
            "isStale": False,
            "system": session.convert.uri(system),
            "nodes": [None if node is None else _row(node) for node in parts.nodes],
            "edges": list(parts.edges),
        }


def _verified_system(context: Context, analysis: Analysis, path: str) -> str:
    """Of the systems of a file, the one that was verified last; the file itself if it belongs to no system."""
    systems = {path, *filter(None, analysis.systems_of(path))}
    return next((system for system in reversed(context.results.systems) if system in systems), path)


def _row(node: CoveredNode) -> CoveredNodeRow:
    return {"traces": node.traces, "statuses": dict(node.statuses)}
