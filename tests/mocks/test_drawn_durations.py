# SPDX-License-Identifier: Apache-2.0
"""Mocks with random durations: the times of trees are those of the distributions."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from pathlib import Path

import pytest
from scipy import stats

from as2fm_lsp.cli.main import run
from roaml.api.trees import LoadedTree, load_tree
from roaml.distributions.outcomes import MAX_CUT
from roaml.experiments.exact_trees import measure_exactly
from roaml.mocks.mock import MockError, read_mock
from roaml.mocks.network import MockOptions
from roaml.model.drawn_durations import DrawnDuration
from roaml.smc.run import Options
from roaml.verification.small import SHARED_LIMITS
from roaml.verification.tree_outcome import Measured, TreeOutcome, measure

HEAD = '<root BTCPP_format="4" main_tree_to_execute="Main">'
FIRST_TICK = 0.1
"""The time of the first tick, in s. All leaves start there."""


def tree(folder: Path, content: str) -> str:
    path = folder / "tree.xml"
    path.write_text(f'{HEAD}<BehaviorTree ID="Main">{content}</BehaviorTree></root>\n', encoding="utf-8")
    return str(path)


def loaded(path: str, *mocks: str) -> LoadedTree:
    return load_tree(path, MockOptions(tuple(map(read_mock, mocks)), counts=True))


def exact(model: LoadedTree) -> TreeOutcome:
    return measure_exactly(model.mocked, model.target, SHARED_LIMITS)


@pytest.mark.parametrize(
    ("duration", "law"),
    [
        ("normal(2 s, 300 ms)", stats.norm(2, 0.3)),
        ("normal(500 ms, 400 ms)", stats.norm(0.5, 0.4)),
        ("exponential(1 s)", stats.expon(scale=1)),
        ("uniform(1 s, 1570 ms)", stats.uniform(1, 0.57)),
    ],
)
def test_the_time_of_a_leaf_is_that_of_its_distribution(
    duration: str, law: stats.rv_continuous, tmp_path: Path
) -> None:
    outcome = exact(loaded(tree(tmp_path, "<Drive/>"), f"Drive: 0.75 in {duration}"))
    assert outcome.success.value == pytest.approx(0.75, abs=1e-12)
    # The mean of the number of ticks N = max(0, ⌈10 T⌉) is the sum of P(N > k), and N > k if T > k / 10.
    mean = FIRST_TICK + math.fsum(law.sf(k / 10) for k in range(1000)) / 10
    assert outcome.time is not None
    assert outcome.time.value == pytest.approx(mean, abs=1e-4)
    for quantile in outcome.quantiles:
        ticks = max(0, math.ceil(round(law.ppf(quantile.share) * 10, 9)))
        assert quantile.value == pytest.approx(FIRST_TICK + ticks / 10)


@pytest.mark.parametrize(
    ("duration", "law", "unit"),
    [
        ("bernoulli(0.3) * 2 s", stats.bernoulli(0.3), 20),
        ("binomial(5, 0.4) * 300 ms", stats.binom(5, 0.4), 3),
        ("geometric(0.4) * 250 ms", stats.geom(0.4), 2.5),
        ("poisson(2.5) * 1 s", stats.poisson(2.5), 10),
        ("uniform_int(2, 5)*500ms", stats.randint(2, 6), 5),
    ],
)
def test_numbers_are_multiplied_by_a_time(duration: str, law: stats.rv_discrete, unit: float, tmp_path: Path) -> None:
    """Exact values and random traces. `unit` is the number of ticks of 0.1 s in a unit."""
    model = loaded(tree(tmp_path, "<Drive/>"), f"Drive: 0.75 in {duration}")
    outcome = exact(model)
    assert outcome.success.value == pytest.approx(0.75, abs=1e-12)
    mean = FIRST_TICK + math.fsum(law.pmf(n) * math.ceil(n * unit) for n in range(200)) / 10
    assert outcome.time is not None
    assert outcome.time.value == pytest.approx(mean, abs=1e-4)
    for quantile in outcome.quantiles:
        assert quantile.value == pytest.approx(FIRST_TICK + math.ceil(law.ppf(quantile.share) * unit) / 10)
    options = Options(max_traces=2000, confidence=0.9999)
    sampled = measure(model.mocked, model.target, options)
    assert sampled.time is not None
    assert within(sampled.success, 0.75)
    assert within(sampled.time, mean)


DATA = {
    "s": "duration,runs\n0.25,1\n0.3,1\n# a comment\n1.05,2\n",
    "ms": "250\n300\n1001\n1100\n",
    "min": "0.005\n0.018\n",
}
"""Unit -> durations that take 3 ticks of 0.1 s with the probability 1/2, and 11 ticks with 1/2."""


@pytest.mark.parametrize("unit", DATA)
def test_durations_are_drawn_from_data(unit: str, tmp_path: Path) -> None:
    """The path is relative to the file of the tree, whatever the current directory is."""
    (tmp_path / "data").mkdir()
    (tmp_path / "data/drive.csv").write_text(DATA[unit], encoding="utf-8")
    model = loaded(tree(tmp_path, "<Drive/>"), f"Drive: 0.75 in histogram('data/drive.csv', {unit})")
    outcome = exact(model)
    assert outcome.success.value == pytest.approx(0.75, abs=1e-12)
    assert outcome.time is not None
    assert outcome.time.value == pytest.approx(FIRST_TICK + (3 + 11) / 2 / 10, abs=1e-9)
    assert str(tmp_path / "data/drive.csv") in model.target.files


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (None, "no file `drive.csv` that can be read"),
        ("a\nb\n", "`drive.csv`: line 2 is `b`"),
        ("", "contains no values"),
    ],
)
def test_data_that_cannot_be_used(
    text: str | None, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tree(tmp_path, "<Drive/>")
    if text is not None:
        (tmp_path / "drive.csv").write_text(text, encoding="utf-8")
    assert run(["verify", path, "--mock", "Drive: 0.5 in histogram('drive.csv', s)"]) != 0
    assert reason in capsys.readouterr().err


def test_the_time_of_two_leaves_is_a_sum(tmp_path: Path) -> None:
    """Two uniform numbers of ticks, 3 to 6 and 1 to 2, and a leaf that is repeated."""
    content = "<Sequence><Drive/><RetryUntilSuccessful num_attempts='2'><Grasp/></RetryUntilSuccessful></Sequence>"
    outcome = exact(
        loaded(tree(tmp_path, content), "Drive: 1 in uniform(200 ms, 600 ms)", "Grasp: 0.5 in uniform(0 s, 200 ms)")
    )
    assert outcome.success.value == pytest.approx(0.75)
    assert outcome.time is not None
    # The second attempt starts at the tick at which the first one fails.
    drive, grasp = 0.45, 0.15
    attempts = (0.5 * grasp + 0.25 * 2 * grasp) / 0.75
    assert outcome.time.value == pytest.approx(FIRST_TICK + drive + attempts)


def within(measured: Measured, truth: float) -> bool:
    return measured.bounds.lower - 1e-9 <= truth <= measured.bounds.upper + 1e-9


def test_traces_have_the_same_times_and_influences(tmp_path: Path) -> None:
    content = "<Fallback><Sequence><Drive/><Grasp/></Sequence><Ask/></Fallback>"
    model = loaded(
        tree(tmp_path, content),
        "Drive: 0.9 in exponential(500 ms)",
        "Grasp: 0.7 in categorical(200 ms, 0.5, 1 s, 0.5)",
        "Ask: 0.6 in normal(300 ms, 200 ms)",
    )
    outcome, seen = exact(model), measure(model.mocked, model.target, Options(max_traces=2000, confidence=0.9999))
    assert outcome.success.value == pytest.approx(0.9 * 0.7 + (1 - 0.9 * 0.7) * 0.6, abs=1e-12)
    assert within(seen.success, outcome.success.value)
    assert seen.time is not None
    assert outcome.time is not None
    assert within(seen.time, outcome.time.value)
    truth = {influence.leaf.node.name: influence.value for influence in outcome.influences}
    assert truth == pytest.approx({"Drive": 0.7 * 0.4, "Grasp": 0.9 * 0.4, "Ask": 1 - 0.63}, abs=1e-7)
    for found in seen.influences:
        assert within(Measured(found.value, found.bounds), truth[found.leaf.node.name])


def test_a_halt_starts_a_new_duration(tmp_path: Path) -> None:
    """A timeout halts the leaf after 3 ticks; each attempt draws again."""
    content = "<RetryUntilSuccessful num_attempts='2'><Timeout msec='250'><Drive/></Timeout></RetryUntilSuccessful>"
    outcome = exact(loaded(tree(tmp_path, content), "Drive: 1 in categorical(100 ms, 0.3, 1 s, 0.7)"))
    assert outcome.success.value == pytest.approx(1 - 0.7**2)
    # The second attempt starts at 0.4 s, at the tick of the timeout. A duration of 100 ms ends at the next tick.
    assert outcome.time is not None
    assert outcome.time.value == pytest.approx((0.3 * 0.2 + 0.7 * 0.3 * 0.5) / 0.51)


def test_mocks_of_a_system_take_the_same_times(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tree(tmp_path, "<Drive/>")
    (tmp_path / "properties.jani").write_text('{"properties": []}', encoding="utf-8")
    main = tmp_path / "main.xml"
    main.write_text(
        '<roaml><parameters><max_time value="10" unit="s"/><bt_tick_rate value="10"/></parameters>'
        '<behavior_tree><input type="bt.cpp-xml" src="tree.xml"/></behavior_tree>'
        '<properties><input type="jani" src="properties.jani"/></properties></roaml>',
        encoding="utf-8",
    )
    arguments = ["--exhaustive", "--reaction-time", "instant", "--format", "json"]
    (tmp_path / "drive.csv").write_text("250\n1050\n", encoding="utf-8")
    laws = (
        ("exponential(200 ms)", stats.expon(scale=0.2)),
        ("normal(1 s, 1 s)", stats.norm(1, 1)),
        ("histogram('drive.csv', ms)", stats.rv_discrete(values=((250, 1050), (0.5, 0.5)))),
    )
    for duration, law in laws:
        mock = f"Drive: 0.9 in {duration}"
        asked = 'R{"ticks Drive"}=? [ C<=2000 ]'
        assert run(["verify", str(main), "--mock", mock, "--property", asked, *arguments]) == 0
        (result,) = json.loads(capsys.readouterr().out)["results"]
        # Tick k = 0, 1, … at 0.1 s, 0.2 s, … is the leaf's while it has not ended before, or if it ends.
        unit = 1000 if duration.startswith("histogram") else 1
        ticks = 1 + math.fsum(law.sf(k / 10 * unit) for k in range(97))
        assert result["exact"]["least"] == pytest.approx(ticks, abs=1e-4)


@pytest.mark.parametrize(
    ("duration", "reason"),
    [
        ("exponentiel(1 s)", "did you mean `exponential`"),
        ("gamma(3)", "not a distribution; the distributions of durations are bernoulli, binomial, categorical"),
        ("poisson(3)", r"`poisson` draws a number; multiply it by a duration, as in `poisson\(3\) \* 100 ms`"),
        ("poisson(3) * 2", "`poisson` draws a number; multiply it by a duration"),
        ("poisson(3 s) * 2 s", "`3 s` in .* is not a number without a unit"),
        ("geometric(0) * 2 s", "the probability of `geometric` must be above 0"),
        ("normal(3 s, 1 s) * 2 s", r"is already a duration; remove `\* 2 s`"),
        ("normal(3, 1)", "`3` in .* is not a duration"),
        ("normal(3 s, 0 s)", "standard deviation"),
        ("normal(3 s)", "`mean`, `deviation`"),
        ("categorical(1 s, 2 s)", "`2 s` in .* is not a probability"),
        ("histogram('a.csv')", "the unit of its values, ms, s, min; write for example"),
        ("histogram('a.csv', 2 s)", "the name of a file in quotes"),
        ("histogram(a.csv, s)", "the name of a file in quotes"),
        ("categorical(1 s, 0.5)", "add up to 0.5"),
        ("categorical(1 s, 1e-9999999, 2 s, 1)", "`1e-9999999` in .* is not a probability"),
    ],
)
def test_durations_that_are_not_valid(duration: str, reason: str) -> None:
    with pytest.raises(MockError, match=reason):
        read_mock(f"Drive: 0.5 in {duration}")


def test_a_mock_is_written_as_it_was_read() -> None:
    mock = read_mock("Drive: 0.5 in normal( 8 s, 2 s )")
    assert isinstance(mock.duration, DrawnDuration)
    assert mock.duration.arguments == (Fraction(8000), Fraction(2000))
    assert read_mock(f"Drive: {mock.behaviour()}") == mock
    assert mock.behaviour(is_instant=True) == "0.5"


def test_the_report_states_what_is_cut(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Sequence><Drive/><Grasp/></Sequence>")
    mocks = ["--mock", "Drive: 0.9 in normal(1 s, 200 ms)", "--mock", "*: 0.9"]
    assert run(["verify", path, *mocks]) == 0
    assert "drawn durations are rounded up to ticks, and the most extreme ones" in capsys.readouterr().out
    assert run(["verify", path, *mocks, "--format", "json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["tree"]["drawn_durations"]
    assert (row["node"], row["mock"]) == ("Drive", "0.9 in normal(1 s, 200 ms)")
    assert 0 < row["cut"] <= MAX_CUT


def test_a_duration_with_too_many_values_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Drive/>")
    assert run(["verify", path, "--mock", "Drive: 0.9 in normal(1 min, 20 min)"]) == 1
    reason = "117,400 values at multiples of the step; at most 2,000 are possible; use a lower tick rate"
    assert reason in capsys.readouterr().err
