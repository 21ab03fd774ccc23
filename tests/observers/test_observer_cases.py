# SPDX-License-Identifier: Apache-2.0
"""Traces with their verdicts, for every pattern in every scope, with and without time, and every kind of end.

A line contains a property, a trace (see `drawn`) and the verdict. The naive evaluation checks each of them as well.
"""

from __future__ import annotations

import naive
import pytest
from drawn import final_state, observed, property_of, read

from roaml.observers.build import observer_of
from roaml.observers.properties import Pattern, ScopeKind, Window
from roaml.observers.verdict import Verdict

CASES = """
universality globally       : p p | p #              : violated      # the start, the clock's step: every letter counts
universality globally       : p p |p p #             : satisfied
universality globally       : p p |p T               : satisfied
universality globally       : p p ~                  : undecided
universality globally       : p . ~                  : violated
universality globally 0 1   : p p |p | #             : satisfied     # after the time nothing is asked
universality globally 0 1   : p p |p | ~             : satisfied
universality globally 0 1   : p p | T                : violated
universality globally 2 3   : . | |p p |p | . #      : satisfied
universality after          : . . sp p T             : satisfied
universality after          : . . s p T              : violated      # the letter that opens the scope is in it
universality after          : . . | T                : satisfied     # the scope never opens
universality after 0 1      : . sp |p | . T          : satisfied
universality before         : p p s . #              : satisfied
universality before         : p . . #                : satisfied     # nothing is asked if it never closes
universality before         : p . s #                : violated
universality before 0 1     : p |p | . s #           : satisfied
universality until          : p . #                  : violated
universality until          : p s . #                : satisfied
universality until 0 0      : p | . s #              : satisfied
universality between        : . sp p u . sp u #      : satisfied
universality between        : . sp . #               : satisfied     # never closed, so never judged
universality between        : . sp . u #             : violated
universality between 0 1    : . sp |p | . u #        : satisfied
universality after-until    : . sp . #               : violated
universality after-until    : . sp u . sp u #        : satisfied
universality after-until 0 1 : . sp |p | . #         : satisfied

absence globally            : . | q #                : satisfied
absence globally            : . | p #                : violated
absence globally 0 1        : . | | p #              : satisfied
absence globally 2 -        : p |p | #               : satisfied
absence globally 2 -        : p | |p #               : violated
absence after               : p s . #                : satisfied
absence after               : . sp #                 : violated
absence after 0 2           : . s | | | p #          : satisfied
absence before              : . p . #                : satisfied
absence before              : . p s #                : violated
absence before              : . s p #                : satisfied
absence before 0 0          : . | p s #              : satisfied
absence until               : . p #                  : violated
absence until               : . s p #                : satisfied
absence until 0 1           : . | | p s #            : satisfied
absence between             : . s p #                : satisfied
absence between             : . s u p s p u #        : violated      # the second stretch
absence between 0 1         : . s | | p u #          : satisfied
absence after-until         : . s p #                : violated
absence after-until         : . su p #               : satisfied     # s && !u opens it
absence after-until 0 1     : . s | | p #            : satisfied

existence globally          : . | p #                : satisfied
existence globally          : . | p ~                : satisfied
existence globally          : . | #                  : violated
existence globally          : . | T                  : violated      # as F is false at the end of time
existence globally          : . | ~                  : undecided
existence globally 0 2      : . | | p #              : satisfied
existence globally 0 2      : . | | | p #            : violated
existence globally 0 2      : . | #                  : violated      # it will never come
existence globally 0 2      : . | T                  : open          # the window reaches beyond the end of time
existence globally 0 2      : . | | T                : violated      # the window ends with the time
existence globally 0 2      : . | ~                  : undecided
existence globally 2 3      : p | | T                : open
existence globally 2 3      : p | |p T               : satisfied
existence globally 1 -      : p | T                  : violated      # no deadline
existence after             : p s T                  : violated
existence after             : p sp T                 : satisfied
existence after             : . . T                  : satisfied
existence after 0 1         : . | | s | T            : violated
existence after 0 2         : . | | s | T            : open
existence after 0 1         : . | | s |p T           : satisfied
existence before            : . . #                  : satisfied
existence before            : . s p #                : violated
existence before            : . p s #                : satisfied
existence before            : s p #                  : violated      # an empty stretch holds nothing
existence before 0 1        : . | | p s #            : violated
existence before 0 1        : . | s #                : violated      # the stretch closes before the deadline
existence until             : . . #                  : violated
existence until             : . p #                  : satisfied
existence until             : . s p #                : violated
existence until 0 3         : . | T                  : open
existence until 0 3         : . s | T                : violated
existence between           : . s . #                : satisfied
existence between           : . s p u s u #          : violated
existence between           : . s p u s p u #        : satisfied
existence between 0 1       : . s | | p u #          : violated
existence after-until       : . s . #                : violated
existence after-until       : . s p u #              : satisfied
existence after-until 0 2   : . s p u s | T          : open
existence after-until 0 2   : . s p u s | | T        : violated

response globally           : . . #                  : satisfied     # no request
response globally           : . p | | q #            : satisfied
response globally           : . pq #                 : satisfied     # in it or a later letter
response globally           : . q p #                : violated
response globally           : . q p T                : violated
response globally           : . q p ~                : undecided
response globally 0 2       : . p | | q #            : satisfied
response globally 0 2       : . p | | | q #          : violated
response globally 0 2       : . p | p | | q #        : violated      # the first request waits longest
response globally 0 2       : . p q | p | | q #      : satisfied
response globally 0 2       : . p | T                : open
response globally 0 2       : . p | #                : violated
response globally 0 2       : . p | | T              : violated
response globally 0 2       : . p | p | T            : violated      # one is due, the other one is open
response globally 0 0       : . p q | p | q #        : violated
response globally 1 2       : . p q | q #            : satisfied
response globally 1 2       : . p q | | | #          : violated      # too early
response globally 1 2       : . p | p q T            : open          # the first request is answered, the second not
response globally 2 -       : . p | q | q #          : satisfied
response globally 2 -       : . p | q | T            : violated
response after              : p s q #                : satisfied     # requests before the scope do not count
response after              : . s p . #              : violated
response after 0 1          : . sp | q #             : satisfied
response after 0 1          : . sp | | q #           : violated
response before             : . p . #                : satisfied
response before             : . p s q #              : violated      # the stretch closes without an answer
response before             : . p q s #              : satisfied
response before 0 1         : . p | | q s #          : violated
response until              : . p . #                : violated
response until              : . p q s p #            : satisfied
response until 0 2          : . p | T                : open
response between            : . s p #                : satisfied
response between            : . s p u q #            : violated
response between            : . s p q u s p q u #    : satisfied
response between 0 1        : . s p | | q u #        : violated
response after-until        : . s p #                : violated
response after-until        : . s p q u p #          : satisfied
response after-until 0 1    : . s p | q u s p | | #  : violated

precedence globally         : . p | q q #            : satisfied
precedence globally         : . q p #                : violated
precedence globally         : . pq #                 : satisfied
precedence globally         : . p ~                  : satisfied
precedence globally 0 2     : . p | | q #            : satisfied
precedence globally 0 2     : . p | | | q #          : violated
precedence globally 0 2     : . p | p | | q #        : satisfied     # the last cause counts
precedence globally 0 2     : . q ~                  : violated
precedence globally 1 2     : . p q #                : violated      # too soon
precedence globally 1 2     : . p | p q #            : satisfied
precedence globally 2 5     : p | q #                : violated
precedence globally 2 5     : p | | q | | | q #      : satisfied
precedence globally 2 5     : p | | | | | | q #      : violated
precedence globally 3 -     : p | | | | | | q #      : satisfied
precedence globally 3 -     : . p | | q #            : violated
precedence after            : p s q #                : violated      # causes before the scope do not count
precedence after            : . s p q #              : satisfied
precedence after 0 1        : . s p | | q #          : violated
precedence before           : . q . #                : satisfied
precedence before           : . q s #                : violated
precedence before           : . p q s q #            : satisfied
precedence before 0 1       : . p | | q s #          : violated
precedence until            : . q #                  : violated
precedence until            : . s q #                : satisfied
precedence until 0 1        : . p | q | q #          : violated
precedence between          : . s q #                : satisfied
precedence between          : . s p q u s q u #      : violated
precedence between 0 1      : . s p | q u #          : satisfied
precedence after-until      : . s q #                : violated
precedence after-until      : . s p q u q #          : satisfied
precedence after-until 1 1  : . s p | q u s p q #    : violated

recurrence globally 0 2     : . | | p | | p T        : satisfied
recurrence globally 0 2     : . | | | p T            : violated      # counted from the start
recurrence globally 0 2     : . | p | | | T          : violated
recurrence globally 0 2     : . | p | | #            : satisfied
recurrence globally 0 2     : . | p ~                : undecided
recurrence after 0 1        : . | | s | p | T        : satisfied     # counted from the opening
recurrence after 0 1        : . s | | #              : violated
recurrence before 0 1       : . | | #                : satisfied
recurrence before 0 1       : . | | s #              : violated
recurrence until 0 1        : . | | #                : violated
recurrence until 0 1        : . | s | | #            : satisfied
recurrence between 0 1      : . s | | #              : satisfied
recurrence between 0 1      : . s | p | u #          : satisfied
recurrence between 0 1      : . s | | u #            : violated
recurrence after-until 0 1  : . s | | #              : violated
recurrence after-until 0 1  : . s | u | | #          : satisfied
"""


def _cases(table: str = CASES) -> list[tuple[str, str, str]]:
    rows = (line.split(":") for line in table.splitlines() if line.strip())
    return [(property_.strip(), trace.strip(), verdict.split()[0]) for property_, trace, verdict, *_ in rows]


@pytest.mark.parametrize(("property_", "trace", "expected"), _cases())
def test_case(property_: str, trace: str, expected: str) -> None:
    letters, end = read(trace)
    assert observed(property_of(property_), letters, end) is Verdict(expected)
    by_tables = naive.verdict(property_of(property_), letters, end)
    assert by_tables is Verdict(expected) or (by_tables is Verdict.UNDECIDED and trace.endswith("~"))


def test_every_pattern_in_every_scope_is_shown_with_and_without_time() -> None:
    shown = {(p.pattern, p.scope, p.window.is_unbounded) for p in (property_of(text) for text, _, _ in _cases())}
    expected = {
        (pattern, scope, is_unbounded)
        for pattern in Pattern
        for scope in ScopeKind
        for is_unbounded in (True, False)
        if not (pattern is Pattern.RECURRENCE and is_unbounded)
    }
    assert shown == expected


VACUOUS = """
response globally           : . q . #                : vacuous
response globally           : . p q #                : exercised
precedence globally 1 2     : . p | #                : vacuous
precedence globally         : . q #                  : exercised
universality after          : p . #                  : vacuous
universality after          : p s #                  : exercised
absence before              : . . #                  : vacuous
absence before              : . . s #                : exercised
response before             : . p . #                : vacuous       # it is judged when the scope closes
response before             : . . s p #              : vacuous
response before             : . p s #                : exercised
response between            : . s u p #              : vacuous
response between            : . s p u #              : exercised
existence between           : . s u #                : exercised
recurrence after-until 0 1  : . u #                  : vacuous
"""


SCOPES = """
response after              : . p q #                : unopened
response after              : . s #                  : opened
response before             : . p q #                : unopened      # it is judged when the scope closes
response before             : . s #                  : opened
precedence between          : . s #                  : unopened
precedence between          : . s u #                : opened
response after-until        : . u #                  : unopened
response after-until        : . s #                  : opened
"""


@pytest.mark.parametrize(("property_", "trace", "expected"), _cases(SCOPES))
def test_opened_scopes(property_: str, trace: str, expected: str) -> None:
    letters, _ = read(trace)
    opened = observer_of(property_of(property_)).outputs.opened
    assert opened is not None
    assert bool(final_state(property_of(property_), letters)[opened.name]) is (expected == "opened")


@pytest.mark.parametrize("property_", ["response globally", "precedence until", "absence after", "existence before"])
def test_scopes_that_say_no_more_than_exercised_have_no_output(property_: str) -> None:
    assert observer_of(property_of(property_)).outputs.opened is None


@pytest.mark.parametrize(("property_", "trace", "expected"), _cases(VACUOUS))
def test_exercised_properties(property_: str, trace: str, expected: str) -> None:
    letters, _ = read(trace)
    exercised = observer_of(property_of(property_)).outputs.exercised
    assert exercised is not None
    assert bool(final_state(property_of(property_), letters)[exercised.name]) is (expected == "exercised")


@pytest.mark.parametrize(("lower", "upper"), [(3, 2), (-1, None), (0, -1)])
def test_empty_windows_are_refused(lower: int, upper: int | None) -> None:
    with pytest.raises(ValueError, match="invalid range of times"):
        Window(lower, upper)


@pytest.mark.parametrize("window", ["0 -", "1 2"])
def test_a_recurrence_needs_only_an_upper_bound(window: str) -> None:
    with pytest.raises(ValueError, match="recurrence"):
        property_of(f"recurrence globally {window}")
