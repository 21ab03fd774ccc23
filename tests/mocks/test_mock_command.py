# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp verify TREE.xml --mock …`: its results, and input that it rejects."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

HEAD = '<root BTCPP_format="4" main_tree_to_execute="Main">'


def tree(tmp_path: Path, content: str) -> str:
    path = tmp_path / "tree.xml"
    path.write_text(f'{HEAD}\n<BehaviorTree ID="Main">\n{content}\n</BehaviorTree>\n</root>\n', encoding="utf-8")
    return str(path)


def verified(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, object]:
    assert run(["verify", *arguments, "--format", "json"]) == 0, capsys.readouterr().err
    value: dict[str, object] = json.loads(capsys.readouterr().out)
    return value


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert run(["verify", *arguments]) != 0
    return capsys.readouterr().err


def test_the_results_are_those_of_probability_theory(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two of three in a row, with one retry: the probability, its derivatives, the times and the recoveries."""
    path = tree(tmp_path, "<RecoveryNode number_of_retries='1'><Drive/><Sequence><Ask/></Sequence></RecoveryNode>")
    mocks = ("--mock", "Drive: 0.7 in 1 s", "--mock", "Ask: 0.8 in 500 ms", "--max-traces", "3000")
    measured = verified(capsys, path, *mocks)["tree"]
    assert isinstance(measured, dict)

    def holds(part: dict[str, float], truth: float) -> bool:
        return part["lower"] <= truth <= part["upper"]

    drive, ask = 0.7, 0.8
    success = drive + (1 - drive) * ask * drive
    assert holds(measured["success"], success)
    assert holds(measured["recoveries"][0], 1 - drive)
    influence = {row["node"]: row for row in measured["influences"]}
    assert holds(influence["Drive"], 1 + ask * (1 - 2 * drive))
    assert holds(influence["Ask"], (1 - drive) * drive)
    assert influence["Drive"]["upper"] - influence["Drive"]["lower"] < 0.2
    # The first tick is at 0.1 s; an action of 1 s ends 10 ticks later.
    assert measured["quantiles"][0]["value"] == pytest.approx(1.1)
    assert measured["quantiles"][2]["value"] == pytest.approx(2.6)


def test_a_mock_of_a_name_precedes_that_of_a_type(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Sequence><Drive name='first'/><Drive/><Drive name='last'/></Sequence>")
    mocks = ("--mock", "*: 0", "--mock", "Drive: 1", "--mock", "la?t: 0.5", "--mock", "first: 1")
    measured = verified(capsys, path, *mocks)["tree"]
    assert isinstance(measured, dict)
    assert measured["success"]["value"] == 1


def test_mocks_from_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Sequence><Drive/><Load/></Sequence>")
    mocks = tmp_path / "tree.mocks"
    mocks.write_text("# the robot of the lab\nDrive: 1 in 2 s\n\nLoad: 1 in 1 min  # slow\n", encoding="utf-8")
    measured = verified(capsys, path, "--mocks", str(mocks), "--tick-rate", "1")["tree"]
    assert isinstance(measured, dict)
    assert measured["time"]["value"] == pytest.approx(63)


def test_the_file_beside_a_tree_has_its_mocks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Sequence><Drive/><Ask/></Sequence>")
    beside = tmp_path / "tree.mocks"
    beside.write_text("Drive: 1 in 3 s\nAsk: 1\n", encoding="utf-8")
    assert run(["verify", path]) == 0
    printed = capsys.readouterr()
    assert "50, 90 and 99 % within 3.1 s" in printed.out
    assert re.search(r"uses the mocks of \S*tree\.mocks\n", printed.err)
    assert run(["verify", path, "--mock", "*: 1 in 1 s"]) == 0
    printed = capsys.readouterr()
    assert "50, 90 and 99 % within 2.1 s" in printed.out
    assert "uses the mocks of" not in printed.err
    beside.write_text("Drive", encoding="utf-8")
    assert "`Drive` is not a mock" in refused(capsys, path)
    beside.write_bytes(b"\xff")
    assert "not valid UTF-8" in refused(capsys, path)


def test_leaves_without_mocks_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Sequence><Drive/><Load/><Drive/><Sleep msec='10'/></Sequence>")
    message = refused(capsys, path, "--mock", "Load: 1")
    assert "these leaves need mocks: Drive; for example" in message


@pytest.mark.parametrize(
    ("mock", "reason"),
    [
        ("Drive", "is not a mock"),
        ("Drive: often", "is not a probability"),
        ("Drive: 1.5", "is not a probability"),
        ("Drive: 0.5 in a while", "is not a duration"),
        ("Drive: as Sequenc", "no library has this node with children; did you mean `Sequence`?"),
        ("Drive: as Precondition", "its script cannot be set here"),
        ("Drive: as Sleep", "no library has this node with children; for example `ForceSuccess`"),
        ("Drive: as Repeat(cycles=3)", "`Repeat` has no port `cycles`; did you mean `num_cycles`?"),
        ("Drive: as Inverter(x=3)", "`Inverter` has no port `x`; it has no ports"),
        ("Drive: as Repeat(num_cycles)", "`num_cycles` does not set a port of `Repeat`"),
        ("Drive: as Repeat(num_cycles={n})", "must be a constant here"),
        ("Drive: as Repeat(num_cycles=3, num_cycles=4)", "the port `num_cycles` of `Repeat` is set twice"),
        ("Drive: as", "names no node of a library; write a mock as `NODE: 0.9 in 2 s`, or for a node with children as"),
        ("Drive: as Sequenc", "`Drive: as Sequenc` is not a mock: a node cannot be executed like"),
        ("Drive: as two words", "is not a node of a library; write it as `Repeat(num_cycles=3)`"),
    ],
)
def test_mocks_that_are_not_valid(mock: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert reason in refused(capsys, tree(tmp_path, "<Drive/>"), "--mock", mock)


def test_a_node_with_too_many_children_is_refused_with_its_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    reason = "`ReactiveSequence` with 60 children has more than 20,000 states, the maximum of one node; divide its"
    path = tree(tmp_path, f"<ReactiveSequence>{'<Drive/>' * 60}</ReactiveSequence>")
    assert reason in refused(capsys, path, "--mock", "*: 1 in 1 s")


def test_all_missing_entries_are_named_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Those of ports and scripts, of one node and of several, at their places behind escapes."""
    path = tree(
        tmp_path,
        "<Sequence><ScriptCondition code='a &gt; 2 &amp;&amp; bcd &lt; a'/><Sleep msec='{eta}' _skipIf='f &gt; g'/>"
        "<Switch2 variable='{way}' case_1='a' case_2='b'><Drive/><Drive/><Drive/></Switch2></Sequence>",
    )
    text = refused(capsys, path, "--mock", "Drive: 1")
    lines = Path(path).read_text(encoding="utf-8").splitlines()
    named = re.findall(r":(\d+):(\d+): error: nothing sets the entry `(\w+)`; .*, with `--entry (\w+)=VALUE`", text)
    assert [name for *_, name, _ in named] == ["a", "bcd", "eta", "f", "g", "way"]
    for line, column, name, option in named:
        assert name == option
        assert lines[int(line) - 1][int(column) - 1 :].lstrip("{").startswith(name)


def test_a_missing_entry_of_a_subtree_has_the_name_that_the_option_needs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "tree.xml"
    path.write_text(
        """<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <Drive _skipIf="speed == 3 || mode == 'off'" _failureIf="level &gt; 2"/>
      <Switch2 variable="{kind}" case_1="a" case_2="b"><Drive/><Drive/><Drive/></Switch2>
      <SubTree ID="Dock"/>
      <SubTree ID="Dock" tries="1"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Dock"><Drive _skipIf="tries == 3"/></BehaviorTree>
</root>""",
        encoding="utf-8",
    )
    command = ["verify", str(path), "--mock", "*: 1"]
    assert run(command) == 1
    error = capsys.readouterr().err
    values = {"speed": "1", "mode": "on", "level": "0", "kind": "a", "Dock__tries": "1"}
    assert sorted(re.findall(r"with `--entry (\w+)=VALUE`", error)) == sorted(values)
    assert run([*command, *(part for name, value in values.items() for part in ("--entry", f"{name}={value}"))]) == 0


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (
            "<Mine><Drive/></Mine>",
            "these nodes with children: Mine; declare in mocks which nodes of a library they behave like, for",
        ),
        (
            "<ScriptCondition code='level &gt; 3'/>",
            "nothing sets the entry `level`; give it a value at the start, with `--entry level=VALUE`",
        ),
        (
            "<Switch2 variable='{way}' case_1='a' case_2='b'><Drive/><Drive/><Drive/></Switch2>",
            "with `--entry way=VALUE`",
        ),
        ("<Script code='x := 1 &amp; 2'/>", "works on bits"),
        ("<Script code=\"t := 'a'; t := t .. 'b'\"/>", "texts cannot be joined"),
        (
            "<Sequence><Script code='k := 1'/><SetBlackboard value='2' output_key='{k}'/></Sequence>",
            "means the entry whose name",
        ),
        ("<LoopInt queue='{q}' value='{v}'><Drive/></LoopInt>", "a queue in the blackboard"),
        ("<ManualSelector><Drive/></ManualSelector>", "for example `ManualSelector: as Sequence`"),
    ],
)
def test_trees_that_are_rejected(content: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert reason in refused(capsys, tree(tmp_path, content), "--mock", "*: 0.5")


def test_models_of_nodes_of_nav2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A model of a node of Nav2, as Groot2 writes it into the tree, does not hide what the node does."""
    content = "<RecoveryNode><RateController><Drive/></RateController><Wait wait_duration='1'/></RecoveryNode>"
    models = """</BehaviorTree><TreeNodesModel>
        <Control ID="RecoveryNode"><input_port name="number_of_retries">Number of retries</input_port></Control>
        <Decorator ID="RateController"/><Action ID="Wait"><input_port name="wait_duration"/></Action>
    </TreeNodesModel><BehaviorTree ID="Other"><AlwaysSuccess/>"""
    measured = verified(capsys, tree(tmp_path, content + models), "--mock", "Drive: 0", "--mock", "Wait: 1")["tree"]
    assert isinstance(measured, dict)
    assert [row["value"] for row in measured["recoveries"]] == [1.0]


def test_an_entry_of_the_host(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<ScriptCondition code='level &gt; 3'/>")
    for level, success in (("2", 0.0), ("4", 1.0)):
        measured = verified(capsys, path, "--entry", f"level={level}")["tree"]
        assert isinstance(measured, dict)
        assert measured["success"]["value"] == success


def test_what_users_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(
        tmp_path,
        "<Sequence><IsReady/><RetryUntilSuccessful num_attempts='2'><Drive/></RetryUntilSuccessful></Sequence>",
    )
    assert run(["verify", path, "--mock", "*: 0.5 in 1 s", "--expect", "succeeds >= 0.9"]) == 1
    text = capsys.readouterr().out
    for part in ("succeeds: = 0.375", "time until success: mean", "failed attempts of RetryUntilSuccessful",
                 "trace without success", "ticked at 10 Hz, for at most 600 s"):  # fmt: skip
        assert part in text
    assert re.search(r"raising IsReady \(.*tree\.xml:\d+\) from 0\.5 to 0\.51 adds 0\.0075[;\n]", text)


@pytest.mark.parametrize(
    ("content", "models", "is_named"),
    [
        ("<Script code='speed := 0.5'/><Dock v='{speed}'/>", "", True),
        ("<SetBlackboard output_key='speed' value='0.5'/><Dock v='{speed}'/>", "", True),
        ("<Script code='speed := 0.5'/><Dock v='{speed}'/>", "<input_port name='v'/>", False),
        ("<Script code='speed := 0.5'/><Dock v='{speed}'/>", "<output_port name='v'/>", False),
        ("<Script code='speed := 0.5'/><Dock v='{other}'/>", "", False),
        ("<Dock v='{speed}'/>", "", False),
    ],
)
def test_an_entry_that_a_mock_overwrites_is_named(
    content: str, models: str, is_named: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = f"<TreeNodesModel><Action ID='Dock'>{models}</Action></TreeNodesModel>" if models else ""
    path = tmp_path / "tree.xml"
    body = f"<Sequence>{content}<ScriptCondition code='speed &lt; 1.0'/></Sequence>"
    path.write_text(
        f"<root BTCPP_format='4'><BehaviorTree ID='A'>{body}</BehaviorTree>{model}</root>", encoding="utf-8"
    )
    run(["verify", str(path), "--mock", "Dock: 0.75 in 1 s"])
    printed = capsys.readouterr()
    assert "for at most 600 s" in printed.out, printed.err
    says = (
        "the mock of `Dock` overwrites the entry `speed`, which the tree sets: declare its port `v` as `<input_port>`"
    )
    assert (says in printed.out) is is_named
    assert ("overwrites" in printed.out) is is_named


def test_a_tree_that_cannot_succeed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """No leaf has an influence, and that the tree may not end within 600 s has no probability worth a line."""
    path = tree(tmp_path, "<KeepRunningUntilFailure><Drive/></KeepRunningUntilFailure>")
    assert run(["verify", path, "--mock", "*: 0.5 in 1 s"]) == 0
    text = capsys.readouterr().out
    assert "\n  influence of the leaves: none, because the tree does not succeed, whatever they return\n" in text
    assert "raising" not in text
    assert "not ended" not in text


def test_one_attempt_is_singular(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<RetryUntilSuccessful num_attempts='1'><Drive/></RetryUntilSuccessful>")
    run(["verify", path, "--mock", "Drive: 0 in 1 s"])
    assert "on average: 1 failed attempt of RetryUntilSuccessful (" in capsys.readouterr().out


def test_means_of_equal_values(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Traces that agree say nothing about other traces, but a time and a number of attempts are never negative."""
    twice = "<RetryUntilSuccessful num_attempts='2'><Drive/></RetryUntilSuccessful>"
    path = tree(tmp_path, f"<Sequence><ForceSuccess>{twice}</ForceSuccess><IsReady/></Sequence>")
    mocks = ("--mock", "IsReady: 0.5", "--mock", "Drive: 0 in 1 s", "--method", "fixed", "--max-traces", "20")
    run(["verify", path, *mocks])
    text = capsys.readouterr().out
    assert "time until success: 2.1 s in all traces that succeed; " in text
    assert re.search(r"average: in all traces 2 failed attempts of RetryUntilSuccessful \(.*\)$", text, re.MULTILINE)
    assert "inf" not in text.replace("influence", "")
    measured = verified(capsys, path, *mocks)["tree"]
    assert isinstance(measured, dict)
    assert measured["time"]["lower"] == measured["failed_attempts"][0]["lower"] == 0


def test_why_a_tree_fails_in_all_traces(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """No mock fails: the leaf that fails is a node of the library. A table shows what each node returns."""
    path = tree(tmp_path, "<Sequence><Drive/><Fallback><AlwaysFailure/></Fallback><Never/></Sequence>")
    run(["verify", path, "--mock", "*: 1 in 1 s"])
    before, _, trace = capsys.readouterr().out.partition("the shortest trace without success:")
    assert re.search(r"because AlwaysFailure \(.*tree\.xml:\d+\) returns FAILURE$", before.strip())
    assert trace.splitlines()[1].split()[2:4] == ["AlwaysFailure", "FAILURE"]
    # `Drive` is ticked 11 times, and then the other nodes once.
    rows = re.findall(r"^  (\w+) \(.*\) +(\d+) +(\d+) +(\d+) +(\d+) +(\d+)$", trace, re.MULTILINE)
    assert rows == [
        ("Sequence", "11", "0", "1", "10", "0"),
        ("Drive", "11", "1", "0", "10", "0"),
        ("Fallback", "1", "0", "1", "0", "0"),
        ("AlwaysFailure", "1", "0", "1", "0", "0"),
    ]
    assert re.search(r"\n  never ticked: Never \(.*tree\.xml:\d+\)\n", trace)


def test_a_node_that_decides_otherwise_than_its_leaf(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Inverter><Drive/></Inverter>")
    run(["verify", path, "--mock", "*: 1 in 1 s"])
    assert re.search(
        r"^the tree ends with FAILURE at 1\.100 s, because Inverter \(\S+\) returns FAILURE after Drive ",
        capsys.readouterr().out,
        re.MULTILINE,
    )


def test_a_trace_of_a_tree_that_always_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Without chance, the statuses of all leaves that fail are shown."""
    path = tree(tmp_path, "<Sequence><IsReady/><Drive/></Sequence>")
    run(["verify", path, "--mock", "IsReady: 1", "--mock", "Drive: 0 in 1 s"])
    _, _, trace = capsys.readouterr().out.partition("the shortest trace without success:")
    assert trace.splitlines()[1].split()[2:4] == ["Drive", "FAILURE"]


def test_a_trace_that_contradicts_an_upper_limit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """If success is expected to be rare, the shown trace is one with success."""
    path = tree(tmp_path, "<Sequence><IsReady/><Drive/></Sequence>")
    assert run(["verify", path, "--mock", "*: 0.9 in 1 s", "--expect", "succeeds <= 0.1"]) == 1
    _, _, trace = capsys.readouterr().out.partition("the shortest trace with success:")
    assert [line.split()[3] for line in trace.splitlines()[1:3]] == ["SUCCESS", "SUCCESS"]


def system(tmp_path: Path, content: str) -> str:
    tree(tmp_path, content)
    path = tmp_path / "main.xml"
    path.write_text(
        """<roaml>
<parameters><max_time value="20" unit="s"/><bt_tick_rate value="10"/></parameters>
<behavior_tree><input type="bt.cpp-xml" src="tree.xml"/></behavior_tree>
<properties><input type="xml" src="properties.xml"/></properties>
</roaml>
""",
        encoding="utf-8",
    )
    (tmp_path / "properties.xml").write_text(
        """<properties><ports><bt_node node="root" event="response">
<event_var id="answered"/><state_var id="status" type="int32" field="status" expr="0"/>
</bt_node></ports><guarantees><property id="done" pattern="existence">
<event>answered &amp;&amp; status == 1</event><scope type="globally"/></property></guarantees></properties>
""",
        encoding="utf-8",
    )
    return str(path)


def probability(capsys: pytest.CaptureFixture[str], *arguments: str) -> float:
    (result,) = verified(capsys, *arguments, "--max-traces", "400", "--scheduler", "uniform")["results"]  # type: ignore[misc]
    value: float = result["probability"]
    return value


def test_leaves_of_a_system_without_plugins(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`goal` is set by no node of the tree, and `path` is of a C++ type; neither keeps the system from being run."""
    path = system(
        tmp_path,
        """<Sequence name="root"><ComputePathToPose goal="{goal}" path="{path}" error_code_id="{code}"/>
        <FollowPath path="{path}" controller_id="FollowPath"/><Mine speed="0.5" code="{code}"/></Sequence>""",
    )
    assert probability(capsys, path, "--mock", "*: 1 in 1 s") == 1
    assert probability(capsys, path, "--mock", "*: 1", "--mock", "Mine: 0") == 0
    assert 0.35 < probability(capsys, path, "--mock", "*: 1", "--mock", "FollowPath: 0.5 in 300 ms") < 0.65
    assert "these leaves need mocks: FollowPath, Mine" in refused(capsys, path, "--mock", "Comp*: 1")


def test_events_of_the_world_in_a_system(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = system(
        tmp_path,
        """<PathLongerOnApproach name="root" path="{path}"><AlwaysFailure/></PathLongerOnApproach>""",
    )
    assert probability(capsys, path, "--mock", "PathLongerOnApproach: 0") == 1
    assert probability(capsys, path, "--mock", "PathLongerOnApproach: 1") == 0
    asks = """<PathLongerOnApproach name="root" path="{{path}}" _event_probability="{}">
        <AlwaysFailure/></PathLongerOnApproach>"""
    tree(tmp_path, asks.format("1"))
    assert probability(capsys, path) == 0
    tree(tmp_path, asks.format("x"))
    assert "must be a number from 0 to 1" in refused(capsys, path)


def test_a_trace_of_a_plugin_with_conditions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The plugin is behind an automaton for its conditions; the story tells what it answers."""
    path = system(tmp_path, '<Sequence name="root"><Mine code="{c}" _skipIf="c == 5"/><AlwaysSuccess/></Sequence>')
    run(["verify", path, "--mock", "Mine: 0.5", "--max-traces", "20", "--scheduler", "uniform", "--explain"])
    text = capsys.readouterr().out
    assert re.search(r"Mine +is ticked in idle → failed: FAILURE", text)
    assert "_inner_" not in text


def test_nodes_with_names_in_a_trace(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Nodes with children are left out while they only pass on ticks, whatever their names are and also in Nav2."""
    content = '<RecoveryNode name="Try hard">\n<RateController>\n<Drive/></RateController><Wait/></RecoveryNode>'
    arguments = ("--mock", "Drive: 0 in 300 ms", "--mock", "Wait: 0", "--max-traces", "50", "--explain")
    assert run(["verify", tree(tmp_path, content), *arguments]) == 0
    text = capsys.readouterr().out
    assert "bt_100" not in text
    assert re.search(r"Try hard +returns FAILURE", text)


def test_entries_are_for_trees(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "main.xml"
    path.write_text("<roaml/>", encoding="utf-8")
    assert "entries and a tick rate are for files of behavior trees" in refused(capsys, str(path), "--entry", "a=1")


def test_equal_leaves_of_a_tree_that_is_used_twice_have_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = (
        '<Sequence><SubTree ID="Inner" name="a"/><SubTree ID="Inner" name="b"/><Last/></Sequence></BehaviorTree>\n'
        '<BehaviorTree ID="Inner"><Drive/>'
    )
    assert run(["verify", tree(tmp_path, content), "--mock", "*: 0.9", "--verbose"]) == 0
    raised = re.findall(r"raising (\w+) \(.*tree\.xml:\d+(.*?)\) from", capsys.readouterr().out)
    assert sorted(raised) == [("Drive", ", bt_1001"), ("Drive", ", bt_1002"), ("Last", "")]


def test_a_leaf_with_scripts_returns_failure_by_chance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its mock decides before its scripts are executed, in other turns of the same tick."""
    content = (
        "<Sequence><Script code='a := 0'/><Work _onFailure='a += 1' _post='a += 1' _skipIf='a &gt; 5'/>"
        "<ScriptCondition code='a == 1'/></Sequence>"
    )
    assert run(["verify", tree(tmp_path, content), "--mock", "*: 0.25"]) == 0
    assert re.search(r"because Work \(.*tree\.xml:3\) returns FAILURE \(by chance, 0\.75\)\n", capsys.readouterr().out)


def test_flags_of_observed_entries_have_one_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content = (
        "<Sequence><SetBlackboard value='1' output_key='goal'/><WasEntryUpdated entry='{goal}'/>"
        "<SkipUnlessUpdated entry='{goal}'><Drive/></SkipUnlessUpdated></Sequence>"
    )
    assert run(["simulate", tree(tmp_path, content), "--mock", "*: 1"]) == 0
    text = capsys.readouterr().out
    assert "{goal} updated for bt_1002: 1 → 0" in text
    assert "(goal updated for bt_1002: 1, goal updated for bt_1003: 1)" in text
    assert not re.search(r"goal__|goal\.|entry__", text)


def test_the_reason_for_estimates(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Sequence><Drive/><Ask/></Sequence>")
    reason = "\n  estimated from traces, because there are more than 2 states (max-states)\n"
    for options, is_stated in ((("--max-states", "2"), True), ((), False), (("--max-traces", "100"), False)):
        assert run(["verify", path, "--mock", "*: 0.5", *options]) == 0
        assert (reason in capsys.readouterr().out) is is_stated
