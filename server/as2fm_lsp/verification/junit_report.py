# SPDX-License-Identifier: Apache-2.0
"""The results of a verification as a JUnit report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from as2fm_lsp import junit
from as2fm_lsp.junit import Case, CaseOutcome
from as2fm_lsp.verification import stuck_report
from as2fm_lsp.verification.report import one_as_text, warning
from as2fm_lsp.verification.stuck_report import NOT_STUCK
from roaml.record import replace
from roaml.verification.expectations import NO_EXPECTATION
from roaml.verification.results import Refused, Result, Undecided
from roaml.verification.stuck import StuckLevel, StuckResult

if TYPE_CHECKING:
    from roaml.views.story import PlaceOf


def as_junit(results: Sequence[Result], title: str, place_of: PlaceOf, stuck_result: StuckResult | None = None) -> str:
    """A JUnit report with a test for each property. A test fails if an expectation does not hold, is an error if
    there is no result, and is skipped if there is no expectation. With `stuck_result`, one more test fails if the
    system gets stuck and that is reported as an error."""
    level = StuckLevel.WARNING if stuck_result is None else stuck_result.level
    cases = [_case(result, title, one_as_text(result, place_of, level)) for result in results]
    if stuck_result is not None:
        outcome = CaseOutcome.PASSED if stuck_result.is_met else CaseOutcome.FAILED
        cases.append(
            Case(
                title,
                NOT_STUCK,
                outcome,
                stuck_report.as_text(stuck_result, place_of),
                "" if stuck_result.is_met else "stuck",
            )
        )
    return junit.render("verify", cases)


def _case(result: Result, title: str, text: str) -> Case:
    properties = [("requirement", result.comment)] if result.comment else []
    properties += [(f"expected {v.expectation.text}", v.text) for v in result.verdicts if v.is_uniform or v.sampled]
    if about := warning(result):
        properties.append(("warning", about))
    case = Case(title, result.name, CaseOutcome.PASSED, text, "", "", result.seconds, tuple(properties))
    match result.outcome:
        case Refused(reason=refusal):
            return replace(case, outcome=CaseOutcome.ERROR, message=refusal.message, type=refusal.code)
        case Undecided(reason=reason):
            return replace(case, outcome=CaseOutcome.ERROR, message=f"undecided: {reason}", type="undecided")
        case _:
            pass
    if result.has_no_expectation:
        return replace(case, outcome=CaseOutcome.SKIPPED, message=NO_EXPECTATION)
    if result.is_met:
        return case
    if result.is_undecided:
        message = "; ".join(
            f"expected {v.expectation.text}: {v.explained(result.epsilon)}" for v in result.verdicts if not v.is_met
        )
        return replace(case, outcome=CaseOutcome.ERROR, message=message, type="undecided")
    missed = [verdict.expectation.text for verdict in result.verdicts if not verdict.is_met]
    return replace(case, outcome=CaseOutcome.FAILED, message=f"expected {' and '.join(missed)}")
