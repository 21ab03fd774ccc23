# SPDX-License-Identifier: Apache-2.0
"""`as2fm.verify`: verifies properties of a system. Properties that can share traces are verified together. Each result
is stored, and sent to the client, as soon as it is complete."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from functools import partial
from typing import Any

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.first_error import counted, show
from as2fm_lsp.handlers.results import VERIFY, place, place_in_words, verified_row
from as2fm_lsp.progress import Progress
from as2fm_lsp.verification import background, stuck_report
from as2fm_lsp.verification.editor_targets import editor_target
from as2fm_lsp.verification.known_results import KnownResult, short
from as2fm_lsp.verification.node_names import explained
from as2fm_lsp.verification.report import one_as_text
from as2fm_lsp.verification.settings import VerificationSettings, verification_settings
from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.ide.verifiable import Texts, verifiable
from roaml.interruption import Interrupted
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.record import replace
from roaml.smc.fault import FaultError
from roaml.smc.goal import STUCK_PROPERTY, CompiledProperty
from roaml.smc.pool import WorkersLostError
from roaml.smc.run import summary
from roaml.smc.tally import Tally
from roaml.text import Location
from roaml.verification import stuck
from roaml.verification.expectations import RangeError, check_range
from roaml.verification.results import Estimated, Refused, Result, Traces
from roaml.verification.target import VerificationTarget
from roaml.verification.verifier import Verifier, checker_of

Json = dict[str, Any]


def register(context: Context) -> None:
    session = context.session

    @context.command(VERIFY)
    async def verify(*arguments: object) -> Json | None:
        """Verify properties of a system as it is in the editor.

        Args:
            arguments: the URI of the system file, the names of the properties (all if none are given), and options:
                settings of the verification (`as2fm_lsp.verification.settings`), and as `partialResultToken` a token
                with which each result is also sent as a progress notification when it is complete.

        Returns:
            `results`, one for each property as `as2fm-lsp verify --format json` writes them, or with an `error` instead
                of the numbers; `stuck`, whether the system gets stuck, in the same form, null if unknown; and `errors`,
                those of the model. null if the user has cancelled the verification.
        """
        if not _are_arguments(arguments):
            text = f"{VERIFY} needs the URI of a system file, and optionally a list of names and options."
            context.client.show_message(types.MessageType.Error, text)
            return None
        path = session.convert.path(str(arguments[0]))
        names = arguments[1] if len(arguments) > 1 else ()
        options = arguments[2] if len(arguments) > 2 else None
        settings = verification_settings(session.client_settings, options)
        for problem in settings.problems:
            context.client.show_message(types.MessageType.Warning, problem)
        async with context.progress.show(f"Verifying {os.path.basename(path)}", cancellable=True) as bar:
            try:
                with context.requests.cancelled_by(bar.token):
                    run = _VerifyCommand(context, bar, path, settings, options)
                    return await run.answer([str(name) for name in names] if isinstance(names, Sequence) else [])
            except Interrupted:
                if bar.is_cancelled:
                    return None
                raise
            finally:
                context.refresh.update()


class _VerifyCommand:
    """One call of the command."""

    def __init__(
        self, context: Context, bar: Progress, path: str, settings: VerificationSettings, options: object
    ) -> None:
        self.context = context
        self.bar = bar
        self.path = path
        self.settings = settings
        self.options = options
        self.rows: dict[str, Json] = {}

    async def answer(self, names: list[str]) -> Json | None:
        context, path = self.context, self.path
        name = os.path.basename(path)
        try:
            await self.bar.step("checking")
            model = editor_target(context, path)
        except api.ModelError as error:
            self.show_error(f"{name} has {counted(error.result.diagnostics)} and was not verified.")
            if not self.settings.is_silent:
                await show(context, error.result.snapshot, error.result.diagnostics)
            return {"results": [], "errors": [self.error(d, error.result) for d in error.result.diagnostics]}
        except (api.PathError, api.MockError) as error:
            self.show_error(str(error))
            return {"results": [], "errors": [{"message": str(error)}]}
        target, analysis, texts = model.target, model.analysis, model.texts
        if model.note:
            context.client.show_message(types.MessageType.Info, model.note)
        await self.bar.step("compiling")
        names = list(dict.fromkeys(names or self.asked(analysis, target)))
        verifier, properties = self.compiled(target, names, analysis)
        results: list[Result] = []
        together = [
            property_ for property_ in properties.values() if verifier is not None and verifier.can_share(property_)
        ]
        if verifier is not None and len(together) > 1:
            results += await self.together(verifier, together, analysis, texts)
        for property_name in names:
            if verifier is None or property_name in self.rows:
                continue
            try:
                result = await self.alone(verifier, properties[property_name])
            except FaultError as fault:
                self.refuse(property_name, fault, analysis)
            except WorkersLostError as error:
                self.reject(property_name, str(error))
            else:
                results.append(result)
                self.publish(result, target, analysis, texts)
        stuck_row = None if verifier is None else await self.check_stuck(verifier, analysis, results, texts)
        return {"results": [self.rows[name] for name in names], "errors": [], "stuck": stuck_row}

    def asked(self, analysis: Analysis, target: VerificationTarget) -> list[str]:
        """The properties that are verified if none is named: all that the editor shows."""
        if analysis.kind(self.path) is FileKind.TREE:
            return [property_.name for property_ in verifiable(analysis, self.path)]
        return [property_.name for property_ in target.properties]

    def compiled(
        self, target: VerificationTarget, names: Sequence[str], analysis: Analysis
    ) -> tuple[Verifier | None, dict[str, CompiledProperty]]:
        """The properties that can be verified, compiled together. For each other property, a row with its error is
        stored."""
        context, settings = self.context, self.settings
        known = {property_.name for property_ in target.properties}
        usable = []
        for name in names:
            if name in known or name == STUCK_PROPERTY:
                usable.append(name)
                continue
            try:
                checker_of(target, [name])
            except api.PropertyError as error:
                self.reject(name, str(error))
        if not usable:
            return None, {}
        configured = context.session.settings_of(self.path)
        try:
            checker = checker_of(target, usable)
        except (FaultError, api.PropertyError) as error:
            for name in usable:
                if isinstance(error, FaultError):
                    self.refuse(name, error, analysis)
                else:
                    self.reject(name, str(error))
            return None, {}
        is_exact = settings.exact_if_small
        verifier = Verifier(
            target,
            checker,
            settings.options,
            settings.expectations,
            configured.only_uniform,
            is_exact,
            uniform=configured.uniform,
        )
        properties = {}
        for name in usable:
            try:
                question = verifier.question(name)
                for expectation in verifier.expected(question):
                    check_range(expectation, question.question)
                properties[name] = question
            except FaultError as fault:
                self.refuse(name, fault, analysis)
            except RangeError as error:
                self.reject(name, str(error))
        return verifier, properties

    async def alone(self, verifier: Verifier, property_: CompiledProperty) -> Result:
        """The result of a property, from traces that it does not share."""
        name = property_.question.name
        await self.bar.step(name)
        began = time.monotonic()

        def show_estimate(tally: Tally) -> None:
            self.bar.set_message(f"{name}: {_so_far(verifier, property_, tally)}")

        result = await background.answer(verifier, property_, self.context.requests.checkpoint, show_estimate)
        return replace(result, seconds=time.monotonic() - began)

    async def together(
        self, verifier: Verifier, properties: Sequence[CompiledProperty], analysis: Analysis, texts: Texts
    ) -> list[Result]:
        """The results of properties that share traces. If the user cancels the verification, the complete results are
        kept."""
        count = len(properties)
        await self.bar.step(f"{count} properties from the same traces")

        def show_estimates(tallies: Sequence[Tally]) -> None:
            open_ = [
                (property_, tally)
                for property_, tally in zip(properties, tallies, strict=True)
                if not tally.is_finished
            ]
            done = f"{count - len(open_)} of {count} properties"
            if open_:
                first, tally = open_[0]
                self.bar.set_message(f"{done}, {first.question.name}: {_so_far(verifier, first, tally)}")
            else:
                self.bar.set_message(f"{done}; trying other schedulers")

        def keep(result: Result) -> None:
            if isinstance(result.outcome, Refused):
                self.refuse(result.name, result.outcome.fault, analysis)
            else:
                results.append(result)
                self.publish(result, verifier.target, analysis, texts)

        results: list[Result] = []
        checkpoint = self.context.requests.checkpoint
        try:
            await background.answer_together(verifier, properties, checkpoint, show_estimates, keep)
        except WorkersLostError as error:
            for property_ in properties:
                if property_.question.name not in self.rows:
                    self.reject(property_.question.name, str(error))
        return results

    def publish(self, result: Result, target: VerificationTarget, analysis: Analysis, texts: Texts) -> None:
        """Store a complete result, and send it to the client."""
        self.context.results.put(self.path, KnownResult(result, analysis, texts, self.options))
        self.report_row(result.name, verified_row(result))
        self.context.refresh.update()
        if not self.settings.is_silent:
            self.context.client.show_message(types.MessageType.Info, self.text(result, target))

    def refuse(self, name: str, fault: FaultError, analysis: Analysis) -> None:
        """Report that a property cannot be decided."""
        self.report_row(name, {"property": name, "error": self.fault(fault, analysis)})
        self.show_error(f"{name}: {fault.message}")

    def reject(self, name: str, message: str) -> None:
        """Report that a property is unknown or cannot be compiled."""
        self.report_row(name, {"property": name, "error": {"message": message}})
        self.show_error(message)

    def report_row(self, name: str, row: Json) -> None:
        self.rows[name] = row
        if self.settings.partial_result_token is not None:
            self.context.client.send_partial_result(self.settings.partial_result_token, row)

    def text(self, result: Result, target: VerificationTarget) -> str:
        """A result as a message. A separate message shows the waiting automata."""
        shown = "in a separate message"
        return one_as_text(result, partial(place_in_words, target), self.settings.stuck, shown)

    async def check_stuck(
        self, verifier: Verifier, analysis: Analysis, results: Sequence[Result], texts: Texts
    ) -> Json | None:
        """Whether the system gets stuck. Traces are generated to find out, unless this was requested as a property.
        `None` if the model cannot get stuck."""
        target, checker, level = verifier.target, verifier.checker, self.settings.stuck
        if not stuck.can_be_stuck(checker):
            return None
        known = stuck.StuckResult(None, None, level)
        if not any(result.includes_stuck for result in results):
            stuck_property = checker.stuck
            await self.bar.step(stuck_property.question.name)
            began = time.monotonic()
            known = await background.in_thread(
                lambda checked: verifier.check_stuck(level, lambda _, __: checked()),
                self.context.requests.checkpoint,
            )
            is_free = all(property_.name != stuck_property.question.name for property_ in target.properties)
            if known.answer is not None and is_free:
                traces = Traces(target, checker, stuck_property, known.answer.options)
                seconds = time.monotonic() - began
                outcome = Estimated(known.answer, stuck=known.stuck, traces=traces)
                result = Result(stuck_property.question.name, outcome, seconds=seconds)
                self.context.results.put(self.path, KnownResult(result, analysis, texts, self.options))
            self.context.refresh.update()
        known = replace(known, stuck=stuck.shortest([known.stuck, *(result.stuck for result in results)]))
        place_of = partial(place_in_words, target)
        text = stuck_report.as_text(known, place_of)
        text += explained(text, target.model, place_of)
        if known.stuck is not None and not self.settings.is_silent:
            kind = types.MessageType.Warning if known.is_met else types.MessageType.Error
            self.context.client.show_message(kind, text.strip())
        row = stuck_report.as_row(known, lambda origin: place(self.context, analysis, origin))
        return {**row, "text": text.strip()}

    def error(self, diagnostic: Diagnostic, result: api.CheckResult) -> Json:
        where = place(self.context, result.snapshot.analysis, Location(diagnostic.path, diagnostic.span))
        return {"message": diagnostic.message, "code": diagnostic.code, **where}

    def fault(self, fault: FaultError, analysis: Analysis) -> Json:
        where = {} if fault.origin is None else place(self.context, analysis, fault.origin)
        return {"message": fault.message, "code": fault.code, "trace": fault.trace, **where}

    def show_error(self, text: str) -> None:
        if not self.settings.is_silent:
            self.context.client.show_message(types.MessageType.Error, text)


def _so_far(verifier: Verifier, property_: CompiledProperty, tally: Tally) -> str:
    """The estimate of a property whose verification is not complete."""
    result = Result(property_.question.name, Estimated(summary(property_.question, verifier.options, tally)))
    return f"{short(result)}, {tally.traces:,} traces"


def _are_arguments(arguments: Sequence[object]) -> bool:
    if not 1 <= len(arguments) <= 3 or not isinstance(arguments[0], str):
        return False
    names = arguments[1] if len(arguments) > 1 else ()
    return names is None or (not isinstance(names, str) and isinstance(names, Sequence))
