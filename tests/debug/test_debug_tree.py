# SPDX-License-Identifier: Apache-2.0
"""The debugger runs a behavior tree without a system, with mocks of its leaves."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from dap_client import Client

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.api.trees import load_tree
from roaml.ide.diagrams import DiagramKind, picture_of
from roaml.mocks.mock import Mock
from roaml.mocks.network import MockOptions
from roaml.smc.run import Options
from roaml.verification.tree_outcome import measure

ROOT = Path(__file__).resolve().parents[2]
FETCH = ROOT / "examples" / "fetch_tree" / "fetch.xml"
BUG = ROOT / "examples" / "assembly_robot" / "main_with_bug.xml"
TREE = """<root BTCPP_format="4" main_tree_to_execute="Main">
    <BehaviorTree ID="Main">
        <Sequence>
            <Drive goal="{shelf}" />
            <ScriptCondition code="load > 3" />
            <Grasp name="grasp box" />
        </Sequence>
    </BehaviorTree>
</root>
"""
GRASP = 6


@pytest.fixture
def client() -> Iterator[Client]:
    with Client() as client:
        yield client


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    path = tmp_path / "tree.xml"
    path.write_text(TREE, encoding="utf-8")
    return path


def _line(path: Path, text: str) -> int:
    lines = path.read_text(encoding="utf-8").splitlines()
    return next(number for number, line in enumerate(lines, 1) if text in line)


def _break(client: Client, path: Path, *lines: int) -> list[dict[str, Any]]:
    breakpoints = [{"line": line} for line in lines]
    return list(client.ask("setBreakpoints", source={"path": str(path)}, breakpoints=breakpoints)["breakpoints"])


def _outputs(client: Client) -> str:
    return "".join(event["body"]["output"] for event in client.events if event["event"] == "output")


def test_a_tree_runs_with_the_mocks_beside_it(client: Client) -> None:
    assert client.begin(FETCH)["reason"] == "entry"
    assert "uses the mocks of" in _outputs(client)
    assert "fetch.mocks" in _outputs(client)
    assert client.ask("threads")["threads"] == [{"id": 1, "name": "tree"}]
    follow = _line(FETCH, "<FollowPath")
    (set_,) = _break(client, FETCH, follow)
    assert (set_["verified"], set_["line"]) == (True, follow)
    assert client.move()["hitBreakpointIds"] == [set_["id"]]
    frames = [(frame["name"], frame["line"]) for frame in client.stack(1)]
    assert frames == [
        ("FollowPath: TICKED", follow),
        ("PipelineSequence: TICKED", _line(FETCH, "<PipelineSequence")),
        ("DriveToShelf : RecoveryNode: TICKED", _line(FETCH, "<RecoveryNode")),
        ("Sequence (bt_1000): TICKED", _line(FETCH, "<Sequence>")),
    ]
    ports = client.scope(client.stack(1)[0]["id"], "Ports")
    assert {name: port["value"] for name, port in ports.items()} == {
        "path": "'{path}'",
        "controller_id": "'FollowPath'",
    }
    # The breakpoint stops once in each tick of the node.
    ticks = [client.ask("choices")["time"]]
    for _ in range(3):
        client.move()
        ticks.append(client.ask("choices")["time"])
    assert ticks == pytest.approx([0.3, 0.4, 0.5, 0.6])


def test_breakpoints_in_a_subtree_and_statuses_in_the_picture(client: Client) -> None:
    client.launch(FETCH, mocks=["*: 1 in 200 ms"])
    gripper = _line(FETCH, "<CloseGripper")
    _break(client, FETCH, gripper)
    client.ask("configurationDone")
    client.event("stopped")
    client.move()
    stack = client.stack(1)
    assert [frame["line"] for frame in stack[:2]] == [gripper, _line(FETCH, "<Timeout")]
    assert any(frame["name"] == "Grasp : SubTree: TICKED" for frame in stack)
    picture = picture_of(DiagramKind.TREE, api.check([str(FETCH)]).snapshot.analysis, str(FETCH))
    assert picture is not None
    labels = {node.id: node.label for node in picture.nodes}
    active = {node["node"]: node for node in client.ask("pictures")["nodes"]}
    assert {node["source"]["path"] for node in active.values()} == {str(FETCH)}
    assert active.keys() == {name for name in labels if not name.startswith("{")}
    ticked = {labels[name] for name, node in active.items() if node["look"] == "ticked"}
    path = ("Sequence", "Grasp", "RetryUntilSuccessful", "Timeout", "CloseGripper")
    assert ticked == set(path)
    assert "Script" in {labels[name] for name, node in active.items() if node["look"] == "success"}


@pytest.mark.parametrize(
    ("chance", "name", "reason"), [(1, "", "end of the run"), (0, "", "violated"), (0, "fails", "end of the run")]
)
def test_a_run_stops_as_violated_only_if_its_own_property_is(
    client: Client, chance: int, name: str, reason: str
) -> None:
    client.begin(FETCH, mocks=[f"*: {chance} in 200 ms"], property=name)
    client.ask("setExceptionBreakpoints", filters=["violated"])
    assert client.move()["reason"] == reason


def test_the_attributes_of_launch_declare_the_mocks(client: Client, tree: Path) -> None:
    (tree.parent / "slow.mocks").write_text("Drive: 1 in 2 s  # slow\n", encoding="utf-8")
    attributes = {"mocks": ["grasp*: 1", "Unused: 0"], "mocksFile": "slow.mocks", "entries": {"load": 5}}
    client.launch(tree, tickRate=2.5, maxTime="10 s", **attributes)
    assert "the mock `Unused` matches no node of the tree" in _outputs(client)
    client.ask("setExceptionBreakpoints", filters=["satisfied", "violated"])
    client.ask("configurationDone")
    client.event("stopped")
    assert client.move()["description"] == "Satisfied: succeeds"
    steps, time = client.step(), client.ask("choices")["time"]
    # The first tick is at 0.4 s. Drive ends 2 s later, and the action without a duration in the same tick.
    assert time == pytest.approx(2.4)
    output = tree.parent / "run.json"
    options = ["--mock", "grasp*: 1", "--mocks", str(tree.parent / "slow.mocks"), "--entry", "load=5"]
    assert run(["simulate", str(tree), *options, "--tick-rate", "2.5", "--json", str(output)]) == 0
    assert len(json.loads(output.read_text(encoding="utf-8"))["steps"]) == steps
    (tree.parent / "slow.mocks").write_text("Drive: 0\n", encoding="utf-8")
    client.move("stepBack")
    assert "slow.mocks has changed since it was read" in _outputs(client)
    client.ask("restart")
    client.event("stopped")
    assert client.move()["description"] == "Violated: succeeds"
    assert client.ask("choices")["verdicts"] == {"succeeds": "failed"}


def test_wrong_declarations_are_refused(client: Client, tree: Path) -> None:
    client.ask("initialize", adapterID="as2fm", clientID="test")

    def refusal(path: Path = tree, **attributes: Any) -> str:
        return client.refusal("launch", program=str(path), **attributes)

    missing = refusal(entries={"load": 5}, mocks=["Drive: 1"])
    assert missing == f'{tree}: these leaves need mocks: Grasp; for example `"mocks": ["*: 0.9 in 1 s"]`'
    assert "`Drive 1` is not a mock" in refusal(mocks=["Drive 1"])
    unset = "nothing sets the entry `load`; give it a value at the start, with `entries` in the launch configuration"
    assert unset in refusal(mocks=["*: 1"])
    assert refusal(mocksFile="none.mocks") == f"{tree.parent / 'none.mocks'}: there is no such file"
    assert refusal(mocksFile="a\0b") == "`mocksFile` is not a path"
    assert "`tickRate` must be a number of Hz" in refusal(tickRate=0)
    assert "a system declares them in its files" in refusal(BUG, tickRate=5)
    model = tree.parent / "model.jani"
    model.write_text("{}", encoding="utf-8")
    assert "a JANI model has none" in refusal(model, mocks=["*: 1"])


def test_a_tree_without_mocks_runs_with_proposed_ones(client: Client, tree: Path) -> None:
    beside = tree.with_suffix(".mocks")
    client.begin(tree, entries={"load": 5})
    assert f"proposed mocks for 2 leaves: review them in {beside}" in _outputs(client)
    assert [mock.pattern for mock in api.read_mocks(beside.read_text(encoding="utf-8"))] == ["Drive", "Grasp"]


def test_mocks_that_are_missing_in_the_file_are_added(client: Client, tree: Path) -> None:
    beside = tree.with_suffix(".mocks")
    beside.write_text("# mine\nDrive: 1 in 1 s", encoding="utf-8")
    client.begin(tree, entries={"load": 5})
    assert beside.read_text(encoding="utf-8").startswith("# mine\nDrive: 1 in 1 s\nGrasp: 0.9 in 1 s  # action: ")


def test_mocks_replace_missing_plugins_of_a_system(client: Client, tmp_path: Path) -> None:
    robot = tmp_path / "robot"
    shutil.copytree(BUG.parent, robot)
    main = robot / BUG.name
    listed = re.sub(r'\s*<input[^>]*src="plugins/holds_block.ascxml"[^>]*/>', "", main.read_text(encoding="utf-8"))
    main.write_text(listed, encoding="utf-8")
    client.begin(main, mocks=["HoldsBlock: 1"])
    assert "uses mocks for 1 type of leaves" in _outputs(client)
    client.ask("setFunctionBreakpoints", breakpoints=[{"name": "HoldsBlock"}])
    assert client.move()["text"] == "HoldsBlock"


def test_the_schema_of_launch_lists_what_the_adapter_reads(client: Client, tree: Path) -> None:
    """The adapter refuses a value of a wrong type for each attribute of the schema. The document lists the same
    attributes."""
    package = json.loads((ROOT / "vscode-extension" / "package.json").read_text(encoding="utf-8"))
    (debugger,) = package["contributes"]["debuggers"]
    schema = debugger["configurationAttributes"]["launch"]["properties"]
    client.ask("initialize", adapterID="as2fm", clientID="test")
    for name in schema:
        wrong = {"program": str(tree), name: [{"wrong": 1}]}
        assert f"`{name}`" in client.refusal("launch", **wrong), name
    document = (ROOT / "docs" / "debugging.md").read_text(encoding="utf-8")
    table = document.partition("| attribute of `launch` | meaning |")[2].partition("\n\n")[0]
    rows = [row.split("|")[1] for row in table.splitlines() if "|" in row]
    assert {name for row in rows for name in re.findall(r"`(\w+)`", row)} == set(schema)
    texts = json.loads((ROOT / "vscode-extension" / "package.nls.json").read_text(encoding="utf-8"))
    assert all(attribute["description"].strip("%") in texts for attribute in schema.values())


@pytest.mark.parametrize(
    "main", ["<Sequence><SubTree ID='Fetch' /><Leaf name='last' /></Sequence>", "<SubTree ID='Fetch' />"]
)
def test_nodes_have_the_numbers_of_the_picture(tmp_path: Path, main: str) -> None:
    """Pictures do not number `<SubTree>`, also if it is the root of the tree or of a subtree."""
    path = tmp_path / "tree.xml"
    path.write_text(
        f"""<root BTCPP_format="4" main_tree_to_execute="Main">
    <BehaviorTree ID="Main">{main}</BehaviorTree>
    <BehaviorTree ID="Fetch"><Sequence><SubTree ID="Pick" name="first" /><SubTree ID="Pick" /></Sequence></BehaviorTree>
    <BehaviorTree ID="Pick"><SubTree ID="Grasp" /></BehaviorTree>
    <BehaviorTree ID="Grasp"><Inverter><Leaf name="grasp" /></Inverter></BehaviorTree>
</root>""",
        encoding="utf-8",
    )
    picture = picture_of(DiagramKind.TREE, api.check([str(path)]).snapshot.analysis, str(path))
    assert picture is not None
    titles = [node.title for node in picture.nodes if node.title is not None]
    drawn = {title.number: title.name for title in titles if title.number is not None}
    subtrees = [title.name for title in titles if title.number is None and title.plugin != "Main"]
    tree = load_tree(str(path), MockOptions((Mock("*", 0.5),), counts=True))
    session = api.session(tree.target, "succeeds")
    session.until_decided()
    statuses = {node.number: node.type for node in session.state().nodes}
    assert list(drawn) == list(range(1000, 1000 + len(drawn)))
    assert drawn.items() <= statuses.items()
    assert sorted(statuses[number] for number in statuses.keys() - drawn.keys()) == sorted(subtrees)
    assert session.is_decided
    outcome = measure(tree.mocked, tree.target, Options(max_traces=1000))
    assert outcome.unfinished.value == 0
    assert outcome.success.value == pytest.approx(0.25 / (1 + main.count("Leaf")), abs=0.06)


def test_a_node_that_is_executed_like_another_has_its_own_type(client: Client, tmp_path: Path) -> None:
    path = tmp_path / "own.xml"
    nodes = "<Lock name='door'>\n<Again>\n<Pull name='handle'/>\n</Again></Lock>"
    path.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="M">{nodes}</BehaviorTree></root>', encoding="utf-8")
    mocks = ["Pull: 1 in 1 s", "Lock: as Sequence", "Again: as RetryUntilSuccessful(num_attempts=3)"]
    client.launch(path, mocks=mocks)
    (breakpoint_,) = client.ask("setFunctionBreakpoints", breakpoints=[{"name": "Lock"}])["breakpoints"]
    assert breakpoint_["verified"]
    client.ask("configurationDone")
    stop = client.event("stopped")
    assert [frame["name"] for frame in client.stack(stop["threadId"])] == ["door : Lock: IDLE"]
