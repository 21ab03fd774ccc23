# SPDX-License-Identifier: Apache-2.0
"""The measurements of trees with mocks, computed from all states: they are those of probability theory, of random
traces, and of differences between two mocks."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.api.trees import LoadedTree, load_tree
from roaml.durations import ANY_TIME, moment, short_moment
from roaml.experiments.exact_trees import NotMeasuredError, measure_exactly
from roaml.mocks.mock import read_mock
from roaml.mocks.network import MockOptions
from roaml.project.settings import Settings
from roaml.record import replace
from roaml.smc.run import Options
from roaml.verification.small import SHARED_LIMITS
from roaml.verification.tree_outcome import Measured, TreeOutcome, measure

HEAD = '<root BTCPP_format="4" main_tree_to_execute="Main">'
FETCH = Path(__file__).resolve().parents[2] / "examples/fetch_tree/fetch.xml"
FETCH_MOCKS = {
    "ComputePathToPose": (0.98, "200 ms"),
    "FollowPath": (0.9, "2 s"),
    "ClearEntireCostmap": (0.8, "100 ms"),
    "LookAgain": (0.95, "300 ms"),
    "CloseGripper": (0.7, "500 ms"),
}


def tree(tmp_path: Path, content: str) -> str:
    path = tmp_path / "tree.xml"
    path.write_text(f'{HEAD}\n<BehaviorTree ID="Main">\n{content}\n</BehaviorTree>\n</root>\n', encoding="utf-8")
    return str(path)


def loaded(path: str, *mocks: str, max_time: int = 600) -> LoadedTree:
    options = MockOptions(tuple(map(read_mock, mocks)), max_time=max_time * 10**9, counts=True)
    return load_tree(path, options)


def exact(model: LoadedTree) -> TreeOutcome:
    outcome = measure_exactly(model.mocked, model.target, SHARED_LIMITS)
    assert outcome.is_exact
    return outcome


def fetch_mocks(**changed: float) -> tuple[str, ...]:
    return tuple(f"{name}: {changed.get(name, p)} in {time}" for name, (p, time) in FETCH_MOCKS.items())


def test_values_are_those_of_probability_theory(tmp_path: Path) -> None:
    content = "<RecoveryNode number_of_retries='1'><Drive/><Sequence><Ask/></Sequence></RecoveryNode>"
    outcome = exact(loaded(tree(tmp_path, content), "Drive: 0.7 in 1 s", "Ask: 0.8 in 500 ms"))
    drive, ask = 0.7, 0.8
    success = drive + (1 - drive) * ask * drive
    assert outcome.success.value == pytest.approx(success, abs=1e-12)
    assert outcome.failure.value == pytest.approx(1 - success, abs=1e-12)
    assert outcome.unfinished.value == outcome.exceptions.value == 0
    assert [(node.name, counter) for node, counter, _ in outcome.counts] == [("RecoveryNode", "recoveries")]
    assert outcome.counts[0][2].value == pytest.approx(1 - drive, abs=1e-12)
    # The first tick is at 0.1 s; an action of 1 s ends 10 ticks later. `Ask` takes 0.5 s, and `Drive` starts again.
    assert outcome.time is not None
    assert outcome.time.value == pytest.approx((1.1 * drive + 2.6 * (1 - drive) * ask * drive) / success, abs=1e-12)
    assert [quantile.value for quantile in outcome.quantiles] == [1.1, 2.6, 2.6]
    influence = {found.leaf.node.name: found.value for found in outcome.influences}
    assert influence == pytest.approx({"Drive": 1 + ask * (1 - 2 * drive), "Ask": (1 - drive) * drive}, abs=1e-7)


@pytest.mark.parametrize(
    ("kind", "constant", "values"),
    [("String", "ok", 2), ("Int", "3", 3), ("Int", "1", 2), ("Double", "1.5", 3), ("Bool", "true", 2)],
)
def test_an_output_may_have_the_value_with_which_a_node_of_version_3_compares_it(
    kind: str, constant: str, values: int, tmp_path: Path
) -> None:
    """The other values are 0 and 1, or the empty text."""
    path = tmp_path / "tree.xml"
    path.write_text(
        f"""<root><BehaviorTree ID="Main"><Sequence><Action ID="Look" found="{{it}}" />
        <BlackboardCheck{kind} value_A="{{it}}" value_B="{constant}" return_on_mismatch="FAILURE"><AlwaysSuccess />
        </BlackboardCheck{kind}></Sequence></BehaviorTree>
        <TreeNodesModel><Action ID="Look"><output_port name="found" /></Action></TreeNodesModel></root>""",
        encoding="utf-8",
    )
    assert exact(loaded(str(path), "Look: 0.9")).success.value == pytest.approx(0.9 / values, abs=1e-12)


@pytest.mark.parametrize("count", [2, 6])
def test_an_output_has_each_value_with_which_the_tree_compares_it_and_another_one(count: int, tmp_path: Path) -> None:
    """Only the last child of the switch succeeds, which is ticked if the text is empty: one of `count + 1` values."""
    model = '<TreeNodesModel><Action ID="Read"><output_port name="text" type="std::string"/></Action></TreeNodesModel>'
    cases = " ".join(f'case_{number}="v{number}"' for number in range(1, count + 1))
    children = "<AlwaysFailure/>" * count + "<AlwaysSuccess/>"
    switch = f'<Switch{count} variable="{{x}}" {cases}>{children}</Switch{count}>'
    path = tmp_path / "tree.xml"
    sequence = f'<Sequence><Read text="{{x}}"/>{switch}</Sequence>'
    path.write_text(
        f'<root BTCPP_format="4" main_tree_to_execute="T"><BehaviorTree ID="T">{sequence}</BehaviorTree>{model}</root>',
        encoding="utf-8",
    )
    assert exact(loaded(str(path), "Read: 1")).success.value == pytest.approx(1 / (count + 1), abs=1e-12)


def test_influences_are_differences() -> None:
    """Each influence is the quotient of a small difference of two exact probabilities."""
    outcome = exact(loaded(str(FETCH), *fetch_mocks()))
    assert len(outcome.influences) == len(FETCH_MOCKS)
    for influence in outcome.influences:
        name, step = influence.leaf.node.name, 1e-4
        low, high = (
            exact(loaded(str(FETCH), *fetch_mocks(**{name: FETCH_MOCKS[name][0] + change}))).success.value
            for change in (-step, step)
        )
        assert influence.value == pytest.approx((high - low) / (2 * step), rel=1e-5)


def within(measured: Measured, truth: float) -> bool:
    return measured.bounds.lower - 1e-9 <= truth <= measured.bounds.upper + 1e-9


def test_values_are_those_of_traces() -> None:
    model = loaded(str(FETCH), *fetch_mocks())
    outcome, seen = exact(model), measure(model.mocked, model.target, Options(max_traces=2000, confidence=0.9999))
    assert within(seen.success, outcome.success.value)
    assert seen.time is not None
    assert outcome.time is not None
    assert within(seen.time, outcome.time.value)
    for estimated, computed in zip(seen.quantiles, outcome.quantiles, strict=True):
        assert within(Measured(estimated.value, estimated.bounds), computed.value)
    for (node, counter, mean), (other, name, value) in zip(seen.counts, outcome.counts, strict=True):
        assert (node.number, counter) == (other.number, name)
        assert within(mean, value.value)
    truth = {influence.leaf.node.number: influence.value for influence in outcome.influences}
    for found in seen.influences:
        assert within(Measured(found.value, found.bounds), truth[found.leaf.node.number])


def test_a_tree_that_does_not_end(tmp_path: Path) -> None:
    content = "<KeepRunningUntilFailure><Drive/></KeepRunningUntilFailure>"
    outcome = exact(loaded(tree(tmp_path, content), "Drive: 0.9 in 900 ms", max_time=5))
    # It is ticked at 0.1 s, 0.2 s, …; `Drive` ends at 1.0 s, 2.0 s, …, 5.0 s.
    assert outcome.success.value == 0
    assert outcome.time is None
    assert outcome.failure.value == pytest.approx(1 - 0.9**5, abs=1e-12)
    assert outcome.unfinished.value == pytest.approx(0.9**5, abs=1e-12)


def test_a_trace_that_has_not_ended_in_time_has_not_failed(tmp_path: Path) -> None:
    """Only traces that are cut off widen the intervals, because the tree might have ended later."""
    model = loaded(tree(tmp_path, "<Repeat num_cycles='-1'><Drive/></Repeat>"), "Drive: 1 in 1 s", max_time=20)
    outcome = measure(model.mocked, model.target, Options(max_traces=50))
    assert outcome.unfinished.value == 1
    assert outcome.failure.bounds.upper == outcome.success.bounds.upper < 0.1
    cut = measure(model.mocked, model.target, Options(max_traces=50, max_steps=10))
    assert cut.failure.bounds.upper == cut.success.bounds.upper == 1


def test_an_exception_of_the_library(tmp_path: Path) -> None:
    """The condition of an `IfThenElse` is skipped."""
    condition = '<AlwaysSuccess _skipIf="n == 1"/>'
    content = (
        f"<Sequence><Script code='n := 1'/><Drive/><IfThenElse>{condition}<AlwaysSuccess/></IfThenElse></Sequence>"
    )
    outcome = exact(loaded(tree(tmp_path, content), "Drive: 0.9"))
    assert outcome.exceptions.value == pytest.approx(0.9, abs=1e-12)
    assert outcome.failure.value == pytest.approx(0.1, abs=1e-12)


@pytest.mark.parametrize(
    ("node", "success"),
    [
        ("Sequence", 0.9**9),
        ("AsyncSequence", 0.9**9),
        ("SequenceWithMemory", 0.9**9),
        ("ReactiveSequence", 0.9**9),
        ("PipelineSequence", 0.9**9),
        ("Parallel failure_count='1'", 0.9**9),
        ("ParallelAll max_failures='1'", 0.9**9),
        ("Fallback", 1 - 0.1**9),
        ("ReactiveFallback", 1 - 0.1**9),
    ],
)
def test_many_children_that_can_be_skipped(tmp_path: Path, node: str, success: float) -> None:
    """Three of twelve children are skipped. The automaton of a node does not distinguish which ones."""
    steps = "".join(f'<Step _skipIf="level == {i % 4}"/>' for i in range(12))
    content = f"<Sequence><Read level='{{level}}'/><{node}>{steps}</{node.split(maxsplit=1)[0]}></Sequence>"
    outcome = exact(loaded(tree(tmp_path, content), "Read: 1", "Step: 0.9"))
    assert outcome.success.value == pytest.approx(success, abs=1e-12)


def test_a_loop_over_texts(tmp_path: Path) -> None:
    """No model declares the port of `Go`. It is an input, because the loop writes the entry."""
    cases = '<Switch2 variable="{room}" case_1="hall" case_2="attic"><Wipe/><Sweep/><AlwaysSuccess/></Switch2>'
    body = f'<Sequence><Go room="{{room}}"/>{cases}</Sequence>'
    loop = f'<LoopString queue="hall;attic;7" value="{{room}}" if_empty="SUCCESS">{body}</LoopString>'
    outcome = exact(loaded(tree(tmp_path, loop), "Go: 1", "Wipe: 0.9", "Sweep: 0.8"))
    assert outcome.success.value == pytest.approx(0.72, abs=1e-12)


def test_too_many_states_have_no_values() -> None:
    model = loaded(str(FETCH), *fetch_mocks())
    with pytest.raises(NotMeasuredError, match=r"^there are more than 50 states \(max-states\)$"):
        measure_exactly(model.mocked, model.target, replace(SHARED_LIMITS, states=50))


def test_the_report_says_whether_states_or_choices_prevent_measurements(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    command = ["verify", str(FETCH), "--exhaustive", "--mock", "*: 0.9 in 1 s"]
    assert run([*command, "--max-states", "50"]) == 1, "undecided"
    assert "influences, because there are more than 50 states (max-states); omit" in capsys.readouterr().out
    monkeypatch.setattr("roaml.experiments.exact_trees.merged_choices", lambda *_: None)
    assert run(command) == 0
    assert "because they depend on the order in which nodes take their steps; omit" in capsys.readouterr().out


def test_the_order_in_which_the_last_leaf_writes_is_no_choice(tmp_path: Path) -> None:
    """The tree ends while the blackboard still receives what its last leaf writes: two flags, in any order."""
    content = (
        '<Sequence><Read tag="{tag}"/><Fallback><SkipUnlessUpdated entry="{tag}"><Store tag="{tag}"/>'
        '</SkipUnlessUpdated><WasEntryUpdated entry="{tag}"/><AlwaysSuccess/></Fallback></Sequence>'
    )
    outcome = exact(loaded(tree(tmp_path, content), "Read: 0.9 in 1 s", "Store: 0.8 in 2 s"))
    # If `Store` fails, `WasEntryUpdated` succeeds in the same tick.
    assert outcome.success.value == pytest.approx(0.9, abs=1e-12)
    assert outcome.time is not None
    assert outcome.time.value == pytest.approx(3.1, abs=1e-12)


def test_nodes_react_at_once_unless_a_setting_says_otherwise() -> None:
    mocks = {"*": "0.9 in 1 s"}
    default = api.target(str(FETCH), mocks=mocks)
    other = api.target(str(FETCH), mocks=mocks, settings=Settings(reaction_time=ANY_TIME))
    assert default.model.metadata is not None
    assert default.model.metadata.reaction_time.is_instant
    assert other.model.metadata is not None
    assert other.model.metadata.reaction_time.is_any


@pytest.mark.parametrize(("rate", "end"), [("10", "0.300 s"), ("15", "0.267 s")])
def test_all_reports_show_the_same_times(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], rate: str, end: str
) -> None:
    """The report, the explanation and the simulation of an event at the third or fourth tick."""
    path = tree(tmp_path, "<Sequence><Drive/></Sequence>")
    options = ("--mock", "Drive: 0 in 200 ms", "--tick-rate", rate)
    assert run(["verify", path, *options]) == 0
    report = capsys.readouterr().out
    assert f"the tree ends with FAILURE at {end}" in report
    assert f"{end}  Drive  FAILURE" in report
    assert run(["verify", path, *options, "--explain"]) == 0
    assert f"{end}  Drive" in capsys.readouterr().out
    assert run(["simulate", path, *options]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(end in line and "Drive" in line and "FAILURE" in line for line in lines)
    assert re.search(r" steps, \d\.\d{1,3} s, ", lines[-1])  # it ends a tick later


def test_times_are_those_of_the_editor() -> None:
    """They are rounded as `toFixed(3)` does in JavaScript."""
    times = (0.0, 14 / 15, 1 / 16, 0.0005, 1.0005, 2.0, 100.0, 12345.678)
    texts = ["0.000 s", "0.933 s", "0.063 s", "0.001 s", "1.000 s", "2.000 s", "100.000 s", "12345.678 s"]
    assert [moment(time) for time in times] == texts
    short = ["0 s", "0.933 s", "0.063 s", "0.001 s", "1 s", "2 s", "100 s", "12345.678 s"]
    assert [short_moment(time) for time in times] == short


@pytest.mark.parametrize("count", [2, 3, 5])
def test_the_order_in_which_entries_are_set_is_no_choice(count: int, tmp_path: Path) -> None:
    names = [f"entry{number}" for number in range(count)]
    script = "; ".join(f"{name} := {number}" for number, name in enumerate(names))
    check = " &amp;&amp; ".join(f"{name} == {number}" for number, name in enumerate(names))
    content = f'<Sequence><Script code="{script}"/><Drive/><ScriptCondition code="{check}"/></Sequence>'
    outcome = exact(loaded(tree(tmp_path, content), "Drive: 0.7 in 1 s"))
    assert outcome.success.value == pytest.approx(0.7, abs=1e-12)
    assert outcome.time is not None
    assert outcome.time.value == pytest.approx(1.1, abs=1e-12)
    assert [found.value for found in outcome.influences] == pytest.approx([1.0], abs=1e-7)


@pytest.mark.parametrize(("script", "expected"), [("n += 1", 0.0), ("n := n + 1", 0.0), ("n := 1", None)])
def test_a_leaf_without_a_model_does_not_write_what_scripts_compute(
    script: str, expected: float | None, tmp_path: Path
) -> None:
    count = f'<Sequence><ScriptCondition code="n != 3"/><Show text="{{n}}"/><Script code="{script}"/></Sequence>'
    content = f'<Sequence><Script code="n := 0"/><KeepRunningUntilFailure>{count}</KeepRunningUntilFailure></Sequence>'
    outcome = exact(loaded(tree(tmp_path, content), "Show: 1", max_time=3))
    assert outcome.failure.value == pytest.approx(1.0 if expected == 0.0 else 0.0, abs=1e-12)
