# SPDX-License-Identifier: Apache-2.0
"""The rule `probability-sum`, which probability_sum.md describes."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal, InvalidOperation

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.model.machine import Handler, Target
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.impossible_targets import ImpossibleTarget
from roaml.text import Span

TOLERANCE = Decimal("0.001")


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.targets[0].element is not None:
                    yield from _check(handler, context.source.text)


def _check(handler: Handler, text: str) -> Iterator[Finding]:
    total = Decimal(0)
    given = [target for target in handler.targets if target.probability is not None]
    last = handler.targets[-1]
    for target in handler.targets:
        assert target.element is not None
        if target.probability is None:
            if target is not last and target.element.get("prob") is None:
                yield RULE.at(target.element.name_span, "only the last `<target>` may omit `prob`")
                return
            continue
        value = _decimal(target.probability.value)
        if value is None:
            return  # reported by invalid-value
        total += value
    if not given or any(t.probability is None and t.element and t.element.get("prob") for t in handler.targets):
        return  # nothing to add up, or an empty value, which invalid-value reports
    span = _span(given)
    if last.probability is None:
        if total >= 1:
            message = f"the probabilities before the last target add up to {total}, so it would never be chosen"
            yield RULE.at(span, message, facts=ImpossibleTarget() if total == 1 else None)
    elif len(given) == 1 and total != 1:
        message = f"the only target has the probability 1, not {total}; remove `prob`"
        yield RULE.at(span, message, *_leave_out(last, text, "Remove `prob`", preferred=True))
    elif abs(total - 1) > TOLERANCE:
        rest = 0 < total - (_decimal(last.probability.value) or 0) < 1
        fixes = (
            _leave_out(last, text, "Give the last target the remaining probability", preferred=False) if rest else ()
        )
        yield RULE.at(span, f"the probabilities add up to {total}, not 1", *fixes)


def _span(given: list[Target]) -> Span:
    """The span from the first probability to the last one."""
    spans = [target.probability.span for target in given if target.probability]
    return spans[0].cover(spans[-1])


def _leave_out(target: Target, text: str, title: str, *, preferred: bool) -> Iterator[Fix]:
    attribute = target.element.get("prob") if target.element else None
    if attribute is not None:
        yield Fix(title, (removal(text, attribute.span),), preferred)


def _decimal(text: str) -> Decimal | None:
    try:
        value = Decimal(text)
    except InvalidOperation:
        return None
    return value if value.is_finite() and 0 <= value <= 1 else None


RULE = Rule(
    "probability-sum",
    Severity.ERROR,
    "The probabilities of targets do not add up to 1.",
    machine=check,
    facts=ImpossibleTarget,
)
