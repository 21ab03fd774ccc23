# SPDX-License-Identifier: Apache-2.0
"""Requests that change the run: publish a message, call a service, set a variable. A changed run does not show the
behaviour of the model."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from as2fm_lsp.debug.arguments import Arguments, RequestError
from as2fm_lsp.debug.session import Body, DebugSession, Handler
from roaml.debugging.by_hand import Sendable, sendable, sending, setting
from roaml.debugging.evaluate import evaluate, parsed
from roaml.debugging.frames import Frame
from roaml.debugging.scopes import ScopeEntry
from roaml.debugging.values import Value, shown, type_of
from roaml.regex import regex
from roaml.simulation import RunError
from roaml.simulation.intervention import Intervention
from roaml.smc.fault import FaultError
from roaml.views.event_words import event_phrase

_COMMAND = regex(r"\s*(publish|call|send)\s+(\S+)\s*(.*)", re.DOTALL)
_BEGINNING = regex(r"\s*(publish|call|send)\s+(\S*)")


def is_command(text: str) -> bool:
    """Whether a line of the console is a command that sends an event, such as `publish /topic {data: 1}`."""
    return _COMMAND.fullmatch(text) is not None


class ByHandRequests:
    """The handlers of requests that change the run."""

    def __init__(self, session: DebugSession) -> None:
        self._session = session
        self.handlers: Mapping[str, Handler] = {
            "events": self._events,
            "publish": self._publish,
            "setVariable": self._set_variable,
            "setExpression": self._set_expression,
            "completions": self._completions,
        }

    def execute(self, text: str, frame: Frame | None) -> str:
        """Execute a line of the console for which `is_command` is true; return a description of the effect.

        Raises:
            WatchError, RequestError: the command is not valid, or not possible in this state.
        """
        match = _COMMAND.fullmatch(text)
        if match is None:
            raise RequestError("this is not a command; use for example `publish /topic {data: 1}`")
        names = self._session.stopped.values.names(frame)
        fields = evaluate(parsed(match[3]), names) if match[3].strip() else {}
        return self._send(match[2], fields)

    def _send(self, name: str, fields: Value) -> str:
        debugger = self._session.stopped
        change = sending(debugger.session, debugger.sources, name, fields)
        self._intervene(change)
        text = event_phrase(change.event, debugger.session.automata)
        return f"sent {text}; from here on, the run does not show the behaviour of the model"

    def _intervene(self, change: Intervention) -> None:
        try:
            stop = self._session.stopped.intervene(change)
        except FaultError as fault:
            raise RequestError(fault.message) from None
        except RunError as error:
            raise RequestError(str(error)) from None
        self._session.report_later(stop)

    def _events(self, arguments: Arguments) -> Body:
        return {"events": [_described(form) for form in self._sendable()]}

    def _sendable(self) -> list[Sendable]:
        debugger = self._session.stopped
        return list(sendable(debugger.session, debugger.sources))

    def _publish(self, arguments: Arguments) -> Body:
        fields = arguments.members.get("fields", {})
        if isinstance(fields, str):
            fields = evaluate(parsed(fields), self._session.stopped.values.names(None)) if fields.strip() else {}
        text = self._send(arguments.text("event", None), _value(fields, 0))
        return {"text": text, "step": self._session.stopped.session.position}

    def _set_variable(self, arguments: Arguments) -> Body:
        name = arguments.text("name", None)
        children = self._session.children(arguments.number("variablesReference"))
        entry = next((child.entry for child in children if child.entry.name == name), None)
        return self._set(name, entry, arguments)

    def _set_expression(self, arguments: Arguments) -> Body:
        expression = arguments.text("expression", None)
        return self._set(expression, self._session.variable(expression, arguments), arguments)

    def _set(self, name: str, entry: ScopeEntry | None, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        text = arguments.text("value", None)
        frame = self._session.frame(arguments) if arguments.has("frameId") else None
        names = debugger.values.names(frame)
        if entry is None:
            evaluate(parsed(name), names)  # raises an error if there is no such name
        if entry is None or entry.variable is None:
            raise RequestError(f"`{name}` cannot be set; only variables and blackboard entries can be set")
        value = evaluate(parsed(text), names)
        self._intervene(setting(debugger.session, debugger.sources, entry.variable, value))
        return {"value": shown(value), "type": entry.type or type_of(value)}

    def _completions(self, arguments: Arguments) -> Body:
        text, column = arguments.text("text", None), arguments.number("column", 1)
        before = text[: max(0, column - self._session.client.first_column)]
        match = _BEGINNING.fullmatch(before)
        if match is None:
            commands = ("publish", "call") if before.strip() in ("", *_prefixes("publish"), *_prefixes("call")) else ()
            targets = [{"label": f"{name} ", "start": 0, "length": len(before), "type": "keyword"} for name in commands]
            return {"targets": targets}
        start = match.start(2) + self._session.client.first_column
        forms = [form for form in self._sendable() if form.is_free]
        names = [form.name for form in forms]
        labels = [form.name if names.count(form.name) == 1 else form.event for form in forms]
        return {
            "targets": [
                {
                    "label": label,
                    "text": f"{label} {_template(form)}",
                    "detail": form.text,
                    "start": start,
                    "length": len(match[2]),
                    "type": "value",
                }
                for label, form in zip(labels, forms, strict=True)
                if label.startswith((match[2], f"/{match[2]}"))
            ]
        }


def _prefixes(word: str) -> list[str]:
    return [word[:length] for length in range(1, len(word) + 1)]


def _template(form: Sendable) -> str:
    return _object(dict(form.template))


def _object(value: Value) -> str:
    """A value as an expression; unlike the result of `shown`, it is not abbreviated."""
    match value:
        case dict():
            return f"{{{', '.join(f'{name}: {_object(inner)}' for name, inner in value.items())}}}"
        case list():
            return f"[{', '.join(map(_object, value))}]"
    return shown(value)


def _described(form: Sendable) -> dict[str, Any]:
    return {
        "event": form.event,
        "name": form.name,
        "text": form.text,
        "fields": _template(form),
        "types": dict(form.types),
        "isFree": form.is_free,
    }


MAX_DEPTH = 50


def _value(value: object, depth: int) -> Value:
    """Convert a value of JSON to a value of expressions."""
    if depth < MAX_DEPTH:
        match value:
            case bool() | int() | float() | str():
                return value
            case list():
                return [_value(element, depth + 1) for element in value]
            case dict():
                return {str(name): _value(inner, depth + 1) for name, inner in value.items()}
    raise RequestError("`fields` must be an object, or a text such as `{data: 1}`")
