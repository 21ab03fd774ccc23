# SPDX-License-Identifier: Apache-2.0
"""The rule `equal-branches`, which equal_branches.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.machine import If, Statement
from roaml.rules.rule import MachineContext, Rule
from roaml.text import Span
from roaml.xml_syntax import Element, Text


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, If) and statement.otherwise is not None:
                parts = (*statement.branches, statement.otherwise)
                if all(part.body for part in parts) and len({_content(part.body) for part in parts}) == 1:
                    message = "all branches of this `<if>` do the same, so its conditions have no effect"
                    yield from _alike(message, [part.body[0].element.name_span for part in parts])
        for handler in (handler for state in chart.states for handler in state.handlers):
            alike: dict[object, list[Span]] = {}
            for target in handler.targets if handler.is_probabilistic else ():
                if target.element is not None and target.state is not None:
                    place = target.body[0].element if target.body else target.element
                    key = (target.state.value, _content(target.body))
                    alike.setdefault(key, []).append(place.name_span)
            # Among other targets, the probabilities of several causes of the same outcome may be stated separately.
            severity = Severity.WARNING if len(alike) == 1 else Severity.INFORMATION
            for spans in alike.values():
                if len(spans) > 1:
                    message = (
                        "another `<target>` of this element has the same state and content, so one of them is enough"
                    )
                    yield from _alike(message, spans, severity)


def _alike(message: str, spans: Sequence[Span], severity: Severity = Severity.WARNING) -> Iterator[Finding]:
    for span in spans:
        related = [Related(other, "the same") for other in spans if other != span]
        yield RULE.at(span, f"{message}; change one of them, or merge them", related=related, severity=severity)


def _content(body: Sequence[Statement]) -> tuple[object, ...]:
    return tuple(_canonical(statement.element) for statement in body)


def _canonical(element: Element) -> tuple[object, ...]:
    """An element without its layout and comments."""
    attributes = tuple(sorted((attribute.name, attribute.value) for attribute in element.attributes))
    text = " ".join(node.value.strip() for node in element.nodes if isinstance(node, Text)).split()
    return (element.name, attributes, tuple(text), tuple(_canonical(child) for child in element.elements))


RULE = Rule(
    "equal-branches",
    Severity.WARNING,
    "All branches of an `<if>`, or two targets of a transition, do the same.",
    machine=check,
)
