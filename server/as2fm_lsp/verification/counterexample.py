# SPDX-License-Identifier: Apache-2.0
"""The shortest trace that shows why a property fails, as a story whose lines know their places."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from as2fm_lsp.verification.report import Result
from as2fm_lsp.verification.subject import Subject
from roaml.smc.goal import Asked
from roaml.smc.model import Checker
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.record import VERDICTS, Recorder
from roaml.smc.run import Options, Seen
from roaml.smc.story import tell
from roaml.text import Location
from roaml.views.story import Line, heading, lines


@dataclass(frozen=True, slots=True)
class Counterexample:
    """Attributes:
    heading: what happens, in one sentence.
    verdict: "failed", "passed" (where that is what must not be) or "undecided".
    """

    heading: str
    verdict: str
    trace: int
    lines: tuple[Line, ...]


def wanted_verdict(result: Result) -> int:
    """The verdict of the traces that speak against what is expected."""
    if result.answer is not None and result.answer.question.is_stuck:
        return TRUE
    expected = [verdict.expectation.threshold for verdict in result.verdicts]
    return TRUE if expected and not any(threshold.is_lower for threshold in expected) else FALSE


def speaking_against(result: Result) -> Seen | None:
    """The shortest trace that does; one that was not decided if there is none. If any trace got stuck, the shortest of
    these: it says why the number means little."""
    if result.answer is None:
        return None
    if result.stuck is not None:
        return result.stuck.seen
    shortest = result.answer.tally.shortest
    return shortest.get(wanted_verdict(result)) or shortest.get(UNKNOWN)


def counterexample(
    subject: Subject, checker: Checker, asked: Asked, options: Options, seen: Seen, place_of: Callable[[Location], str]
) -> Counterexample:
    """Walk a trace again, and tell it."""
    story = tell(Recorder(checker, asked, options.seed, options.max_steps), seen.trace, subject.clock)
    verdict = VERDICTS.get(story.recording.verdict, "fault")
    return Counterexample(heading(story), verdict, seen.trace, tuple(lines(story, place_of)))
