# SPDX-License-Identifier: Apache-2.0
"""`as2fm.verify`, with its lenses and hints; `as2fm/properties`, what there is to verify and what is known of it;
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
from typing import TYPE_CHECKING, Any

from lsprotocol import types
from pygls.lsp.server import LanguageServer

from as2fm_lsp.handlers.asked import Asked as Document
from as2fm_lsp.handlers.first_error import counted, show
from as2fm_lsp.handlers.parameters import document_uri, string
from as2fm_lsp.progress import Progress, progress
from as2fm_lsp.shown import shown
from as2fm_lsp.verification import background, stuck
from as2fm_lsp.verification.choices import under_all_schedulers
from as2fm_lsp.verification.counterexample import counterexample, speaking_against
from as2fm_lsp.verification.expectations import Expectation, RangeError, check_range, judge
from as2fm_lsp.verification.nodes import explained
from as2fm_lsp.verification.report import Result, one_as_text, row
from as2fm_lsp.verification.subject import Subject, of_system
from as2fm_lsp.verification.verified import Known, missed, short
from as2fm_lsp.verification.wishes import Wishes, wishes
from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.ide.diagrams import highlights
from roaml.ide.system_names import system_names
from roaml.ide.verifiable import Texts, Verifiable, fingerprint, verifiable
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.memo import Interrupted
from roaml.project.paths import is_on_disk
from roaml.smc.choices import Choices
from roaml.smc.fault import FaultError
from roaml.smc.goal import STUCK_PROPERTY, Asked, with_threshold
from roaml.smc.model import Checker
from roaml.smc.pool import WorkersLostError
from roaml.smc.run import Answer, Tally, summary
from roaml.text import Location
from roaml.views.story import Line

if TYPE_CHECKING:
    from as2fm_lsp.server import Server

COMMAND = "as2fm.verify"
PROPERTIES = "as2fm/properties"
COUNTEREXAMPLE = "as2fm/counterexample"
TITLE = "Verify"

Json = dict[str, Any]


def register(server: Server) -> None:
    session = server.session

    @server.command(COMMAND)
    async def verify(ls: LanguageServer, *arguments: object) -> Json | None:
        """Verify properties of a system as it stands in the editor.

        Args:
            ls: the server; pygls gives it to a function that takes any number of arguments.
            arguments: the URI of the system file, the names of the properties (all if none are given), and options.

        Returns:
            `results`, one for each property as `as2fm-lsp verify --format json` writes them, or with an `error` in
            place of the numbers; `stuck`, what is known of getting stuck, in the same form, null if nothing is; and
            `errors`, those of the model. null if the user does not want it any more.
        """
        if not _are_arguments(arguments):
            text = f"{COMMAND} takes the URI of a system file, a list of names, and options."
            _tell(server, types.MessageType.Error, text)
            return None
        path = session.convert.path(str(arguments[0]))
        names = arguments[1] if len(arguments) > 1 else ()
        wanted = wishes(session.client_settings, arguments[2] if len(arguments) > 2 else None)
        for problem in wanted.problems:
            _tell(server, types.MessageType.Warning, problem)
        async with progress(server, f"Verifying {os.path.basename(path)}", cancellable=True) as bar:
            try:
                with server.requests.cancelled_by(bar.token):
                    run = _Run(server, bar, path, wanted)
                    return await run.answer([str(name) for name in names] if isinstance(names, Sequence) else [])
            except Interrupted:
                if bar.is_cancelled:
                    return None
                raise
            finally:
                server.refresh.look()

    @server.feature(PROPERTIES)
    def properties(_: Any) -> list[Json]:
        """The systems with their properties, and what is known of these."""
        moment = session.moment()
        found = []
        for path in moment.files():
            analysis = moment.snapshot(path).analysis
            if analysis.kind(path) is FileKind.SYSTEM:
                rows = [_property(server, analysis, path, each) for each in verifiable(analysis, path)]
                found.append({"uri": session.convert.uri(path), "properties": rows})
        return [system for system in found if system["properties"]]

    @server.feature(COUNTEREXAMPLE)
    async def why(params: Any) -> Json | None:
        """The shortest trace that speaks against a property; null if none is known."""
        path = session.convert.path(document_uri(params))
        known = server.verified.get(path, string(params, "property"))
        seen = speaking_against(known.result) if known else None
        if known is None or seen is None:
            return None

        found = await background.in_thread(
            lambda _: counterexample(
                known.subject,
                known.checker,
                known.asked,
                known.options,
                seen,
                lambda origin: _place_in_words(known.subject, origin),
            ),
            server.requests.checkpoint,
        )
        analysis = session.moment().snapshot(path).analysis
        return {
            "property": known.result.name,
            "heading": found.heading,
            "verdict": found.verdict,
            "trace": found.trace,
            "expected": missed(known.result),
            "stale": server.verified.is_stale(known, analysis, path),
            "steps": [_step(server, known, path, line) for line in found.lines],
        }


def lenses(server: Server, on: Document, broken: Collection[str]) -> Iterator[types.CodeLens]:
    """At each property of a system that is not `broken`, and at the system file. Results stand in the hints behind the
    names, and in the lenses only where no hints are shown."""
    tells = not _shows_hints(server)
    systems = system_names(on.analysis.memberships.get(on.path, ()))
    for system, name in systems.items():
        if system in broken or not is_on_disk(system):
            continue
        uri, where = on.convert.uri(system), f" in {name}" if len(systems) > 1 else ""
        found = verifiable(on.analysis, system)
        file = on.analysis.system_file(system)
        if system == on.path and file is not None and found:
            command = types.Command("Verify all", COMMAND, arguments=[uri])
            yield types.CodeLens(on.range(file.element.name_span), command)
            stuck_known = server.verified.get(system, STUCK_PROPERTY)
            if server.show_counterexample and stuck_known and stuck_known.result.stuck:
                stale = ", stale" if server.verified.is_stale(stuck_known, on.analysis, system) else ""
                title = f"Gets stuck{stale}: show who waits for whom"
                show = types.Command(title, server.show_counterexample, arguments=[uri, STUCK_PROPERTY])
                yield types.CodeLens(on.range(file.element.name_span), show)
        for each in found:
            if each.path != on.path:
                continue
            known = server.verified.get(system, each.name)
            words = _words(server, on.analysis, system, known) if tells else []
            title = " · ".join([f"{TITLE}{where}", *words])
            yield types.CodeLens(on.range(each.name_span), types.Command(title, COMMAND, arguments=[uri, [each.name]]))
            speaks = known and (missed(known.result) or known.result.stuck)
            if known and server.show_counterexample and speaks and speaking_against(known.result):
                show = types.Command("Show counterexample", server.show_counterexample, arguments=[uri, each.name])
                yield types.CodeLens(on.range(each.name_span), show)


def hints(server: Server, on: Document, within: types.Range) -> Iterator[types.InlayHint]:
    """What is known, behind the name of each property."""
    span = on.span(within)
    systems = system_names(on.analysis.memberships.get(on.path, ()))
    for system, name in systems.items():
        where = f" in {name}" if len(systems) > 1 else ""
        for each in verifiable(on.analysis, system) if server.verified.has(system) else ():
            known = server.verified.get(system, each.name)
            if known is None or each.path != on.path or not span.start <= each.name_span.end <= span.end:
                continue
            is_uniform = any(verdict.is_uniform for verdict in known.result.verdicts)
            mark = "✗" if missed(known.result) else "~" if is_uniform else "✓" if known.result.verdicts else "="
            mark = "⚠" if known.result.stuck else mark
            text = f"{mark} {', '.join(_words(server, on.analysis, system, known))}{where}"
            position = on.convert.position(on.source, min(each.name_span.end + 1, len(on.source.text)))
            whole = one_as_text(known.result, partial(_place_in_words, known.subject))
            yield types.InlayHint(position, text, tooltip=whole, padding_left=True)


def _shows_hints(server: Server) -> bool:
    document = server.client_capabilities.text_document
    return bool(document and document.inlay_hint) and shown(server.session.client_settings).results


def _words(server: Server, analysis: Analysis, system: str, known: Known | None) -> list[str]:
    if known is None:
        return []
    wrong = missed(known.result)
    parts = [short(known.result), *([f"not {wrong}"] if wrong else [])]
    parts += dict.fromkeys(verdict.text for verdict in known.result.verdicts if verdict.is_uniform)
    if known.result.stuck is not None:
        parts.append(f"{known.result.stuck.count:,} traces got stuck")
    if server.verified.is_stale(known, analysis, system):
        parts.append("stale")
    return [", ".join(parts)]


class _Run:
    """One call of the command."""

    def __init__(self, server: Server, bar: Progress, path: str, wanted: Wishes) -> None:
        self.server = server
        self.bar = bar
        self.path = path
        self.wanted = wanted

    async def answer(self, names: list[str]) -> Json | None:
        server, path = self.server, self.path
        name = os.path.basename(path)
        try:
            await self.bar.step("checking")
            system = api.loaded(server.session.moment().snapshot(path), path)
        except api.ModelError as error:
            self.say_wrong(f"{name} has {counted(error.result.diagnostics)} and was not verified.")
            if not self.wanted.is_silent:
                await show(server, error.result.snapshot, error.result.diagnostics)
            return {"results": [], "errors": [self.error(d, error.result) for d in error.result.diagnostics]}
        except api.PathError as error:
            self.say_wrong(str(error))
            return {"results": [], "errors": [{"message": str(error)}]}
        texts = fingerprint(system.analysis, path)
        subject = server.verified.subject(texts)
        if subject is None:
            await self.bar.step("translating")
            subject = of_system(system)
            server.verified.keep_subject(texts, subject)
        known = [each.name for each in subject.model.properties]
        rows: list[Json] = []
        results: list[Result] = []
        checker: Checker | None = None
        for each in dict.fromkeys(names or known):
            try:
                await self.bar.step(each)
                began = time.monotonic()
                checker, asked = self.asked(subject, each)
                answer, choices = await self.traces(checker, asked)
            except FaultError as fault:
                rows.append({"property": each, "error": self.fault(fault, system.analysis)})
                self.say_wrong(f"{each}: {fault.message}")
                continue
            except (api.PropertyError, RangeError, WorkersLostError) as error:
                rows.append({"property": each, "error": {"message": str(error)}})
                self.say_wrong(str(error))
                continue
            verdicts = tuple(
                under_all_schedulers(judge(expected, answer), answer, choices) for expected in self.expected(asked)
            )
            options = self.wanted.options
            gets_stuck = stuck.stuck_in(subject, checker, asked, answer)
            took = time.monotonic() - began
            result = Result(each, answer, verdicts, took, stuck=gets_stuck, choices=choices)
            results.append(result)
            server.verified.put(path, Known(result, subject, system.analysis, checker, asked, options, texts))
            rows.append({**row(result), "short": short(result), "counterexample": speaking_against(result) is not None})
            server.refresh.look()
            if not self.wanted.is_silent:
                _tell(server, types.MessageType.Info, self.text(result, subject))
        look = None if checker is None else await self.look(subject, system.analysis, checker, results, texts)
        return {"results": rows, "errors": [], "stuck": look}

    def text(self, result: Result, subject: Subject) -> str:
        """A result as a message; another message shows who waits for whom."""
        shown = "in a message of its own"
        return one_as_text(result, partial(_place_in_words, subject), self.wanted.stuck, shown)

    def asked(self, subject: Subject, name: str) -> tuple[Checker, Asked]:
        """A property, ready to be answered.

        Raises:
            PropertyError, FaultError: it cannot be answered.
            RangeError: no value of it can meet what is expected of it.
        """
        checker = api.checker(subject.model, [name])
        for why in checker.refused.values():
            raise why
        asked = self.with_threshold(checker.asked[0])
        for expected in self.expected(asked):
            check_range(expected, asked.question)
        return checker, asked

    async def look(
        self, subject: Subject, analysis: Analysis, checker: Checker, results: Sequence[Result], texts: Texts
    ) -> Json | None:
        """What is known of getting stuck, by traces that are made for it if it was not asked."""
        if not stuck.can_be_stuck(checker):
            return None
        known = stuck.Look(None, None, self.wanted.stuck)
        if not any(result.answer and result.answer.question.is_stuck for result in results):
            options, asked = self.wanted.options, checker.stuck
            await self.bar.step(asked.question.name)
            began = time.monotonic()
            known = await background.in_thread(
                lambda checked: stuck.look(subject, checker, options, self.wanted.stuck, lambda _, __: checked()),
                self.server.requests.checkpoint,
            )
            is_free = all(each.name != asked.question.name for each in subject.model.properties)
            if known.answer is not None and is_free:
                result = Result(asked.question.name, known.answer, (), time.monotonic() - began, stuck=known.stuck)
                made = Known(result, subject, analysis, checker, asked, known.answer.options, texts)
                self.server.verified.put(self.path, made)
            self.server.refresh.look()
        known = replace(known, stuck=stuck.shortest([known.stuck, *(result.stuck for result in results)]))
        place_of = partial(_place_in_words, subject)
        text = stuck.as_text(known, place_of)
        text += explained(text, subject.model, place_of)
        if known.stuck is not None and not self.wanted.is_silent:
            kind = types.MessageType.Warning if known.is_met else types.MessageType.Error
            _tell(self.server, kind, text.strip())
        row = stuck.as_row(known, lambda origin: _place(self.server, analysis, origin))
        return {**row, "text": text.strip()}

    async def traces(self, checker: Checker, asked: Asked) -> tuple[Answer, Choices | None]:
        def tell(tally: Tally) -> None:
            so_far = Result(asked.question.name, summary(asked.question, self.wanted.options, tally), (), 0)
            self.bar.say(f"{asked.question.name}: {short(so_far)}, {tally.traces:,} traces")

        is_uniform = self.server.session.settings_of(self.path).scheduler == "uniform"
        checkpoint = self.server.requests.checkpoint
        is_uniform = is_uniform or asked.question.is_stuck
        return await background.answer(checker, asked, self.wanted.options, checkpoint, tell, is_uniform)

    def with_threshold(self, asked: Asked) -> Asked:
        """The question with the first number that it is compared with."""
        first = next((each for each in self.wanted.expectations if each.name == asked.question.name), None)
        if asked.question.threshold is not None or first is None:
            return asked
        return replace(asked, question=with_threshold(asked.question, first.threshold))

    def expected(self, asked: Asked) -> Iterator[Expectation]:
        own = [each for each in self.wanted.expectations if each.name == asked.question.name]
        threshold = asked.question.threshold
        if threshold is not None and not any(each.threshold == threshold for each in own):
            yield Expectation(asked.question.name, threshold, is_own=True)
        yield from own

    def error(self, diagnostic: Diagnostic, result: api.CheckResult) -> Json:
        place = _place(self.server, result.snapshot.analysis, Location(diagnostic.path, diagnostic.span))
        return {"message": diagnostic.message, "code": diagnostic.code, **place}

    def fault(self, fault: FaultError, analysis: Analysis) -> Json:
        place = _place(self.server, analysis, fault.origin) if fault.origin is not None else {}
        return {"message": fault.message, "code": fault.code, "trace": fault.trace, **place}

    def say_wrong(self, text: str) -> None:
        if not self.wanted.is_silent:
            _tell(self.server, types.MessageType.Error, text)


def _property(server: Server, analysis: Analysis, system: str, each: Verifiable) -> Json:
    place = _place(server, analysis, Location(each.path, each.name_span))
    found: Json = {"name": each.name, "comment": each.comment, **place}
    known = server.verified.get(system, each.name)
    if known is not None:
        found["stale"] = server.verified.is_stale(known, analysis, system)
    return found


def _step(server: Server, known: Known, system: str, line: Line) -> Json:
    origin = line.origin
    nodes = highlights(known.analysis, system, line.automaton, origin, line.location) if origin is not None else ()
    convert = server.session.convert
    return {
        "step": line.step,
        "time": line.time,
        "who": line.who,
        "what": line.what,
        "place": line.place,
        "details": list(line.details),
        **(_place(server, known.analysis, origin) if origin is not None else {}),
        "highlights": [{"kind": each.picture, "uri": convert.uri(each.path), "node": each.node} for each in nodes],
    }


def _place_in_words(subject: Subject, origin: Location) -> str:
    place = subject.place(origin)
    return f"{os.path.basename(place[0])}:{place[1]}" if place else ""


def _place(server: Server, analysis: Analysis, location: Location) -> Json:
    """`uri` and `range`; nothing if the file is not there."""
    source = analysis.source(location.path)
    if source is None:
        return {}
    convert = server.session.convert
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


def _tell(server: Server, kind: types.MessageType, text: str) -> None:
    server.window_show_message(types.ShowMessageParams(kind, text))
