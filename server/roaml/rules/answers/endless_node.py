# SPDX-License-Identifier: Apache-2.0
"""The rule `endless-node`, which endless_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.edit.elements import rename_tag
from roaml.expr.operators import OperatorKind
from roaml.expr.tree import Binary
from roaml.forest.statuses import statuses_of
from roaml.model.behavior.duties import backward, forward
from roaml.model.behavior.explore import Behavior, BehaviorStep
from roaml.model.behavior.phases import Phase, ProtocolEvent
from roaml.model.machine import Handler, ReturnStatus, State
from roaml.model.values.domain import TRUE
from roaml.model.values.evaluate import compared
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule, TreeContext
from roaml.rules.support.answers import behaviors, plugins
from roaml.rules.support.compared_numbers import reached
from roaml.rules.support.constant_conditions import because, values_in
from roaml.rules.support.forest import trees_of
from roaml.rules.support.node_calls import statuses_at_halt


def check(context: MachineContext) -> Iterator[Finding]:
    """Report plugins that return RUNNING and then never SUCCESS or FAILURE. If the tree can interrupt them, only those
    are reported that have returned RUNNING with the prospect of another status before, and have none after a halt
    either: a plugin that always returns RUNNING works until it is halted."""
    automata = plugins(context)
    if not automata or context.system is None:
        return
    yield from _always_running(context)
    halted = any(Phase.RUNNING in statuses_at_halt(context.system, automaton) for automaton in automata)
    for behavior in behaviors(context):
        if behavior.chart is context.machine.chart:
            yield from _endless(behavior, halted)


def _always_running(context: MachineContext) -> Iterator[Finding]:
    """Report the condition with which a plugin returns RUNNING at each tick, as `level < enough`, if it always holds
    for the values of the ports and for what the machines of the system send, and nothing else ends the wait."""
    for chart in context.machine.charts:
        values = context.values.charts.get(chart.scope)
        for state in chart.states if values is not None else ():
            for handler in state.handlers:
                cond = handler.cond
                if cond is None or values is None or not _waits(state, handler):
                    continue
                tree = cond.tree
                sides = [values.at(side) for side in (tree.left, tree.right)] if isinstance(tree, Binary) else []
                known = [reached(side) for side in sides if side is not None]
                if not isinstance(tree, Binary) or len(known) < 2 or tree.operator.kind is not OperatorKind.ORDER:
                    continue
                is_counted = all(side.value is not None for side in known)
                if not is_counted and compared(tree.operator, known[0], known[1]) == TRUE:
                    message = (
                        f"this condition is always true{because(values_in(values, tree))}, so the plugin returns "
                        "RUNNING for ever; check the limit, and what is compared with it"
                    )
                    yield RULE.at(cond.span, message)


def _waits(state: State, handler: Handler) -> bool:
    """Whether a handler returns RUNNING in a state that only a later handler of a tick, or a halt, leaves."""
    if handler.trigger is not ProtocolPart.BT_TICK or handler.cond is None or handler.cond.broken:
        return False
    statuses = [s.status.value for t in handler.targets for s in t.body if isinstance(s, ReturnStatus) and s.status]
    if statuses != ["RUNNING"] or _leaves(state, handler):
        return False
    leaving = [other for other in state.handlers if other.effective and _leaves(state, other)]
    triggers = {other.trigger for other in leaving} - {ProtocolPart.BT_HALT}
    later = state.handlers[state.handlers.index(handler) + 1 :]
    return triggers == {ProtocolPart.BT_TICK} and all(
        other in later for other in leaving if other.trigger is ProtocolPart.BT_TICK
    )


def _leaves(state: State, handler: Handler) -> bool:
    own = state.id.value if state.id is not None else ""
    return any(target.state is None or target.state.value != own for target in handler.targets)


def _endless(behavior: Behavior, halted: bool) -> Iterator[Finding]:
    steps = [step for step in behavior.steps if halted or not (step.event and step.event.part is ProtocolPart.BT_HALT)]
    phases = [configuration.tree for configuration in behavior.configurations]
    status = ProtocolEvent(ProtocolPart.BT_STATUS, "")
    ending = {step.source for step in steps if phases[step.target] is Phase.ENDED and status in step.sent}
    endless = {n for n, phase in enumerate(phases) if halted or phase is Phase.RUNNING} - backward(ending, steps)
    if halted:
        # A variable that keeps its value, such as that of a port, may decide that a plugin runs until it is halted.
        left = {c.state for n, c in enumerate(behavior.configurations) if n not in endless}
        endless = {n for n in endless if behavior.configurations[n].state not in left}
    inside = [step for step in steps if step.source in endless]
    again = [step for step in inside if _returns(behavior, step, endless)]
    entering = [step for step in steps if step.target in endless and step.source not in endless]
    turning = next((s for s in entering if phases[s.source] is Phase.RUNNING and _then(s, inside, again)), None)
    if turning is not None:
        message = (
            "after this, the plugin returns RUNNING at each tick and never SUCCESS or FAILURE, so the node never ends; "
            "go on to a state that returns another status"
        )
        related = [Related(_then(turning, inside, again)[0].handler.element.name_span, "RUNNING is returned here")]
        yield RULE.at(turning.handler.element.name_span, message, related=related)
    elif again and entering and entering[0].handler is not again[0].handler:
        message = (
            "the plugin returns RUNNING here and never SUCCESS or FAILURE, so the node never ends; add a path that "
            "returns another status"
        )
        related = [Related(entering[0].handler.element.name_span, "the node begins here")]
        yield RULE.at(again[0].handler.element.name_span, message, related=related)


def in_tree(context: TreeContext) -> Iterator[Finding]:
    """Report nodes that continue with a child that returns RUNNING for ever, instead of ticking the children before it
    again."""
    forest = trees_of(context)
    if forest is None or context.system is None:
        return
    used = {name for names in forest.subtrees.values() for name in names}
    for tree in context.file.trees:
        if len(tree.roots) == 1 and (tree.id is None or tree.id.value not in used):
            for child, node in statuses_of(forest).endless(tree.roots[0]):
                name, reactive = node.element.name, f"Reactive{node.element.name}"
                if name not in ("Fallback", "Sequence"):
                    continue
                message = (
                    f"`{child.element.name}` returns RUNNING for ever, and `{name}` does not tick the children before "
                    f"it again, so no other node is ticked from then on; use `{reactive}`"
                )
                related = [Related(child.element.name_span, "never ends")]
                yield RULE.at(node.element.name_span, message, rename_tag(node.element, reactive), related=related)


def _then(step: BehaviorStep, inside: list[BehaviorStep], again: list[BehaviorStep]) -> list[BehaviorStep]:
    """The steps of `again` that can be taken after `step`."""
    reached = forward({step.target}, inside)
    return [other for other in again if other.source in reached]


def _returns(behavior: Behavior, step: BehaviorStep, endless: set[int]) -> bool:
    return step.event is not None and step.event.part is ProtocolPart.BT_TICK and step.target in endless


RULE = Rule(
    "endless-node", Severity.WARNING, "A plugin returns RUNNING for ever.", machine=check, tree=in_tree, whole=True
)
