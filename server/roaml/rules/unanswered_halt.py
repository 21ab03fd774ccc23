# SPDX-License-Identifier: Apache-2.0
"""unanswered-halt: see unanswered_halt.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language import HL_SCXML
from roaml.model.system import Automaton
from roaml.rules import misspelled, removed_bt_event
from roaml.rules.layout import after, last_in
from roaml.rules.rule import MachineContext, Rule
from roaml.text import TextEdit
from roaml.xml import Document, Element


def check(context: MachineContext) -> Iterator[Finding]:
    """A plugin whose parent halts it must answer, or the parent waits for ever (spec/01 §11.2)."""
    found = next(_halted(context), None)
    if found is None or removed_bt_event.is_used(context.machine):
        return
    plugin, parent = found[0].outline.plugin, found[1].outline.name
    root, name = context.machine.element, context.machine.name
    span = name.span if name else root.name_span
    elements = list(root.walk())
    if not plugin.halted:
        if not misspelled.among(elements, "bt_halt", HL_SCXML):
            message = f"the plugin takes no halts, but `{parent}` halts it: it has no `<bt_halt>`"
            yield RULE.at(span, message, *_add_handlers(context, root))
    elif not plugin.answers_halt and not misspelled.among(elements, "bt_return_halted", HL_SCXML):
        message = f"the plugin never answers a halt, but `{parent}` halts it: it has no `<bt_return_halted>`"
        yield RULE.at(span, message, *_answer(context, root))


def _halted(context: MachineContext) -> Iterator[tuple[Automaton, Automaton]]:
    """What the plugin is in the tree, with the parent, if that halts its children."""
    for automaton in context.automata:
        number = automaton.instance.parent if automaton.instance else None
        parent = context.system.by_instance.get(number) if context.system and number is not None else None
        if parent is not None and parent.outline.plugin.halts_children:
            yield automaton, parent


def _add_handlers(context: MachineContext, root: Element) -> Iterator[Fix]:
    edits = halts(context.document, root, root.elements)
    if edits:
        yield Fix("Add `<bt_halt>` to every state that takes ticks", edits)


def halts(document: Document, root: Element, states: Iterable[Element]) -> tuple[TextEdit, ...]:
    """Add a `<bt_halt>` that goes to the initial state to each of some states that takes ticks and no halts."""
    initial = root.get("initial")
    edits = []
    for state in states:
        ticks = [child for child in state.elements if child.name == "bt_tick"]
        if state.name == "state" and ticks and initial and state.find("bt_halt") is None:
            halt = (f'<bt_halt target="{initial.value}">', "    <bt_return_halted />", "</bt_halt>")
            edits.append(after(document, ticks[-1], *halt))
    return tuple(edits)


def _answer(context: MachineContext, root: Element) -> Iterator[Fix]:
    """Add a `<bt_return_halted />` to each `<bt_halt>`."""
    halts = [element for element in root.walk() if element.name == "bt_halt" and element.complete]
    if halts:
        edits = tuple(last_in(context.document, halt, "<bt_return_halted />") for halt in halts)
        yield Fix("Add `<bt_return_halted />`", edits)


RULE = Rule("unanswered-halt", Severity.ERROR, "A plugin cannot answer a halt that its parent sends.", machine=check)
