# SPDX-License-Identifier: Apache-2.0
"""An expectation that is met under uniform choices, but missed by the estimate of a sampled scheduler."""

from __future__ import annotations

import pytest

from as2fm_lsp.verification.result_view import ResultMark, mark_of
from roaml.comparison import UniformPolicy
from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.goal import Question
from roaml.smc.run import Options, summary
from roaml.smc.statistics import Bounds
from roaml.smc.tally import Tally
from roaml.verification.expectations import Verdict, check_expectation, parse
from roaml.verification.results import Estimated, Result
from roaml.verification.schedulers import judged, under_all_schedulers


def verdict(text: str, method: ExtremeMethod = ExtremeMethod.SAMPLING) -> Verdict:
    """The verdict on an expectation of 200 traces that hold, with a scheduler for which 0.756 of the traces do."""
    answer = summary(Question("p", "Pmin", False, None, ()), Options(), Tally(traces=200, successes=200))
    least = Extreme(0.756, Bounds(0.64, 0.872), method, "sampled scheduler 1", 60)
    most = Extreme(1.0, Bounds(0.98, 1.0), ExtremeMethod.UNIFORM)
    return under_all_schedulers(check_expectation(parse(text), answer), answer, Choices("", least, most, 56))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("p >= 0.7", "met under uniform choices"),
        (
            "p >= 0.8",
            "met under uniform choices; not shown for the minimum, of which an estimate is 0.756",
        ),
        ("p >= 0.9", "NOT MET under sampled scheduler 1: 0.756 in [0.64, 0.872]"),
        ("p <= 0.9", "met"),
        ("p == 0.5", "NOT MET under uniform choices"),
        ("p == 0.95", "NOT MET under sampled scheduler 1: 0.756 in [0.64, 0.872]"),
    ],
)
def test_the_line_says_what_the_sampled_scheduler_shows(text: str, words: str) -> None:
    assert verdict(text).text == words


def test_values_for_instant_reactions_are_a_reason() -> None:
    missed = verdict("p >= 0.9", ExtremeMethod.REACTIONS)
    assert (
        missed.text == "NOT MET: the minimum over all schedulers is at most 0.756, the value if machines react at once"
    )
    assert missed.is_certain


def test_the_estimate_under_uniform_choices_is_no_reason() -> None:
    assert verdict("p >= 0.8", ExtremeMethod.UNIFORM).text == "met under uniform choices"


@pytest.mark.parametrize(
    ("policy", "is_met", "mark", "words"),
    [
        (UniformPolicy.ACCEPT, True, ResultMark.PASSED, "met under uniform choices"),
        (UniformPolicy.WARN, True, ResultMark.UNIFORM, "met under uniform choices"),
        (UniformPolicy.FAIL, False, ResultMark.FAILED, "NOT MET: known only under uniform choices"),
    ],
)
def test_the_policy_decides_what_it_is_worth(policy: UniformPolicy, is_met: bool, mark: ResultMark, words: str) -> None:
    answer = summary(Question("p", "Pmin", False, None, ()), Options(), Tally(traces=200, successes=200))
    unknown = Choices("", None, None, 0)
    known = judged(under_all_schedulers(check_expectation(parse("p >= 1"), answer), answer, unknown), policy)
    assert (known.is_met, known.text) == (is_met, words)
    assert (
        known.doubt(0.01) == "no trace of 200 contradicts it, which proves nothing: the interval reaches down to 0.969"
    )
    assert mark_of(Result("p", Estimated(answer, unknown), (known,))) is mark


@pytest.mark.parametrize("policy", UniformPolicy)
def test_other_verdicts_do_not_depend_on_the_policy(policy: UniformPolicy) -> None:
    for text in ("p >= 0.9", "p <= 0.9"):
        assert judged(verdict(text), policy) == verdict(text)
