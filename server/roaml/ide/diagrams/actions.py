# SPDX-License-Identifier: Apache-2.0
"""Short texts for the triggers and statements of machines in diagrams."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.exhaustive import assert_never
from roaml.model.machine import (
    Assign,
    CallChild,
    Handler,
    If,
    Machine,
    NoEffect,
    Param,
    ReturnHalted,
    ReturnStatus,
    RosSend,
    Send,
    SetOutput,
    Statement,
    Target,
)
from roaml.model.syntax import Expression, Name, PortRead
from roaml.roles import ProtocolPart

_TRIGGERS: Mapping[ProtocolPart, str] = {
    ProtocolPart.MESSAGE: "{}",
    ProtocolPart.TICK: "timer {}",
    ProtocolPart.BT_TICK: "tick",
    ProtocolPart.BT_HALT: "halt",
    ProtocolPart.CHILD_STATUS: "status of child {}",
    ProtocolPart.CHILD_HALTED: "child {} halted",
    ProtocolPart.THREAD_START: "{} thread start",
    ProtocolPart.THREAD_FREE: "{} thread free",
}
"""The texts for triggers. The text for any other trigger consists of the interface and the name of the part."""

_SENDS: Mapping[ProtocolPart, str] = {
    ProtocolPart.MESSAGE: "publish {}",
    ProtocolPart.REQUEST: "call {}",
    ProtocolPart.RESPONSE: "respond {}",
    ProtocolPart.GOAL: "send goal {}",
    ProtocolPart.GOAL_ACCEPTED: "accept {}",
    ProtocolPart.GOAL_REJECTED: "reject {}",
    ProtocolPart.THREAD_START: "start thread {}",
    ProtocolPart.THREAD_FREE: "free thread {}",
}


class Wording:
    """The texts for the parts of one machine. They contain the names of interfaces instead of the handles."""

    def __init__(self, machine: Machine) -> None:
        self._interfaces = {
            handle: declaration.interface.value
            for handle, declarations in machine.declarations_by_handle.items()
            for declaration in declarations[:1]
            if isinstance(declaration.interface, Name)
        }

    def trigger(self, handler: Handler) -> str:
        """The text for the trigger of a transition; "" if the transition has none."""
        part = handler.trigger
        if part is None:
            return ""
        if part is ProtocolPart.EVENT:
            return handler.event.value if handler.event else ""
        subject = self._interface(handler.handle) or (handler.child.value if handler.child else "")
        return trigger_text(part, subject)

    def actions(self, body: Sequence[Statement]) -> tuple[str, ...]:
        """The texts for the statements that have an effect, one for each statement."""
        return tuple(text for statement in body for text in self._statement(statement))

    def _statement(self, statement: Statement) -> Iterator[str]:
        match statement:
            case Assign():
                yield f"{_text(statement.location)} := {_text(statement.value)}"
            case Send():
                yield f"send {_name(statement.event)}{_arguments(statement.params)}"
            case If():
                yield self._if(statement)
            case RosSend():
                words = _SENDS.get(statement.part, f"{statement.part.value.replace('-', ' ')} {{}}")
                yield words.format(self._interface(statement.handle)) + _arguments(statement.fields)
            case ReturnStatus():
                yield f"return {_name(statement.status)}"
            case ReturnHalted():
                yield "return halted"
            case CallChild():
                yield f"{'halt' if statement.halts else 'tick'} child {_name(statement.child)}"
            case SetOutput():
                yield f"output {_name(statement.key)} := {_text(statement.value)}"
            case NoEffect():
                return
            case _:
                assert_never(statement)

    def _if(self, statement: If) -> str:
        parts = [f"if ({_text(branch.cond)}) {self._block(branch.body)}" for branch in statement.branches]
        if statement.otherwise:
            parts.append(self._block(statement.otherwise.body))
        return " else ".join(parts)

    def _block(self, body: Sequence[Statement]) -> str:
        return f"{{ {'; '.join(self.actions(body))} }}"

    def _interface(self, handle: Name | None) -> str:
        return self._interfaces.get(handle.value, handle.value) if handle else ""


def trigger_text(part: ProtocolPart, subject: str) -> str:
    """The text for the reception of a part of an interface, a timer or a child, whose name is `subject`."""
    return _TRIGGERS.get(part, f"{{}} {part.value.replace('-', ' ')}").format(subject).strip()


def guard(handler: Handler) -> str:
    """The condition of a transition in brackets; "" if there is none."""
    return f"[{_text(handler.cond)}]" if handler.cond else ""


def outcome(handler: Handler, target: Target) -> str:
    """The text for the target of a transition with several targets: its probability, or whether the goal was accepted;
    "" for other targets."""
    if handler.trigger is ProtocolPart.GOAL_RESPONSE:
        return "accepted" if target is handler.targets[0] else "rejected"
    if not handler.is_probabilistic:
        return ""
    return target.probability.value if target.probability else "otherwise"


def _arguments(params: Sequence[Param]) -> str:
    """The fields of a message in parentheses; "" if there are none. If `data` is the only field, its name is
    omitted."""
    if len(params) == 1 and params[0].name and params[0].name.value == "data":
        return f" ({_text(params[0].value)})"
    fields = ", ".join(f"{_name(param.name)} = {_text(param.value)}" for param in params)
    return f" ({fields})" if fields else ""


def _name(name: Name | None) -> str:
    return name.value if name else "?"


def _text(value: Expression | PortRead | None) -> str:
    match value:
        case None:
            return "?"
        case PortRead():
            return f"port {_name(value.key)}"
        case Expression():
            return " ".join(value.text.split())
        case _:
            return assert_never(value)
