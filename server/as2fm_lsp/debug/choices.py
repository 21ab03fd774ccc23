# SPDX-License-Identifier: Apache-2.0
"""Requests for the possible next steps, for a step that the user chooses, and for the properties of the run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from as2fm_lsp.debug.arguments import Arguments, RequestError
from as2fm_lsp.debug.session import Body, DebugSession, Handler
from roaml.debugging.debugger import Debugger
from roaml.ide.describe import markdown
from roaml.simulation.choices import Choice
from roaml.smc.fault import FaultError


class ChoiceRequests:
    """The handlers of requests about choices."""

    def __init__(self, session: DebugSession) -> None:
        self._session = session
        self.handlers: Mapping[str, Handler] = {
            "choices": self._choices,
            "choose": self._choose,
            "saveSession": self._save_session,
            "properties": self._properties,
        }

    def _choices(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        session = debugger.session
        end = session.end
        upcoming = debugger.upcoming()
        return {
            "step": session.position,
            "time": session.time,
            "seed": session.seed,
            "trace": session.trace,
            "property": session.compiled_property.question.name,
            "verdicts": {name: verdict.value for name, verdict in debugger.verdicts.items()},
            "isByHand": session.is_by_hand,
            "isChanged": session.is_changed,
            "end": None if end is None else end.text,
            "fault": None if debugger.fault is None else debugger.fault.message,
            "choices": [
                {**self._choice(choice), "isNext": upcoming is not None and _is_choice(debugger, choice)}
                for choice in ([] if end is not None else session.choices())
            ],
        }

    def _properties(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        sources = debugger.sources
        return {
            "properties": [
                {
                    "name": name,
                    "text": markdown.plain(sources.comments.get(name, "")),
                    "verdict": verdict.value,
                    **self._session.where(sources.property_origins.get(name)),
                }
                for name, verdict in debugger.verdicts.items()
            ]
        }

    def _choice(self, choice: Choice) -> dict[str, Any]:
        outcomes = [
            {"number": number, "text": outcome.text, "probability": outcome.probability}
            for number, outcome in enumerate(choice.outcomes, 1)
        ]
        text = {"number": choice.number, "text": choice.text, "probability": choice.probability}
        origin = {"isOfTranslation": choice.is_of_translation, **self._session.where(choice.origin)}
        return {**text, "outcomes": outcomes, **origin}

    def _choose(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        number, drawn = arguments.number("choice"), arguments.natural("outcome", 0)
        choice = next((choice for choice in debugger.session.choices() if choice.number == number), None)
        if debugger.session.end is not None:
            raise RequestError("the run has ended, so there are no choices; step backwards or restart")
        if choice is None:
            raise RequestError(f"there is no choice {number} in this state; `choices` lists them")
        if drawn > len(choice.outcomes):
            raise RequestError(f"choice {number} has no outcome {drawn}; `choices` lists its outcomes")
        try:
            stop = debugger.choose(choice, choice.outcomes[drawn - 1] if drawn else None)
        except FaultError as fault:
            raise RequestError(fault.message) from None
        self._session.report_later(stop)
        return {"step": debugger.session.position}

    def _save_session(self, arguments: Arguments) -> Body:
        return {"session": self._session.stopped.session.save().to_json()}


def _is_choice(debugger: Debugger, choice: Choice) -> bool:
    """Whether the next step takes this choice if the user does not select another one."""
    step = debugger.upcoming()
    taken = [] if step is None else [part.automaton for part in step.parts]
    return step is not None and set(taken) == set(choice.automata)
