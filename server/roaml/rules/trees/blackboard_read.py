# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-read`, which blackboard_read.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.tree import Name, walk
from roaml.model.expand import Reference
from roaml.model.machine import Declaration
from roaml.model.syntax import Expression, PortRead
from roaml.model.value_types import TypedValue, ValueUse
from roaml.model.vocabulary import EVENT_VARIABLES
from roaml.roles import SymbolKind, ValuePart
from roaml.rules.rule import MachineContext, Rule

CONSTANT = (ValueUse.INITIAL, ValueUse.BOUND)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report reads of ports that the tree binds to the blackboard, in places where the blackboard cannot be read
    (docs/spec/plugins.md#get-input)."""
    bound = _bound(context)
    if not bound:
        return
    for value in context.typed.values:
        if isinstance(value.value, PortRead) and value.value.key and value.value.key.value in bound:
            reason = _reason(context, value)
            if reason:
                where = bound[value.value.key.value]
                yield RULE.at(value.value.span, f"{reason}; `{where}` in the tree binds the port to the blackboard")
    for declaration in context.machine.declarations:
        for read in (declaration.interface, declaration.rate):
            if isinstance(read, PortRead) and read.key and read.key.value in bound:
                subject = _what(declaration)
                where = bound[read.key.value]
                yield RULE.at(
                    read.span, f"{subject} must be constant; `{where}` in the tree binds the port to the blackboard"
                )


def _bound(context: MachineContext) -> dict[str, str]:
    """The ports that a node of the tree binds to the blackboard, each with the binding as written in the tree, such as
    `goal="{pose}"`."""
    bindings: dict[str, str] = {}
    for automaton in context.automata:
        for port in automaton.outline.ports:
            value = automaton.port(port.key)
            if isinstance(value, Reference):
                written = value.variable.removeprefix(automaton.board)
                bindings.setdefault(port.key, f'{port.key}="{{{written}}}"')
    return bindings


def _what(declaration: Declaration) -> str:
    return "the rate of a timer" if declaration.kind is SymbolKind.TIMER else "the name of a topic, service or action"


def _reason(context: MachineContext, value: TypedValue) -> str:
    handler = value.place.handler
    if value.use in CONSTANT:
        return "initial values and bounds must be constant"
    if handler is None:
        return f"the blackboard cannot be read in `<{value.place.part}>`; read it in the body of a transition"
    if handler.is_probabilistic:
        return "the blackboard cannot be read in a transition with several targets; read it in an earlier transition"
    names = {
        node.name
        for other in context.typed.values
        if other.place.handler is handler and other.place.part is ValuePart.BODY and isinstance(other.value, Expression)
        for node in walk(other.value.tree)
        if isinstance(node, Name)
    }
    mixed = sorted(names & EVENT_VARIABLES.keys())
    if mixed:
        return f"the blackboard is read before this body is executed, and then `{mixed[0]}` is no longer available"
    return ""


RULE = Rule(
    "blackboard-read",
    Severity.ERROR,
    "The blackboard is read in a place where reading it is not possible.",
    machine=check,
)
