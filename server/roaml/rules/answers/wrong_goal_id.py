# SPDX-License-Identifier: Apache-2.0
"""The rule `wrong-goal-id`, which wrong_goal_id.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import first_in
from roaml.expr.infer import constant
from roaml.expr.tree import access_path
from roaml.model.behavior.explore import Behavior, BehaviorStep, Fault, FaultKind
from roaml.model.behavior.knowledge import variables_in
from roaml.model.behavior.phases import Duty, DutyKind
from roaml.model.gaps import InterfaceAct
from roaml.model.machine import Assign, Chart, If, RosSend, Statement
from roaml.model.syntax import Expression
from roaml.model.system import Channel, System
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import behaviors, is_spelled, place
from roaml.rules.support.interfaces import declared
from roaml.text import TextEdit

_WHY = {
    FaultKind.REJECTED: "the goal whose id is in `{id}` was rejected; store the id of the accepted goal in another "
    "variable",
    FaultKind.EARLIER: "`{id}` holds the id of an earlier goal, not of the one that has just arrived; {advice}",
    FaultKind.UNDECIDED: "the goal whose id is in `{id}` has not been accepted; accept it first",
    FaultKind.OTHER: "`{id}` holds the id of a goal of another action; use the `goal_id` that the goal arrived with",
    FaultKind.FOREIGN: "`{id}` is set to `{source}`, which is not the id of a goal; {advice}",
    FaultKind.UNSTORED: "no goal id was stored in `{id}` before; store `_action.goal_id` in it where the goal is "
    "handled",
}
"""The kind of a fault -> the reason in the message. If several kinds apply to one element, the first is reported: it is
the most specific."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report answers whose goal id differs from the id with which the goal arrived. These answers reach another client,
    or no client."""
    for behavior in behaviors(context):
        reported: set[tuple[str, FaultKind]] = set()
        for step, fault in _faults(behavior).values():
            statement = fault.statement
            if fault.kind is FaultKind.UNDECIDED and not is_spelled(context, Duty(DutyKind.GOAL, fault.duty.handle)):
                continue
            assert isinstance(statement, RosSend)
            assert statement.goal_id is not None
            variable = statement.goal_id.text.strip()
            if (variable, fault.kind) not in reported:
                reported.add((variable, fault.kind))
                yield _finding(context, step, fault, statement, variable)
    yield from _constants(context)


def _faults(behavior: Behavior) -> dict[Statement, tuple[BehaviorStep, Fault]]:
    """For each element that names a wrong goal, the most specific fault, with a step in which it happens."""
    order = list(_WHY)
    fault_of: dict[Statement, tuple[BehaviorStep, Fault]] = {}
    for step in behavior.steps:
        for fault in step.faults:
            if fault.kind not in _WHY or (behavior.approximate and not fault.certain):
                continue
            known = fault_of.get(fault.statement)
            if known is None or order.index(fault.kind) < order.index(known[1].kind):
                fault_of[fault.statement] = (step, fault)
    return fault_of


def _finding(context: MachineContext, step: BehaviorStep, fault: Fault, statement: RosSend, variable: str) -> Finding:
    advice = "use the variable in which `_action.goal_id` is stored"
    if fault.kind is FaultKind.EARLIER:
        advice = (
            f"use `{fault.source}` as `goal_id`"
            if fault.source
            else "store `_action.goal_id` in a variable, and use that"
        )
    why = _WHY[fault.kind].format(id=variable, source=fault.source, advice=advice)
    message = f"`<{statement.element.name}>` names the wrong goal: {why}"
    where = statement.element.name_span
    if fault.kind is FaultKind.UNSTORED:  # the mistake is on the path to the statement
        where = place(step.handler, statement)
    related = [Related(step.handler.element.name_span, "executed here")]
    return RULE.at(where, message, *_fixes(context, step, fault, statement), related=related)


def _fixes(context: MachineContext, step: BehaviorStep, fault: Fault, statement: RosSend) -> Iterator[Fix]:
    assert statement.goal_id is not None
    if fault.kind is FaultKind.UNSTORED:
        yield from _store(context, step, statement.goal_id.text.strip())
    elif fault.kind is FaultKind.EARLIER and fault.source:
        edit = TextEdit(statement.goal_id.span, fault.source)
        yield Fix(f"Use `{fault.source}` as `goal_id`", (edit,), preferred=False)


# ------------------------------------------------------------------- constants


def _constants(context: MachineContext) -> Iterator[Finding]:
    """Report each constant `goal_id` that cannot be the id of all goals of the action: it is the id of no client, or of
    only one of several clients (docs/spec/ros.md#goal-ids)."""
    if context.system is None:
        return
    for declaration, _, channel in declared(context, SymbolKind.ACTION_SERVER):
        for chart in context.machine.charts:
            named: dict[float, list[RosSend]] = {}
            for statement in chart.statements:
                if isinstance(statement, RosSend) and statement.goal_id is not None:
                    value = constant(statement.goal_id.tree)
                    if value is not None and find_handle(context.machine, statement) is declaration:
                        named.setdefault(value, []).append(statement)
            for value, statements in named.items():
                why = _wrong_constant(context.system, channel, value)
                if why and not _tests_goal_ids(chart):
                    yield _constant_finding(statements, why)


def _constant_finding(statements: list[RosSend], why: str) -> Finding:
    first, *others = statements
    assert first.goal_id is not None
    subject = f"`<{first.element.name}>` has the constant `{first.goal_id.text.strip()}` as `goal_id`, {why}"
    advice = "store `_action.goal_id` in a variable where the goal is handled, and use that"
    related = [Related(statement.element.name_span, "also used here") for statement in others]
    return RULE.at(first.goal_id.span, f"{subject}; {advice}", related=related)


def _wrong_constant(system: System, channel: Channel, value: float) -> str:
    """The reason why a constant cannot be the id of all goals of an action, or an empty string if it can."""
    clients = [user.automaton.name for user in channel.users if ProtocolPart.GOAL in user.use.sends]
    if 0 <= value < len(channel.users) and value == int(value):
        if len(clients) < 2:
            return ""
        named = channel.users[int(value)].automaton.name
        return f"which is always the id of `{named}`, but `{channel.name}` has {len(clients)} clients"
    if not clients or system.may(InterfaceAct(SymbolKind.ACTION_CLIENT), channel.name):
        return ""
    ids = "the only id is 0" if len(channel.users) == 1 else f"the ids are 0 to {len(channel.users) - 1}"
    return f"which is not the id of any client of `{channel.name}`: {ids}"


def _tests_goal_ids(chart: Chart) -> bool:
    """Whether a condition reads the id of a goal, so that a constant may be right where the condition holds."""
    read = [h.cond.tree for state in chart.states for h in state.handlers if h.cond]
    stored = {"_action"}
    for statement in chart.statements:
        if isinstance(statement, If):
            read += [branch.cond.tree for branch in statement.branches if branch.cond]
        elif isinstance(statement, Assign) and statement.location:
            value = statement.value.tree if isinstance(statement.value, Expression) else None
            if value is not None and "_action" in variables_in((value,)):
                stored.update((access_path(statement.location.tree) or ())[:1])
    return not variables_in(read).isdisjoint(stored)


def _store(context: MachineContext, step: BehaviorStep, variable: str) -> Iterator[Fix]:
    element = step.handler.targets[step.choice].element or step.handler.element
    if (
        step.event is not None
        and step.event.part in (ProtocolPart.GOAL, ProtocolPart.THREAD_START)
        and element.complete
    ):
        edit = first_in(context.document, element, f'<assign location="{variable}" expr="_action.goal_id" />')
        yield Fix(f"Store the goal id in `{variable}`", (edit,))


RULE = Rule("wrong-goal-id", Severity.WARNING, "An answer names a goal by the wrong id.", machine=check, whole=True)
