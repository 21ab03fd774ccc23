# SPDX-License-Identifier: Apache-2.0
"""The rule `unanswered-halt`, which unanswered_halt.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import halts, last_in
from roaml.language import HL_SCXML
from roaml.model.behavior.explore import Behavior
from roaml.model.behavior.phases import HALT, Phase
from roaml.model.machine import State
from roaml.model.system import SystemAutomaton
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support import misspelled
from roaml.rules.support.answers import (
    OpenPath,
    answered,
    behaviors,
    is_spelled,
    missed,
    plugins,
    running_without,
    unhandled_states,
)
from roaml.xml_syntax import Element


def check(context: MachineContext) -> Iterator[Finding]:
    """Report plugins that do not confirm a halt: their parent waits for ever
    (docs/spec/plugins.md#protocol)."""
    halted = list(_halted(context))
    if not halted:
        return
    plugin, parent = halted[0][0].outline.plugin, halted[0][1].outline.name
    root, name = context.machine.element, context.machine.name
    if not plugin.halted:
        if root.complete and not misspelled.is_hidden(root, "bt_halt", HL_SCXML):
            message = f"the plugin has no `<bt_halt>`, but `{parent}` halts it; add a `<bt_halt>` to its states"
            yield RULE.at(name.span if name else root.name_span, message, *_add_handlers(context, root))
        return
    if not is_spelled(context, HALT):
        return
    for behavior in behaviors(context):
        if behavior.chart is context.machine.chart:
            yield from _missed(context, behavior)
            yield from _not_taken(context, behavior, [automaton for automaton, _ in halted])


def _halted(context: MachineContext) -> Iterator[tuple[SystemAutomaton, SystemAutomaton]]:
    """The nodes of the plugin whose parent halts its children, each with this parent."""
    for automaton in plugins(context):
        number = automaton.instance.parent if automaton.instance else None
        parent = context.system.by_instance.get(number) if context.system and number is not None else None
        if parent is not None and parent.outline.plugin.halts_children:
            yield automaton, parent


def _missed(context: MachineContext, behavior: Behavior) -> Iterator[Finding]:
    for path in missed(context, behavior, HALT):
        lines, title = ("<bt_return_halted />",), "Add `<bt_return_halted />`"
        fixes = answered(context, path, behavior, title, lines, preferred=True)
        yield RULE.at(path.span, _message(path), *fixes, severity=path.severity, related=path.related)


def _message(path: OpenPath) -> str:
    if path.step.ignored:
        reason = f"{path.dropped}, so the halt is never confirmed,"
        tag = f"<{path.step.handler.element.name}>"
        return f"{reason} and the tree waits for ever; add a `{tag}` without `cond` after it"
    where = (
        "a halt that is handled here" if path.receives else f"the halt that arrived in the state `{path.received_in}`"
    )
    how = "is not confirmed on every path" if path.choice or not path.certain else "is never confirmed"
    when = f" {path.order}" if path.order else ""
    return f"{where} {how}{when}, so the tree waits for ever; send one `<bt_return_halted>` on every path"


def _not_taken(context: MachineContext, behavior: Behavior, automata: list[SystemAutomaton]) -> Iterator[Finding]:
    """Report the states without `<bt_halt>` in which the plugin waits."""
    reported: set[str] = set()
    for waiting in unhandled_states(context, behavior, automata, HALT):
        reported.add(waiting.name)
        if waiting.needs_time:
            message = (
                f"a halt that arrives in the state `{waiting.name}` is not handled before time has passed, but the "
            )
            message += "clock waits until it is confirmed; add a `<bt_halt>`"
        else:
            how = "while the plugin is running " if waiting.tree_status is Phase.RUNNING else ""
            message = f"a halt that arrives {how}in the state `{waiting.name}` is never handled, so the tree waits for "
            message += "ever; add a `<bt_halt>`"
        fixes = _add_handler(context, waiting.state)
        yield RULE.at(waiting.span, message, *fixes, severity=Severity.WARNING)
    for state in running_without(behavior, ProtocolPart.BT_HALT):
        if state.id is not None and state.id.value not in reported:
            message = (
                f"the plugin is running in the state `{state.id.value}`, which does not handle a halt, unlike its "
                "other states; if a node above it interrupts it, the tree waits until the state is left; "
                "add a `<bt_halt>`"
            )
            yield RULE.at(state.id.span, message, *_add_handler(context, state), severity=Severity.WARNING)


def _add_handlers(context: MachineContext, root: Element) -> Iterator[Fix]:
    edits = halts(context.document, root, root.elements)
    if edits:
        yield Fix("Add `<bt_halt>` to every state with `<bt_tick>`", edits)


def _add_handler(context: MachineContext, state: State) -> Iterator[Fix]:
    initial = context.machine.chart.initial
    if initial is not None and state.element.complete:
        lines = (f'<bt_halt target="{initial.value}">', "    <bt_return_halted />", "</bt_halt>")
        yield Fix("Add `<bt_halt>`", (last_in(context.document, state.element, *lines),))


RULE = Rule(
    "unanswered-halt",
    Severity.ERROR,
    "A halt is not handled or not confirmed on every path.",
    machine=check,
    whole=True,
)
