# SPDX-License-Identifier: Apache-2.0
"""The rule `endless-node`, which endless_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.behavior.duties import backward
from roaml.model.behavior.explore import Behavior, BehaviorStep
from roaml.model.behavior.phases import Phase
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import behaviors, plugins
from roaml.rules.support.node_calls import statuses_at_halt


def check(context: MachineContext) -> Iterator[Finding]:
    """Report plugins that return RUNNING and then never SUCCESS or FAILURE, unless the tree can interrupt them."""
    automata = plugins(context)
    if not automata or context.system is None:
        return
    if any(Phase.RUNNING in statuses_at_halt(context.system, automaton) for automaton in automata):
        return
    for behavior in behaviors(context):
        if behavior.chart is context.machine.chart:
            yield from _endless(behavior)


def _endless(behavior: Behavior) -> Iterator[Finding]:
    steps = [step for step in behavior.steps if not (step.event and step.event.part is ProtocolPart.BT_HALT)]
    ending = {step.source for step in steps if behavior.configurations[step.target].tree is Phase.ENDED}
    endless = {n for n, c in enumerate(behavior.configurations) if c.tree is Phase.RUNNING} - backward(ending, steps)
    first = next((step for step in steps if step.target in endless and step.source not in endless), None)
    again = [step for step in steps if step.source in endless and _returns(behavior, step, endless)]
    if again and first is not None and first.handler is not again[0].handler:
        step = again[0]
        message = (
            "the plugin returns RUNNING here and never SUCCESS or FAILURE, so the node never ends; add a path that "
            "returns another status"
        )
        related = [Related(first.handler.element.name_span, "the node begins here")]
        yield RULE.at(step.handler.element.name_span, message, related=related)


def _returns(behavior: Behavior, step: BehaviorStep, endless: set[int]) -> bool:
    return step.event is not None and step.event.part is ProtocolPart.BT_TICK and step.target in endless


RULE = Rule("endless-node", Severity.WARNING, "A plugin returns RUNNING for ever.", machine=check, whole=True)
