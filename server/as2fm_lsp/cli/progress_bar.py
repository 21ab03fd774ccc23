# SPDX-License-Identifier: Apache-2.0
"""The progress of a verification, on one line of a terminal."""

from __future__ import annotations

import math
import time
from types import TracebackType

from as2fm_lsp.cli.status_line import StatusLine
from roaml.explicit.space import ExplorationProgress
from roaml.record import replace
from roaml.smc.goal import Question
from roaml.smc.lss import Search
from roaml.smc.run import Options, bounds_of, trace_count
from roaml.smc.tally import Tally

BAR_CHARACTERS = 20


class ProgressBar:
    """A line on standard error, in a `with` statement. Nothing is shown if standard error is not a terminal. The line
    is removed at the end."""

    def __init__(self) -> None:
        self._line = StatusLine()
        self._question: Question | None = None
        self._search: Search | None = None
        self._options = Options()
        self._tally = Tally()
        self._began = time.monotonic()
        self._first = 0

    def __enter__(self) -> ProgressBar:
        self._line.__enter__()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._line.__exit__(kind, error, at)

    def begin(self, question: Question, options: Options, tally: Tally) -> None:
        """Show the progress of this property from now on; `tally` contains the traces that it already has."""
        self._question, self._options, self._tally = question, options, tally
        self._began, self._first = time.monotonic(), tally.traces
        self._search = None

    def together(self, question: Question, tally: Tally, number: int) -> None:
        """Update after a batch of traces that `number` properties share. `question` is the property that is shown."""
        self._question = replace(question, name=f"{question.name} ({number} properties together)")
        self.watch(tally)

    def watch(self, tally: Tally) -> None:
        """Update after a batch of traces."""
        self._tally = tally
        self._show()

    def search(self, search: Search) -> None:
        """Show the progress of a search for schedulers, or of the traces under the selected scheduler."""
        self._search = search
        side = search.selected.get(search.side)
        if side is not None:
            self._tally = side.tally
        self._show()

    def states(self, question: Question, progress: ExplorationProgress) -> None:
        """Update during an exploration of all states."""
        if self._line.is_due:
            states, left = progress.states, progress.states - progress.expanded
            self._line.show(f"{question.name}: {states:,} states, {left:,} still to be expanded")

    def pulse(self, _trace: int, steps: int) -> None:
        """Update within a trace, with its number of steps. The line states how many traces there are so far; the number
        of the trace is not shown, because those of sampled schedulers do not begin at 0."""
        self._show(f", a trace at step {steps:,}" if steps else "")

    def _show(self, more: str = "") -> None:
        if not self._line.is_due or self._question is None:
            return
        if self._search is None:
            seconds = time.monotonic() - self._began
            self._line.show(line(self._question, self._options, self._tally, seconds, self._first) + more)
        else:
            self._line.show(search_line(self._question, self._search, self._options))


def line(question: Question, options: Options, tally: Tally, seconds: float, first: int = 0) -> str:
    """The line: the name of the property, the bar, the number of traces, the current estimate and the estimated
    remaining time.

    Args:
        seconds: the time since the first trace of this run, in s.
        first: the number of traces from an earlier run.
    """
    if tally.traces == 0:
        return f"{question.name} …"
    share = progress(question, options, tally)
    full = int(share * BAR_CHARACTERS)
    lower, upper = bounds_of(tally, question, options)
    value = tally.mean.mean if question.is_reward else (tally.successes + tally.undecided / 2) / tally.traces
    text = f"{question.name} {'━' * full}{'─' * (BAR_CHARACTERS - full)} {share:4.0%}  {tally.traces:,} traces"
    text += f"  {value:.4g} [{lower:.4g}, {upper:.4g}]"
    made = tally.traces - first
    if seconds > 1 and 0 < share < 1 and made:
        text += f"  {_duration(seconds / made * tally.traces * (1 - share) / share)} left"
    return text


def search_line(question: Question, search: Search, options: Options) -> str:
    """The line during a search for schedulers: the round and the best probability so far; after the search, the
    estimate."""
    text = f"{question.name}, {search.side.extreme} probability"
    side = search.selected.get(search.side)
    if side is not None and side.tally.traces:
        return line(replace(question, name=text), options, side.tally, 0)
    if search.round == 0:
        return f"{text} …"
    text += f": round {search.round} of {search.rounds}, {search.done:,} of {search.left:,} schedulers tried"
    return text if search.best is None else f"{text}, best so far {search.best:.4g}"


def progress(question: Question, options: Options, tally: Tally) -> float:
    """The estimated share of the traces that have been generated, from 0 to 1, both included."""
    total = trace_count(options)
    if total is None:
        half = bounds_of(tally, question, options, tally.is_revised).half_width
        target = options.epsilon * (max(abs(tally.mean.mean), 1e-9) if question.is_reward else 1)
        # The width of the interval decreases with the square root of the number of traces.
        share = 0.0 if math.isinf(half) or math.isnan(half) else 1.0 if half <= target else (target / half) ** 2
    else:
        share = tally.traces / total
    if options.max_traces is not None:
        share = max(share, tally.traces / options.max_traces)
    return min(1.0, share)


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"
