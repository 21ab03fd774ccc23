# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-element`, which repeated_element.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.edit.elements import remove
from roaml.language import BEHAVIOR_TREE
from roaml.language.validate import TooManyElements
from roaml.rules.rule import FileContext, MachineContext, Rule
from roaml.rules.support.children import has_counted_children
from roaml.rules.support.elements import own_elements
from roaml.xml_syntax import Document, Element

ONCE: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("ascxml", "scxml", "ros_action_thread"), ("datamodel",)),
    **dict.fromkeys(("assign", "param", "field"), ("expr",)),
    **dict.fromkeys(("ros_topic_publisher", "ros_topic_subscriber"), ("topic",)),
    **dict.fromkeys(("ros_service_client", "ros_service_server"), ("service_name",)),
    **dict.fromkeys(("ros_action_client", "ros_action_server"), ("action_name",)),
    "ros_time_rate": ("rate_hz",),
    "state": ("onentry", "onexit"),
    "data": ("expr", "lower_bound_incl", "upper_bound_incl"),
}


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if isinstance(violation, TooManyElements) and not has_counted_children(violation.parent):
            name, parent = violation.element.name, violation.parent.name
            message = f"`<{parent}>` allows only one `<{name}>`"
            if context.grammar is BEHAVIOR_TREE:
                most = {0: "no children", 1: "one child"}.get(violation.most, f"{violation.most} children")
                message = f"`<{parent}>` allows only {most}"
            first = Related(violation.first.name_span, f"the first is this `<{violation.first.name}>`")
            fixes = [remove(context.document, violation.element, f"Remove this `<{name}>`")] if context.document else []
            yield RULE.at(violation.element.name_span, message, *fixes, related=(first,) if violation.most else ())


def check_machine(context: MachineContext) -> Iterator[Finding]:
    """Check children whose number the schema cannot limit, because it allows children in any order."""
    for element, children in _families(context.document):
        for name in ONCE.get(element.name, ()):
            same = [child for child in children if child.name == name]
            for other in same[1:]:
                related = (Related(same[0].name_span, f"the first is this `<{name}>`"),)
                message = f"`<{element.name}>` allows only one `<{name}>`"
                again = remove(context.document, other, f"Remove this `<{name}>`")
                yield RULE.at(other.name_span, message, again, related=related)


def _families(document: Document) -> Iterator[tuple[Element, list[Element]]]:
    """Every element of a document with its children. Elements of other namespaces are left out."""
    for element in own_elements(document):
        yield element, [child for child in element.elements if not child.is_foreign]


RULE = Rule(
    "repeated-element",
    Severity.ERROR,
    "An element occurs more often than allowed.",
    file=check,
    machine=check_machine,
)
