# SPDX-License-Identifier: Apache-2.0
"""What an editor shows of a property and its known result, in the words of the command line's report."""

from __future__ import annotations

import os
from collections.abc import Callable
from enum import Enum
from typing import TypedDict

from as2fm_lsp.verification.known_results import KnownResult, missed
from as2fm_lsp.verification.report import one_as_text
from as2fm_lsp.verification.scheduler_report import meanings
from roaml.ide.verifiable import Texts
from roaml.text import Location
from roaml.verification.counterexample import unwanted_trace, witness_trace
from roaml.verification.headline import headline
from roaml.verification.results import Estimated, Result

MAX_FILES = 3
"""The maximum number of files that a sentence about changes names."""


class ResultMark(Enum):
    """The verdict on a result, which editors show as a symbol.

    Attributes:
        UNIFORM: the expectation is met under uniform choices only, which a warning reports.
        OPEN: no expectation.
        UNDECIDED: neither an expectation nor a value for all schedulers, or an expectation that is undecided.
        DOUBTFUL: traces got stuck.
    """

    FAILED = "failed"
    UNIFORM = "uniform"
    PASSED = "passed"
    OPEN = "open"
    UNDECIDED = "undecided"
    DOUBTFUL = "doubtful"


SYMBOLS = {
    ResultMark.FAILED: "✗",
    ResultMark.UNIFORM: "~",
    ResultMark.PASSED: "✓",
    ResultMark.OPEN: "=",
    ResultMark.UNDECIDED: "?",
    ResultMark.DOUBTFUL: "⚠",
}


def mark_of(result: Result) -> ResultMark:
    if result.stuck:
        return ResultMark.DOUBTFUL
    if result.is_undecided:
        return ResultMark.UNDECIDED
    if missed(result):
        return ResultMark.FAILED
    if any(verdict.is_warned_about for verdict in result.verdicts):
        return ResultMark.UNIFORM
    if result.verdicts:
        return ResultMark.PASSED
    return ResultMark.UNDECIDED if headline(result).claim else ResultMark.OPEN


class ResultView(TypedDict):
    """A result as an editor shows it.

    Attributes:
        mark: a value of `ResultMark`.
        lines: the report on the property, line by line, without its name.
        since: which changes make the result stale, as a sentence; "" if none do.
        trace: the number of the trace that contradicts the expectation, to debug it; null if there is none.
        canSetExpectation: whether the result suggests an expectation.
        epsilon: half the width of the interval; 0 for an exact value.
    """

    mark: str
    lines: list[str]
    since: str
    counterexample: bool
    witness: bool
    seed: int | None
    trace: int | None
    canSetExpectation: bool
    epsilon: float


def result_view(known: KnownResult, now: Texts, place_of: Callable[[Location], str]) -> ResultView:
    """A known result as an editor shows it.

    Args:
        now: the current digests of the files on which the result depends.
        place_of: file and line of an origin.
    """
    result = known.result
    unwanted, traces = unwanted_trace(result), result.traces
    text = one_as_text(result, place_of)
    first, *more = [*text.splitlines(), *filter(None, (meanings(text),))]
    is_estimate = isinstance(result.outcome, Estimated)
    return {
        "mark": mark_of(result).value,
        "lines": [first.removeprefix(f"{result.name}: "), *(line.strip() for line in more)],
        "since": _since(changed(known.texts, now)),
        "counterexample": unwanted is not None,
        "witness": witness_trace(result) is not None,
        "seed": None if traces is None else traces.options.seed,
        "trace": None if unwanted is None else unwanted.trace,
        "canSetExpectation": result.has_no_expectation and result.answer is not None,
        "epsilon": result.epsilon if is_estimate else 0.0,
    }


def changed(before: Texts, now: Texts) -> tuple[str, ...]:
    """The files whose content differs, that were added, or that were removed."""
    old, new = dict(before), dict(now)
    return tuple(path for path in dict.fromkeys((*old, *new)) if old.get(path) != new.get(path))


def _since(files: tuple[str, ...]) -> str:
    if not files:
        return ""
    names = [os.path.basename(path) for path in files]
    listed = ", ".join(names[:MAX_FILES]) + (f" and {len(names) - MAX_FILES} more" if len(names) > MAX_FILES else "")
    return f"stale: {listed} {'has' if len(names) == 1 else 'have'} changed since the verification"
