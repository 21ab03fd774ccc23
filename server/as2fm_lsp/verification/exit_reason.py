# SPDX-License-Identifier: Apache-2.0
"""Which exit status follows from results that do not decide what is expected, and why
(docs/verification.md#exit-status)."""

from __future__ import annotations

from collections.abc import Sequence

from roaml.verification.expectations import Verdict
from roaml.verification.results import Result

_NO_VALUE, _MISSED = "no value", "not met"
_OPEN, _DOUBTED, _DOUBTFUL = _UNDECIDED = (
    "undecided, because it depends on the undecided traces",
    "undecided, and the estimate does not meet it",
    "undecided, but the estimate meets it",
)
"""The reasons for an exit status."""


def exit_reason(results: Sequence[Result], status: int) -> list[str]:
    """A line for users; empty if all expectations are decided and all properties have values, so that the results
    themselves explain the status.

    Args:
        status: the exit status.
    """
    if status > 1:  # the work was interrupted
        return []
    groups: dict[str, dict[str, None]] = {what: {} for what in (_NO_VALUE, _MISSED, *_UNDECIDED)}
    for result in results:
        if not result.has_answer or (result.verdicts and result.answer is not None and not result.answer.tally.traces):
            groups[_NO_VALUE][result.name] = None
            continue
        for verdict in result.verdicts:
            if what := _group_of(verdict):
                groups[what][result.name] = None
    if not any(groups[what] for what in (_NO_VALUE, *_UNDECIDED)):
        return []
    why = "; ".join(f"{what}: {', '.join(names)}" for what, names in groups.items() if names)
    return [f"exit status {status} ({why})"]


def _group_of(verdict: Verdict) -> str:
    """The reason for a status to which a verdict belongs; "" if it is met."""
    if not verdict.is_undecided:
        return "" if verdict.is_met else _MISSED
    return _OPEN if verdict.is_open else _DOUBTFUL if verdict.is_met else _DOUBTED
