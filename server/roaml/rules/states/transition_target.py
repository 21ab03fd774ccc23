# SPDX-License-Identifier: Apache-2.0
"""The rule `transition-target`, which transition_target.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.language import HL_SCXML
from roaml.language.validate import misspelled_attribute
from roaml.model.machine import Handler
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Element


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.trigger is not ProtocolPart.GOAL_RESPONSE and handler.effective:
                    here = state.id.value if state.id else ""
                    children = [child for child in handler.element.elements if not child.is_foreign]
                    yield from _check(handler, children, here)


def _check(handler: Handler, children: list[Element], here: str) -> Iterator[Finding]:
    element = handler.element
    attribute = element.get("target")
    targets = [child for child in children if child.name == "target"]
    if attribute is not None and targets:
        related = (Related(attribute.name_span, "the attribute"),)
        yield RULE.at(
            targets[0].name_span,
            "the target is given twice, as an attribute and as a child; remove one of them",
            related=related,
        )
    elif attribute is None and not targets:
        if not misspelled_attribute(element, "target", handler.type.attributes):
            at = element.name_span.end
            fixes = [Fix(f"Stay in `{here}`", (TextEdit(Span(at, at), f' target="{here}"'),))] if here else []
            message = f"`<{element.name}>` needs a target; to stay in the state, name the state itself"
            yield RULE.at(element.name_span, message, *fixes)
    elif targets:
        beside = next((child for child in children if child.name in HL_SCXML.groups["Executable"]), None)
        if beside is not None:
            message = f"`<{beside.name}>` is not allowed beside `<target>`; move it into each `<target>` that needs it"
            yield RULE.at(beside.name_span, message)


RULE = Rule("transition-target", Severity.ERROR, "A transition has no target or two targets.", machine=check)
