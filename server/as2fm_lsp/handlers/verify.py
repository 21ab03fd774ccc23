# SPDX-License-Identifier: Apache-2.0
"""`as2fm.verify`, with its lenses and hints; `as2fm/properties`, the properties and their known results;
`as2fm/counterexample`, why a property fails.

The protocol has no command that shows a counterexample. A client that has one names it in its initialization options,
as `showCounterexample`: it is called with the URI of a system and the name of a property.
"""

from __future__ import annotations

import os
import time
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.display_settings import display_settings
from as2fm_lsp.handlers.first_error import counted, show
from as2fm_lsp.handlers.parameters import document_uri, string
from as2fm_lsp.handlers.requested_document import RequestedDocument
from as2fm_lsp.progress import Progress
from as2fm_lsp.verification import background, stuck_report
from as2fm_lsp.verification.known_results import KnownResult, missed, short
from as2fm_lsp.verification.node_names import explained
from as2fm_lsp.verification.report import one_as_text, row
from as2fm_lsp.verification.settings import VerificationSettings, verification_settings
from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.ide.describe import markdown
from roaml.ide.diagrams import highlights
from roaml.ide.system_names import system_names
from roaml.ide.verifiable import Texts, Verifiable, fingerprint, verifiable
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.memo import Interrupted
from roaml.project.paths import is_on_disk
from roaml.smc.fault import FaultError
from roaml.smc.goal import STUCK_PROPERTY, CompiledProperty
from roaml.smc.pool import WorkersLostError
from roaml.smc.run import Tally, summary
from roaml.text import Location
from roaml.verification import stuck
from roaml.verification.counterexample import counterexample, unwanted_trace
from roaml.verification.expectations import RangeError, check_range
from roaml.verification.results import Result, Traces
from roaml.verification.target import VerificationTarget
from roaml.verification.verifier import Verifier, checker_of
from roaml.views.story import StoryLine

COMMAND = "as2fm.verify"
PROPERTIES = "as2fm/properties"
COUNTEREXAMPLE = "as2fm/counterexample"
TITLE = "Verify"

Json = dict[str, Any]


def register(context: Context) -> None:
    session = context.session

    @context.command(COMMAND)
    async def verify(*arguments: object) -> Json | None:
        """Verify properties of a system as it is in the editor.

        Args:
            arguments: the URI of the system file, the names of the properties (all if none are given), and options.

        Returns:
            `results`, one for each property as `as2fm-lsp verify --format json` writes them, or with an `error` instead
                of the numbers; `stuck`, whether the system gets stuck, in the same form, null if unknown; and `errors`,
                those of the model. null if the user has cancelled it.
        """
        if not _are_arguments(arguments):
            text = f"{COMMAND} needs the URI of a system file, and optionally a list of names and options."
            context.client.show_message(types.MessageType.Error, text)
            return None
        path = session.convert.path(str(arguments[0]))
        names = arguments[1] if len(arguments) > 1 else ()
        settings = verification_settings(session.client_settings, arguments[2] if len(arguments) > 2 else None)
        for problem in settings.problems:
            context.client.show_message(types.MessageType.Warning, problem)
        async with context.progress.show(f"Verifying {os.path.basename(path)}", cancellable=True) as bar:
            try:
                with context.requests.cancelled_by(bar.token):
                    run = _VerifyCommand(context, bar, path, settings)
                    return await run.answer([str(name) for name in names] if isinstance(names, Sequence) else [])
            except Interrupted:
                if bar.is_cancelled:
                    return None
                raise
            finally:
                context.refresh.look()

    @context.feature(PROPERTIES)
    def properties(_: Any) -> list[Json]:
        """The systems with their properties, and the known results."""
        moment = session.moment()
        systems = []
        for path in moment.files():
            analysis = moment.snapshot(path).analysis
            if analysis.kind(path) is FileKind.SYSTEM:
                rows = [_property(context, analysis, path, property_) for property_ in verifiable(analysis, path)]
                systems.append({"uri": session.convert.uri(path), "properties": rows})
        return [system for system in systems if system["properties"]]

    @context.feature(COUNTEREXAMPLE)
    async def explain(params: Any) -> Json | None:
        """The shortest trace that contradicts a property; null if none is known."""
        path = session.convert.path(document_uri(params))
        known = context.results.get(path, string(params, "property"))
        if known is None or known.result.traces is None:
            return None
        result, target = known.result, known.result.traces.target
        why = await background.in_thread(
            lambda _: counterexample(result, partial(_place_in_words, target)), context.requests.checkpoint
        )
        if why is None:
            return None
        analysis = session.moment().snapshot(path).analysis
        return {
            "property": known.result.name,
            "heading": " ".join(filter(None, (markdown.plain(known.result.comment), why.heading))),
            "verdict": why.verdict,
            "trace": why.trace,
            "expected": missed(known.result),
            "stale": context.results.is_stale(known, analysis, path),
            "steps": [_step(context, known, path, line) for line in why.lines],
        }


def lenses(context: Context, on: RequestedDocument, broken: Collection[str]) -> Iterator[types.CodeLens]:
    """Lenses for each property of a system that is not in `broken`, and for the system file. Results are shown in the
    hints after the names, and in the lenses only if no hints are shown."""
    tells = not _shows_hints(context)
    systems = system_names(on.analysis.memberships.get(on.path, ()))
    for system, name in systems.items():
        if system in broken or not is_on_disk(system):
            continue
        uri, where = on.convert.uri(system), f" in {name}" if len(systems) > 1 else ""
        properties = verifiable(on.analysis, system)
        file = on.analysis.system_file(system)
        if system == on.path and file is not None and properties:
            command = types.Command("Verify all", COMMAND, arguments=[uri])
            yield types.CodeLens(on.range(file.element.name_span), command)
            stuck_known = context.results.get(system, STUCK_PROPERTY)
            if context.client.show_counterexample and stuck_known and stuck_known.result.stuck:
                stale = ", stale" if context.results.is_stale(stuck_known, on.analysis, system) else ""
                title = f"Gets stuck{stale}: show the waiting automata"
                show = types.Command(title, context.client.show_counterexample, arguments=[uri, STUCK_PROPERTY])
                yield types.CodeLens(on.range(file.element.name_span), show)
        for property_ in properties:
            if property_.path != on.path:
                continue
            known = context.results.get(system, property_.name)
            words = _words(context, on.analysis, system, known) if tells else []
            title = " · ".join([f"{TITLE}{where}", *words])
            yield types.CodeLens(
                on.range(property_.name_span), types.Command(title, COMMAND, arguments=[uri, [property_.name]])
            )
            speaks = known and (missed(known.result) or known.result.stuck)
            if known and context.client.show_counterexample and speaks and unwanted_trace(known.result):
                show = types.Command(
                    "Show counterexample", context.client.show_counterexample, arguments=[uri, property_.name]
                )
                yield types.CodeLens(on.range(property_.name_span), show)
            seen = unwanted_trace(known.result) if known and speaks else None
            traces = known.result.traces if known else None
            if context.client.debug_counterexample and seen is not None and traces is not None:
                run = {"seed": traces.options.seed, "trace": seen.trace}
                debug = types.Command(
                    "Debug counterexample", context.client.debug_counterexample, arguments=[uri, property_.name, run]
                )
                yield types.CodeLens(on.range(property_.name_span), debug)


def hints(context: Context, on: RequestedDocument, within: types.Range) -> Iterator[types.InlayHint]:
    """The known result, after the name of each property."""
    span = on.span(within)
    systems = system_names(on.analysis.memberships.get(on.path, ()))
    for system, name in systems.items():
        where = f" in {name}" if len(systems) > 1 else ""
        for property_ in verifiable(on.analysis, system) if context.results.has(system) else ():
            known = context.results.get(system, property_.name)
            if known is None or property_.path != on.path or not span.start <= property_.name_span.end <= span.end:
                continue
            is_uniform = any(verdict.is_uniform for verdict in known.result.verdicts)
            mark = "✗" if missed(known.result) else "~" if is_uniform else "✓" if known.result.verdicts else "="
            mark = "⚠" if known.result.stuck else mark
            text = f"{mark} {', '.join(_words(context, on.analysis, system, known))}{where}"
            position = on.convert.position(on.source, min(property_.name_span.end + 1, len(on.source.text)))
            place_of = partial(_place_in_words, known.result.traces.target if known.result.traces else None)
            tooltip = one_as_text(known.result, place_of)
            yield types.InlayHint(position, text, tooltip=tooltip, padding_left=True)


def _shows_hints(context: Context) -> bool:
    document = context.client.capabilities.text_document
    return bool(document and document.inlay_hint) and display_settings(context.session.client_settings).results


def _words(context: Context, analysis: Analysis, system: str, known: KnownResult | None) -> list[str]:
    if known is None:
        return []
    wrong = missed(known.result)
    parts = [short(known.result), *([f"not {wrong}"] if wrong else [])]
    parts += dict.fromkeys(verdict.text for verdict in known.result.verdicts if verdict.is_uniform)
    if known.result.stuck is not None:
        parts.append(f"{known.result.stuck.count:,} traces got stuck")
    if context.results.is_stale(known, analysis, system):
        parts.append("stale")
    return [", ".join(parts)]


class _VerifyCommand:
    """One call of the command."""

    def __init__(self, context: Context, bar: Progress, path: str, settings: VerificationSettings) -> None:
        self.context = context
        self.bar = bar
        self.path = path
        self.settings = settings

    async def answer(self, names: list[str]) -> Json | None:
        context, path = self.context, self.path
        name = os.path.basename(path)
        try:
            await self.bar.step("checking")
            system = api.loaded(context.session.moment().snapshot(path), path)
        except api.ModelError as error:
            self.say_wrong(f"{name} has {counted(error.result.diagnostics)} and was not verified.")
            if not self.settings.is_silent:
                await show(context, error.result.snapshot, error.result.diagnostics)
            return {"results": [], "errors": [self.error(d, error.result) for d in error.result.diagnostics]}
        except api.PathError as error:
            self.say_wrong(str(error))
            return {"results": [], "errors": [{"message": str(error)}]}
        texts = fingerprint(system.analysis, path)
        target = context.results.target(texts)
        if target is None:
            await self.bar.step("translating")
            target = api.as_target(system)
            context.results.keep_target(texts, target)
        target = target.expecting(context.session.settings_of(path).expectations)
        rows: list[Json] = []
        results: list[Result] = []
        verifier: Verifier | None = None
        for property_name in dict.fromkeys(names or [property_.name for property_ in target.properties]):
            try:
                await self.bar.step(property_name)
                began = time.monotonic()
                verifier, asked = self.asked(target, property_name)
                result = replace(await self.traces(verifier, asked), seconds=time.monotonic() - began)
            except FaultError as fault:
                rows.append({"property": property_name, "error": self.fault(fault, system.analysis)})
                self.say_wrong(f"{property_name}: {fault.message}")
                continue
            except (api.PropertyError, RangeError, WorkersLostError) as error:
                rows.append({"property": property_name, "error": {"message": str(error)}})
                self.say_wrong(str(error))
                continue
            results.append(result)
            context.results.put(path, KnownResult(result, system.analysis, texts))
            rows.append({**row(result), "short": short(result), "counterexample": unwanted_trace(result) is not None})
            context.refresh.look()
            if not self.settings.is_silent:
                context.client.show_message(types.MessageType.Info, self.text(result, target))
        look = None if verifier is None else await self.look(verifier, system.analysis, results, texts)
        return {"results": rows, "errors": [], "stuck": look}

    def text(self, result: Result, target: VerificationTarget) -> str:
        """A result as a message; another message shows the waiting automata."""
        shown = "in a separate message"
        return one_as_text(result, partial(_place_in_words, target), self.settings.stuck, shown)

    def asked(self, target: VerificationTarget, name: str) -> tuple[Verifier, CompiledProperty]:
        """A property, ready to be verified.

        Raises:
            PropertyError, FaultError: it cannot be decided.
            RangeError: no value of it can satisfy its expectation.
        """
        only_uniform = self.context.session.settings_of(self.path).scheduler == "uniform"
        checker = checker_of(target, [name])
        verifier = Verifier(target, checker, self.settings.options, self.settings.expectations, only_uniform)
        asked = verifier.question(name)
        for expectation in verifier.expected(asked):
            check_range(expectation, asked.question)
        return verifier, asked

    async def look(
        self, verifier: Verifier, analysis: Analysis, results: Sequence[Result], texts: Texts
    ) -> Json | None:
        """Whether the system gets stuck, by traces that are generated for it unless it was requested as a property."""
        target, checker, level = verifier.target, verifier.checker, self.settings.stuck
        if not stuck.can_be_stuck(checker):
            return None
        known = stuck.Look(None, None, level)
        if not any(result.asks_stuck for result in results):
            asked = checker.stuck
            await self.bar.step(asked.question.name)
            began = time.monotonic()
            known = await background.in_thread(
                lambda checked: verifier.look_for_stuck(level, lambda _, __: checked()),
                self.context.requests.checkpoint,
            )
            is_free = all(property_.name != asked.question.name for property_ in target.properties)
            if known.answer is not None and is_free:
                traces = Traces(target, checker, asked, known.answer.options)
                seconds = time.monotonic() - began
                result = Result(asked.question.name, known.answer, (), seconds, stuck=known.stuck, traces=traces)
                self.context.results.put(self.path, KnownResult(result, analysis, texts))
            self.context.refresh.look()
        known = replace(known, stuck=stuck.shortest([known.stuck, *(result.stuck for result in results)]))
        place_of = partial(_place_in_words, target)
        text = stuck_report.as_text(known, place_of)
        text += explained(text, target.model, place_of)
        if known.stuck is not None and not self.settings.is_silent:
            kind = types.MessageType.Warning if known.is_met else types.MessageType.Error
            self.context.client.show_message(kind, text.strip())
        row = stuck_report.as_row(known, lambda origin: _place(self.context, analysis, origin))
        return {**row, "text": text.strip()}

    async def traces(self, verifier: Verifier, asked: CompiledProperty) -> Result:
        def show_estimate(tally: Tally) -> None:
            so_far = Result(asked.question.name, summary(asked.question, verifier.options, tally), (), 0)
            self.bar.say(f"{asked.question.name}: {short(so_far)}, {tally.traces:,} traces")

        return await background.answer(verifier, asked, self.context.requests.checkpoint, show_estimate)

    def error(self, diagnostic: Diagnostic, result: api.CheckResult) -> Json:
        place = _place(self.context, result.snapshot.analysis, Location(diagnostic.path, diagnostic.span))
        return {"message": diagnostic.message, "code": diagnostic.code, **place}

    def fault(self, fault: FaultError, analysis: Analysis) -> Json:
        place = _place(self.context, analysis, fault.origin) if fault.origin is not None else {}
        return {"message": fault.message, "code": fault.code, "trace": fault.trace, **place}

    def say_wrong(self, text: str) -> None:
        if not self.settings.is_silent:
            self.context.client.show_message(types.MessageType.Error, text)


def _property(context: Context, analysis: Analysis, system: str, property_: Verifiable) -> Json:
    place = _place(context, analysis, Location(property_.path, property_.name_span))
    values: Json = {"name": property_.name, "comment": property_.comment, **place}
    known = context.results.get(system, property_.name)
    if known is not None:
        values["stale"] = context.results.is_stale(known, analysis, system)
    return values


def _step(context: Context, known: KnownResult, system: str, line: StoryLine) -> Json:
    origin = line.origin
    nodes = highlights(known.analysis, system, line.automaton, origin, line.location) if origin is not None else ()
    convert = context.session.convert
    return {
        "step": line.step,
        "time": line.time,
        "who": line.who,
        "what": line.what,
        "place": line.place,
        "details": list(line.details),
        **(_place(context, known.analysis, origin) if origin is not None else {}),
        "highlights": [
            {"kind": highlight.picture, "uri": convert.uri(highlight.path), "node": highlight.node}
            for highlight in nodes
        ],
    }


def _place_in_words(target: VerificationTarget | None, origin: Location) -> str:
    place = target.place(origin) if target else None
    return f"{os.path.basename(place[0])}:{place[1]}" if place else ""


def _place(context: Context, analysis: Analysis, location: Location) -> Json:
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


def _are_arguments(arguments: Sequence[object]) -> bool:
    if not 1 <= len(arguments) <= 3 or not isinstance(arguments[0], str):
        return False
    names = arguments[1] if len(arguments) > 1 else ()
    return names is None or (not isinstance(names, str) and isinstance(names, Sequence))
