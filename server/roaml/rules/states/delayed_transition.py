# SPDX-License-Identifier: Apache-2.0
"""The rule `delayed-transition`, which delayed_transition.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.durations import NANOSECONDS, duration
from roaml.edit.elements import removal
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                after = handler.element.get("after")
                if after is None or handler.element.name != "transition":
                    continue
                timer = f'<ros_time_rate name="…" rate_hz="{_rate(after.value)}" />'
                message = f"`after` has no effect: transitions do not wait; declare the timer `{timer}`, and wait for"
                message += " it with a `<ros_rate_callback>`"
                remove = Fix("Remove the attribute", (removal(context.source.text, after.span),), preferred=False)
                severity = Severity.HINT if context.older else Severity.WARNING
                yield RULE.at(after.span, message, remove, severity=severity)


def _rate(text: str) -> str:
    """The rate in Hz of a timer whose period is a duration such as `5s`; `…` if the text is not a duration."""
    period = duration(text)
    return "…" if period is None else f"{NANOSECONDS['s'] / period:.6g}"


RULE = Rule("delayed-transition", Severity.WARNING, "A transition has a delay, which is ignored.", machine=check)
