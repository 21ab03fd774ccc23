# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-element`, which missing_element.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import first_in, last_in, remove
from roaml.facts import Facts
from roaml.language import HL_SCXML
from roaml.language.validate import MissingElement
from roaml.model.machine import Chart, Thread
from roaml.rules.rule import FileContext, MachineContext, Rule
from roaml.rules.support import misspelled
from roaml.rules.support.children import has_counted_children
from roaml.text import Edit, Span, TextEdit
from roaml.xml_syntax import Element


class MissingChild(Facts, frozen=True):
    """The facts of a finding: the element `parent` lacks the required child `name`."""

    parent: str
    name: str


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if not isinstance(violation, MissingElement):
            continue
        element, child_count = violation.element, violation.type.any_child
        assert context.grammar is not None
        if child_count is None:
            if not misspelled.among(element.elements, violation.names[0], context.grammar):
                message = f"`<{element.name}>` needs {_with_article(violation.names[0])}"
                facts = MissingChild(element.name, violation.names[0])
                yield RULE.at(element.name_span, message, *_leave_out(context, element), facts=facts)
        elif not has_counted_children(violation.type):
            children = "a child" if child_count.least == 1 else f"at least {child_count.least} children"
            yield RULE.at(element.name_span, f"`<{element.name}>` needs {children}")


def check_machine(context: MachineContext) -> Iterator[Finding]:
    """Check children that the schema cannot require, because it allows children in any order."""
    for chart in context.machine.charts:
        element = chart.element
        states = any(child.name == "state" for child in element.elements)
        if element.complete and not states and not misspelled.among(element.elements, "state", HL_SCXML):
            message = f"`<{element.name}>` needs at least one `<state>`"
            yield RULE.at(element.name_span, message, *_add_state(context, chart))
    for thread in context.machine.threads:
        yield from _thread_data(context, thread)


def _thread_data(context: MachineContext, thread: Thread) -> Iterator[Finding]:
    """Report threads without a datamodel; a machine needs none (docs/spec/ros.md#threads)."""
    element = thread.element
    needs_datamodel = element.complete and element.find("datamodel") is None
    if needs_datamodel and not misspelled.among(element.elements, "datamodel", HL_SCXML):
        message = f"`<{element.name}>` needs a `<datamodel>`, even if it is empty"
        edit = first_in(context.document, element, "<datamodel />")
        yield RULE.at(element.name_span, message, Fix("Add an empty `<datamodel>`", (edit,), safe=True))


def _leave_out(context: FileContext, element: Element) -> Iterator[Fix]:
    """A fix that removes an element without content, if the element is optional."""
    root = context.document.root if context.document else None
    if context.document is None or root is None or context.grammar is None or element not in root.elements:
        return
    often = context.grammar.elements[root.name].children.get(element.name)
    if often is not None and often.least == 0 and not element.elements:
        yield remove(context.document, element, f"Remove the empty `<{element.name}>`")


def _add_state(context: MachineContext, chart: Chart) -> Iterator[Fix]:
    name = chart.initial.value if chart.initial else "initial"
    if chart.element.complete:
        edits: list[Edit] = [last_in(context.document, chart.element, f'<state id="{name}" />')]
        at = chart.element.name_span.end
        if chart.element.get("initial") is None and not chart.scope:
            edits.append(TextEdit(Span(at, at), f' initial="{name}"'))
        yield Fix(f"Add the state `{name}`", tuple(edits))


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'aeiou' else 'a'} `<{name}>`"


RULE = Rule(
    "missing-element",
    Severity.ERROR,
    "A required child element is missing.",
    file=check,
    machine=check_machine,
    facts=MissingChild,
)
