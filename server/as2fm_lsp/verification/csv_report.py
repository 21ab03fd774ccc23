# SPDX-License-Identifier: Apache-2.0
"""Results as CSV, for spreadsheets and scripts."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from as2fm_lsp.verification.report import conditional_texts, warning
from as2fm_lsp.verification.scheduler_report import OTHERS
from roaml.experiments.results import csv_text
from roaml.smc.lss import Side
from roaml.verification.headline import UNDECIDED, headline
from roaml.verification.results import Estimated, Refused, Result, Sampled, Undecided

COLUMNS = (
    "property", "kind", "value", "low", "high", "minimum", "maximum", "uniform", "traces", "passed", "failed",
    "undecided", "stuck", "states", "expected", "met", "seconds", "note",
)  # fmt: skip


def as_csv(results: Iterable[Result]) -> str:
    """A row for each property. `value` is the one for which the property asks, or the estimate under uniform choices;
    `low` and `high` are the bounds of an exact value, or the interval of an estimate. `note` is why there is no
    value, or what restricts it: what is known for all schedulers, values under assumptions, warnings."""
    return csv_text(COLUMNS, map(_row, results))


def _row(result: Result) -> dict[str, Any]:
    row: dict[str, Any] = {"property": result.name, "kind": UNDECIDED, "seconds": round(result.seconds, 3)}
    if result.verdicts:
        row["expected"] = "; ".join(verdict.expectation.text for verdict in result.verdicts)
        row["met"] = "true" if result.is_met else "false"
    answer, exact = result.answer, result.exact
    if answer is not None:
        tally = answer.tally
        row |= {"traces": tally.traces, "passed": tally.successes, "undecided": tally.undecided}
        row["failed"] = tally.traces - tally.successes - tally.undecided
        row["stuck"] = 0 if result.stuck is None else result.stuck.count
        if not answer.is_unknown and not math.isnan(answer.value):
            row |= {"kind": "estimate", "value": answer.value, "low": answer.bounds.lower, "high": answer.bounds.upper}
    asked = result.asked_value()
    if exact is not None and asked is not None:
        bounds, value = asked
        row |= {"kind": "exact", "value": value, "low": bounds.lower, "high": bounds.upper, "states": exact.states}
        row |= {"minimum": exact.least, "maximum": exact.greatest, "uniform": exact.average}
    match result.outcome:
        case Refused(reason=reason):
            row["note"] = reason.message
        case Undecided(reason=reason):
            row["note"] = reason
        case Sampled(extremes=extremes, tried=tried):
            for extreme in extremes:
                row["minimum" if extreme.side is Side.LEAST else "maximum"] = extreme.answer.value
            row |= {
                "kind": "sampled schedulers",
                "note": f"{tried:,} schedulers were tried; {OTHERS}",
            }
        case _:
            is_given = isinstance(result.outcome, Estimated) and result.outcome.answer.question.is_conditional
            notes = (
                "under uniform choices" if is_given else "",
                headline(result).claim,
                *conditional_texts(result),
                warning(result),
            )
            row["note"] = "; ".join(filter(None, notes))
    return row
