# SPDX-License-Identifier: Apache-2.0
"""The rule `not-in-reference`, which not_in_reference.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.rules.rule import MachineContext, Rule, SystemContext
from roaml.xml_syntax import Element

NEW_ELEMENTS = ("ros_action_cancel_goal", "ros_action_handle_cancel_goal")
"""The elements that the main branch of the reference translator does not read yet
(docs/spec/differences.md#accepted-machines)."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report the first use of each element of `NEW_ELEMENTS` in a file; the finding refers to the other uses."""
    places: dict[str, list[Element]] = {}
    for element in context.machine.element.walk():
        if element.name in NEW_ELEMENTS:
            places.setdefault(element.name, []).append(element)
    for name, (first, *others) in places.items():
        message = (
            f"AS2FM does not read `<{name}>` yet, because its main branch does not contain the element; "
            "check, verify and translate the model only with this tool"
        )
        yield RULE.at(
            first.name_span, message, related=[Related(other.name_span, "also used here") for other in others]
        )


def check_system(context: SystemContext) -> Iterator[Finding]:
    """Report the reaction time of a system."""
    element = context.file.parameter("max_time")
    attribute = element.get("reaction_time") if element is not None else None
    if attribute is not None:
        message = (
            "AS2FM ignores `reaction_time` and assumes the reaction time `any`, so both tools may compute different "
            "probabilities; only this tool reads the attribute"
        )
        yield RULE.at(attribute.name_span, message)


RULE = Rule(
    "not-in-reference",
    Severity.INFORMATION,
    "An element or attribute that AS2FM does not read is used.",
    machine=check,
    system=check_system,
)
