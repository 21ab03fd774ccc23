# SPDX-License-Identifier: Apache-2.0
"""unanswered-halt: see unanswered_halt.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language import HL_SCXML
from roaml.model.system import Automaton
from roaml.rules import misspelled, removed_bt_event
from roaml.rules.rule import MachineContext, Rule
from roaml.text import LineIndex, Span, TextEdit
from roaml.xml import Element


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
            yield RULE.at(span, message, *_add_handlers(root, context.source.lines, context.source.text))
    elif not plugin.answers_halt and not misspelled.among(elements, "bt_return_halted", HL_SCXML):
        message = f"the plugin never answers a halt, but `{parent}` halts it: it has no `<bt_return_halted>`"
        yield RULE.at(span, message, *_answer(root, context.source.lines, context.source.text))


def _halted(context: MachineContext) -> Iterator[tuple[Automaton, Automaton]]:
    """What the plugin is in the tree, with the parent, if that halts its children."""
    for automaton in context.automata:
        number = automaton.instance.parent if automaton.instance else None
        parent = context.system.by_instance.get(number) if context.system and number is not None else None
        if parent is not None and parent.outline.plugin.halts_children:
            yield automaton, parent


def _add_handlers(root: Element, lines: LineIndex, text: str) -> Iterator[Fix]:
    """Add a `<bt_halt>` that goes to the initial state to each state that takes ticks."""
    initial = root.get("initial")
    edits = []
    for state in root.elements:
        ticks = [child for child in state.elements if child.name == "bt_tick"]
        if state.name == "state" and ticks and initial:
            at, indent = ticks[-1].span.end, _indent(ticks[-1], lines, text)
            new = f'\n{indent}<bt_halt target="{initial.value}">\n{indent}    <bt_return_halted />\n{indent}</bt_halt>'
            edits.append(TextEdit(Span(at, at), new))
    if edits:
        yield Fix("Add `<bt_halt>` to every state that takes ticks", tuple(edits))


def _answer(root: Element, lines: LineIndex, text: str) -> Iterator[Fix]:
    """Add a `<bt_return_halted />` to each `<bt_halt>` without content of its own."""
    edits = []
    for element in root.walk():
        if element.name == "bt_halt" and not element.elements and element.complete:
            indent = _indent(element, lines, text)
            start = element.open_span.end - (2 if element.self_closing else 1)
            new = f">\n{indent}    <bt_return_halted />\n{indent}</bt_halt>"
            edits.append(TextEdit(Span(start, element.span.end), new))
    if edits:
        yield Fix("Add `<bt_return_halted />`", tuple(edits))


def _indent(element: Element, lines: LineIndex, text: str) -> str:
    """The white space before an element that begins its line."""
    start = lines.line_start(lines.position(element.span.start).line)
    before = text[start : element.span.start]
    return "" if before.strip() else before


RULE = Rule("unanswered-halt", Severity.ERROR, "A plugin cannot answer a halt that its parent sends.", machine=check)
