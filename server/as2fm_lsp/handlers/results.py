# SPDX-License-Identifier: Apache-2.0
"""The known results of properties: lenses and hints; `as2fm/properties`, the properties with their results;
`as2fm/counterexample`, why a property fails or holds; `as2fm/traceState`, the whole state at a step of a trace.

- A result is compared with the current expectations, without new traces.
- The protocol has no commands that show traces or ask for an expectation. A client that has these commands names them
  in its initialization options, as `showCounterexample`, `showWitness`, `debugCounterexample` and `setExpectation`.
  They are called with the URI of a system and the name of a property; `debugCounterexample` also with the seed and the
  number of the trace.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Iterator
from contextlib import suppress
from functools import partial
from typing import Any

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.display_settings import display_settings
from as2fm_lsp.handlers.parameters import document_uri, natural, string
from as2fm_lsp.handlers.requested_document import RequestedDocument
from as2fm_lsp.verification import background
from as2fm_lsp.verification.known_results import ExpectedNow, KnownResult, expected_now, missed, short
from as2fm_lsp.verification.report import one_as_text, row
from as2fm_lsp.verification.result_view import SYMBOLS, mark_of, result_view
from as2fm_lsp.verification.scheduler_report import meanings
from roaml.debugging.overview import StateRow, overview
from roaml.debugging.sources import Sources
from roaml.ide.describe import markdown
from roaml.ide.diagrams import highlights
from roaml.ide.system_names import system_names
from roaml.ide.verifiable import Verifiable, fingerprint, verifiable
from roaml.model.kinds import FileKind, mocks_path
from roaml.project.analysis import Analysis
from roaml.project.paths import is_on_disk
from roaml.project.workspace import Snapshot
from roaml.simulation.session import Session
from roaml.smc.fault import FaultError
from roaml.smc.goal import STUCK_PROPERTY
from roaml.text import Location
from roaml.verification.counterexample import counterexample, unwanted_trace, witness, witness_trace
from roaml.verification.expectations import NO_EXPECTATION
from roaml.verification.results import Result
from roaml.verification.target import VerificationTarget, own_words
from roaml.views.story import StoryLine

PROPERTIES = "as2fm/properties"
COUNTEREXAMPLE = "as2fm/counterexample"
TRACE_STATE = "as2fm/traceState"
VERIFY = "as2fm.verify"
TITLE = "Verify"

Json = dict[str, Any]


def register(context: Context) -> None:
    session = context.session

    @context.feature(PROPERTIES)
    def properties(_: Any) -> list[Json]:
        """The systems that have properties, and the trees without a system that have mocks or are open, with the
        properties and their known results, in the order of their paths."""
        moment = session.moment()
        rows = ((path, _properties(context, moment.snapshot(path), path)) for path in sorted(moment.files()))
        return [{"uri": session.convert.uri(path), "properties": of_file} for path, of_file in rows if of_file]

    @context.feature(COUNTEREXAMPLE)
    async def explain(params: Any) -> Json | None:
        """The shortest trace that contradicts a property or, with `witness`, supports it; `null` if none is known.
        `heading` is what the property requires, why the trace has its verdict, and a summary of the trace; `summary`
        is only its verdict and length."""
        path = session.convert.path(document_uri(params))
        current = CurrentResults(context, session.moment().snapshot(path), path)
        known = current.get(string(params, "property"))
        if known is None or known.result.traces is None:
            return None
        result, target = known.result, known.result.traces.target
        explain_trace = witness if getattr(params, "witness", False) is True else counterexample
        why = await background.in_thread(
            lambda _: explain_trace(result, partial(place_in_words, target)), context.requests.checkpoint
        )
        if why is None:
            return None
        return {
            "property": result.name,
            "heading": _heading(markdown.plain(own_words(target, result.name)), why.heading),
            "summary": why.summary,
            "verdict": why.verdict.value,
            "seed": known.result.traces.options.seed,
            "trace": why.trace,
            "expected": missed(result),
            "stale": current.is_stale(known),
            "steps": [line_row(context, known, path, line) for line in why.lines],
        }

    @context.feature(TRACE_STATE)
    async def trace_state(params: Any) -> list[Json] | None:
        """The state after `step` steps of a trace of a known result; values that differ from the state after `earlier`
        steps are marked. `null` if there is no result."""
        path = session.convert.path(document_uri(params))
        known = CurrentResults(context, session.moment().snapshot(path), path).get(string(params, "property"))
        if known is None or known.result.traces is None:
            return None
        traces, sources = known.result.traces, Sources(known.result.traces.target, known.analysis)
        trace = natural(params, "trace")
        step, earlier = (min(natural(params, name), traces.options.max_steps) for name in ("step", "earlier"))
        run = Session(traces.checker, traces.compiled_property, traces.options.seed, trace, traces.target.clock)
        with suppress(FaultError):  # the trace ends where the model fails
            await background.in_thread(lambda _: run.jump(max(step, earlier)), context.requests.checkpoint)
        last = len(run.steps)
        return [_state_row(row) for row in overview(run, sources, min(step, last), min(earlier, last))]


def _properties(context: Context, snapshot: Snapshot, path: str) -> list[Json]:
    """The properties of a system, or of a tree to verify, with their known results; none for other files."""
    analysis = snapshot.analysis
    if analysis.kind(path) is not FileKind.SYSTEM and not _is_tree_to_verify(context, analysis, path):
        return []
    current = CurrentResults(context, snapshot, path)
    return [_property(current, property_) for property_ in verifiable(analysis, path)]


def _heading(sentence: str, summary: str) -> str:
    """What a property requires, if its file says so, and the summary of a trace, which can begin with a word that is no
    name: `by chance`."""
    begins_with_word = summary.startswith(("by chance", "by choice", "delayed by "))
    after = f"{summary[0].upper()}{summary[1:]}" if begins_with_word else summary
    return f"{sentence} {after}" if sentence else summary


def _is_tree_to_verify(context: Context, analysis: Analysis, path: str) -> bool:
    """Whether a file is a tree that has mocks, or that is open and may get them."""
    if analysis.kind(path) is not FileKind.TREE:
        return False
    return context.session.text(path) is not None or analysis.source(mocks_path(path)) is not None


class CurrentResults:
    """The known results of a system at one moment, compared with the expectations at that moment."""

    def __init__(self, context: Context, snapshot: Snapshot, system: str) -> None:
        self.context = context
        self.analysis = snapshot.analysis
        self.system = system
        self._snapshot = snapshot
        self._expected: ExpectedNow | None = None

    def get(self, name: str) -> KnownResult | None:
        known = self.context.results.get(self.system, name)
        if known is None:
            return None
        if self._expected is None:
            self._expected = expected_now(self._snapshot, self.system, self.context.session.client_settings)
        return self._expected.with_expectations(known)

    def is_stale(self, known: KnownResult) -> bool:
        return self.context.results.is_stale(known, self.analysis, self.system)


def verified_row(result: Result) -> Json:
    """A result as a value for JSON, as clients show it."""
    return {
        **row(result),
        "short": short(result),
        "counterexample": unwanted_trace(result) is not None,
        "witness": witness_trace(result) is not None,
    }


def lenses(context: Context, on: RequestedDocument, broken: Collection[str]) -> Iterator[types.CodeLens]:
    """Lenses for each property of a system that is not in `broken`, and for the system file. Results are shown in the
    hints after the names, and in the lenses only if no hints are shown."""
    shows_words = not _shows_hints(context)
    systems = system_names(on.analysis.memberships.get(on.path, ()))
    for system, name in systems.items():
        if system in broken or not is_on_disk(system):
            continue
        uri, where = on.convert.uri(system), f" in {name}" if len(systems) > 1 else ""
        properties = verifiable(on.analysis, system)
        file, current = on.analysis.system_file(system), CurrentResults(context, on.snapshot, system)
        if system == on.path and file is not None and properties:
            command = types.Command("Verify all", VERIFY, arguments=[uri])
            yield types.CodeLens(on.range(file.element.name_span), command)
            stuck_known = current.get(STUCK_PROPERTY)
            if context.client.show_counterexample and stuck_known and stuck_known.result.stuck:
                stale = ", stale" if current.is_stale(stuck_known) else ""
                title = f"Gets stuck{stale}: show the waiting automata"
                show = types.Command(title, context.client.show_counterexample, arguments=[uri, STUCK_PROPERTY])
                yield types.CodeLens(on.range(file.element.name_span), show)
        for property_ in properties:
            if property_.path != on.path:
                continue
            known = current.get(property_.name)
            words = [result_words(current, known)] if shows_words and known is not None else []
            title = " · ".join([f"{TITLE}{_of_instance(property_, properties)}{where}", *words])
            commands = [types.Command(title, VERIFY, arguments=[uri, [property_.name]])]
            commands += [] if known is None else result_commands(context, uri, property_.name, known.result)
            for command in commands:
                yield types.CodeLens(on.range(property_.name_span), command)


def result_commands(context: Context, uri: str, name: str, result: Result) -> Iterator[types.Command]:
    """The commands that the client offers for a result."""
    client, unwanted, witness = context.client, unwanted_trace(result), witness_trace(result)
    if client.set_expectation and result.has_no_expectation and result.answer is not None:
        yield types.Command("Set expectation", client.set_expectation, arguments=[uri, name])
    if client.show_counterexample and unwanted is not None:
        yield types.Command("Show counterexample", client.show_counterexample, arguments=[uri, name])
    if client.debug_counterexample and unwanted is not None and (missed(result) or result.stuck):
        traces = result.traces
        run = {} if traces is None else {"seed": traces.options.seed, "trace": unwanted.trace}
        yield types.Command("Debug counterexample", client.debug_counterexample, arguments=[uri, name, run])
    if client.show_witness and witness is not None:
        yield types.Command("Show witness", client.show_witness, arguments=[uri, name])


def hints(context: Context, on: RequestedDocument, within: types.Range) -> Iterator[types.InlayHint]:
    """Hints with the known results, each after the name of its property."""
    span = on.span(within)
    systems = system_names(on.analysis.memberships.get(on.path, ()))
    for system, name in systems.items():
        where = f" in {name}" if len(systems) > 1 else ""
        current = CurrentResults(context, on.snapshot, system)
        properties = verifiable(on.analysis, system) if context.results.has(system) else ()
        for property_ in properties:
            known = current.get(property_.name)
            if known is None or property_.path != on.path or not span.start <= property_.name_span.end <= span.end:
                continue
            mark = SYMBOLS[mark_of(known.result)]
            # Editors cut long hints. The value and its system come first.
            text = f"{mark}{_of_instance(property_, properties)} {result_words(current, known, where)}"
            position = on.convert.position(on.source, min(property_.name_span.end + 1, len(on.source.text)))
            place_of = partial(place_in_words, known.result.traces.target if known.result.traces else None)
            report = one_as_text(known.result, place_of)
            tooltip = f"{report}{meanings(report)}"
            yield types.InlayHint(position, text, tooltip=tooltip, padding_left=True)


def _of_instance(property_: Verifiable, properties: Iterable[Verifiable]) -> str:
    """The name of a property, after a blank, if other instances have a property at the same place; otherwise ""."""
    place = property_.path, property_.name_span
    return f" {property_.name}" if sum((p.path, p.name_span) == place for p in properties) > 1 else ""


def _shows_hints(context: Context) -> bool:
    document = context.client.capabilities.text_document
    return bool(document and document.inlay_hint) and display_settings(context.session.client_settings).results


def result_words(current: CurrentResults, known: KnownResult, where: str = "") -> str:
    """A known result in a few words, with what its reader must know."""
    result = known.result
    wrong = missed(result)
    parts = [short(result) + where, *([f"not {wrong}"] if wrong else [])]
    parts += dict.fromkeys(verdict.text for verdict in result.verdicts if verdict.is_uniform or verdict.is_undecided)
    parts += dict.fromkeys(verdict.unanimous_text for verdict in result.verdicts if verdict.unanimous_text)
    parts += [NO_EXPECTATION] if result.has_no_expectation else []
    if result.stuck is not None:
        parts.append(f"{result.stuck.count:,} {'trace' if result.stuck.count == 1 else 'traces'} got stuck")
    if current.is_stale(known):
        parts.append("stale")
    return ", ".join(parts)


def _property(current: CurrentResults, property_: Verifiable) -> Json:
    where = place(current.context, current.analysis, Location(property_.path, property_.name_span))
    values: Json = {"name": property_.name, "comment": property_.comment, **where}
    known = current.get(property_.name)
    if known is not None:
        values["stale"] = current.is_stale(known)
        values["result"] = verified_row(known.result)
        place_of = partial(place_in_words, known.result.traces.target if known.result.traces else None)
        now = fingerprint(current.analysis, current.system)
        values["view"] = {"words": result_words(current, known), **result_view(known, now, place_of)}
    return values


def line_row(context: Context, known: KnownResult, system: str, line: StoryLine) -> Json:
    """A line of the explanation of a trace, with its place and what pictures highlight."""
    origin = line.origin
    nodes = highlights(known.analysis, system, line.automaton, origin, line.location) if origin is not None else ()
    convert = context.session.convert
    return {
        "step": line.step,
        "lastStep": line.last_step,
        "time": line.time,
        "who": line.who,
        "what": line.what,
        "place": line.place,
        "details": list(line.details),
        **(place(context, known.analysis, origin) if origin is not None else {}),
        "highlights": [
            {"kind": highlight.picture, "uri": convert.uri(highlight.path), "node": highlight.node}
            for highlight in nodes
        ],
    }


def _state_row(row: StateRow) -> Json:
    return {
        "name": row.name,
        "value": row.value,
        "before": row.before,
        "hasChanged": row.has_changed,
        "rows": [_state_row(below) for below in row.rows],
    }


def place_in_words(target: VerificationTarget | None, origin: Location) -> str:
    position = target.place(origin) if target else None
    return f"{os.path.basename(position.path)}:{position.line}" if position else ""


def place(context: Context, analysis: Analysis, location: Location) -> Json:
    """`uri` and `range`; empty if the file does not exist."""
    source = analysis.source(location.path)
    if source is None:
        return {}
    convert = context.session.convert
    start, end = (convert.position(source, offset) for offset in location.span)
    return {
        "uri": convert.uri(location.path),
        "range": {
            "start": {"line": start.line, "character": start.character},
            "end": {"line": end.line, "character": end.character},
        },
    }
