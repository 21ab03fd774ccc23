# SPDX-License-Identifier: Apache-2.0
"""Trees without a system in an editor: their lenses, their verification with proposed mocks, and editing of mocks."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from client import Client, connect
from lsprotocol import types
from test_lsp_verify import WINDOW, ask, lenses, verify

from as2fm_lsp.handlers.mocks import MOCKS, SET_MOCK
from as2fm_lsp.handlers.results import PROPERTIES

EXAMPLES = Path(__file__).parents[2] / "examples"
COMMANDS = {"debugModel": "editor.debug", "editMocks": "editor.mocks", "showCounterexample": "editor.show"}
SILENT = {"silent": True}
TREE = """<root BTCPP_format="4">
  <BehaviorTree ID="Main">
    <Fallback>
      <FollowPath path="{path}"/>
      <Wait wait_duration="0.5"/>
    </Fallback>
  </BehaviorTree>
</root>
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    path = tmp_path / "tree.xml"
    path.write_text(TREE, encoding="utf-8")
    return path


def document(path: Path, **more: object) -> dict[str, Any]:
    return {"textDocument": {"uri": path.as_uri()}, **more}


async def test_a_tree_is_verified_in_one_click(tree: Path) -> None:
    beside = tree.with_suffix(".mocks")
    async with connect(tree.parent, options=COMMANDS, capabilities=types.ClientCapabilities(window=WINDOW)) as client:
        client.open(tree, language="xml")
        assert await lenses(client, tree) == ["Run", "Debug", "Verify", "Mocks"]
        assert not beside.exists()
        answer = await verify(client, tree, [], SILENT)
        (result,) = answer["results"]
        assert (result["property"], result["probability"]) == ("succeeds", 1.0)
        assert "FollowPath: 0.9 in 10 s  # action" in beside.read_text(encoding="utf-8")
        assert [m.message for m in client.messages] == [
            "Proposed mocks for 2 leaves are in tree.mocks: review their values."
        ]
        shown = await lenses(client, tree)
        assert shown[2].startswith("Verify · 1, exact")
        assert "stale" not in shown[2]
        (listed,) = await ask(client, PROPERTIES, None)
        assert listed["uri"] == tree.as_uri()
        (property_,) = listed["properties"]
        assert (property_["name"], property_["stale"]) == ("succeeds", False)
        assert (await ask(client, MOCKS, document(tree)))["result"].startswith("succeeds: 1, exact")


async def test_a_result_is_that_of_the_mocks_and_stale_after_a_change(tree: Path) -> None:
    beside = tree.with_suffix(".mocks")
    beside.write_text("FollowPath: 0.5 in 1 s\nWait: 0.5 in 1 s\n", encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        (result,) = (await verify(client, tree, ["succeeds"], SILENT))["results"]
        assert result["probability"] == 0.75
        client.open(beside, "FollowPath: 0.5 in 1 s\nWait: 1 in 1 s\n", language="mocks")
        assert "stale" in (await lenses(client, tree))[2]
        (result,) = (await verify(client, tree, ["succeeds"], SILENT))["results"]
        assert result["probability"] == 1.0


async def test_a_result_is_stale_after_a_change_of_the_data_of_a_mock(tree: Path) -> None:
    """Verified again, the property has the value with the new data."""
    late = '<Timeout msec="2000"><FollowPath path="{path}"/></Timeout>'
    tree.write_text(TREE.replace('<FollowPath path="{path}"/>', late), encoding="utf-8")
    tree.with_suffix(".mocks").write_text("FollowPath: 1 in histogram('times.csv', s)\nWait: 0\n", encoding="utf-8")
    data = tree.parent / "times.csv"
    data.write_text("1\n", encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        for probability in (1.0, 0.0):
            (result,) = (await verify(client, tree, ["succeeds"], SILENT))["results"]
            assert result["probability"] == probability
            view = (await ask(client, PROPERTIES, None))[0]["properties"][0]["view"]
            assert view["since"] == ""
            data.write_text("3\n" if probability else "1\n", encoding="utf-8")
            client.changed(data)
            view = (await ask(client, PROPERTIES, None))[0]["properties"][0]["view"]
            assert view["since"] == "stale: times.csv has changed since the verification"


async def test_the_view_of_a_result_has_the_words_of_the_report(tree: Path) -> None:
    beside = tree.with_suffix(".mocks")
    beside.write_text("FollowPath: 0.5 in 1 s\nWait: 0.5 in 1 s\n", encoding="utf-8")
    options = {**COMMANDS, "settings": {"verify": {"expectations": {"succeeds": ">= 0.9"}}}}
    async with connect(tree.parent, options=options) as client:
        client.open(tree, language="xml")
        await verify(client, tree, [], SILENT)
        view = (await ask(client, PROPERTIES, None))[0]["properties"][0]["view"]
        assert (view["mark"], view["since"], view["counterexample"], view["epsilon"]) == ("failed", "", True, 0)
        assert view["lines"][0].startswith("= 0.75 for all schedulers, exact")
        assert any(line.startswith("expected ≥ 0.9: NOT MET") for line in view["lines"])
        assert view["trace"] is not None
        client.open(beside, "FollowPath: 1\nWait: 1\n", language="mocks")
        view = (await ask(client, PROPERTIES, None))[0]["properties"][0]["view"]
        assert view["since"] == "stale: tree.mocks has changed since the verification"


async def test_mocks_that_are_edited_get_no_lines(tree: Path) -> None:
    """The user may be typing the line that is missing."""
    beside = tree.with_suffix(".mocks")
    beside.write_text("Wait: 1\n", encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(beside, "Wait: 0\n", language="mocks")
        (result,) = (await verify(client, tree, ["succeeds"], SILENT))["results"]
        assert result["probability"] == pytest.approx(0.9)
        assert "1 leaf without a mock in tree.mocks: proposed values were used." in client.messages[-1].message
        assert beside.read_text(encoding="utf-8") == "Wait: 1\n"


@pytest.mark.parametrize(
    ("text", "reason"), [("Wait 1\n", "`Wait 1` is not a mock"), ("Wait: 2\n", "not a probability")]
)
async def test_mocks_that_are_not_valid_are_named(tree: Path, text: str, reason: str) -> None:
    tree.with_suffix(".mocks").write_text(text, encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        answer = await verify(client, tree, [], SILENT)
        assert reason in answer["errors"][0]["message"]
        assert reason in (await ask(client, MOCKS, document(tree)))["problem"]


async def test_the_lenses_of_a_tree_in_a_system(tmp_path: Path) -> None:
    robot = tmp_path / "robot"
    shutil.copytree(EXAMPLES / "assembly_robot", robot)
    for main in robot.glob("main_*.xml"):
        main.unlink()
    async with connect(robot, options=COMMANDS) as client:
        client.open(robot / "tree.xml", language="xml")
        shown = await lenses(client, robot / "tree.xml")
        assert [title for title in shown if title in ("Run", "Debug", "Verify", "Mocks")] == ["Run", "Debug", "Verify"]
        assert await ask(client, MOCKS, document(robot / "tree.xml")) is None


async def test_subtrees_have_lenses_of_the_tree_that_uses_them(tree: Path) -> None:
    subtree = '<BehaviorTree ID="Approach"><AlwaysSuccess/></BehaviorTree>'
    unused = '<BehaviorTree ID="Unused"><AlwaysSuccess/></BehaviorTree>'
    text = TREE.replace("<Fallback>", '<Fallback><SubTree ID="Approach"/>').replace(
        "</root>", f"{subtree}{unused}</root>"
    )
    tree.write_text(text.replace("<root", '<root main_tree_to_execute="Main"'), encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        in_main = ["Run in Main", "Debug in Main", "Verify in Main"]
        assert await lenses(client, tree) == ["Run", "Debug", "Verify", "Mocks", *in_main]
        await verify(client, tree, [], SILENT)
        assert (await lenses(client, tree))[-1].startswith("Verify in Main · 1, exact")


async def test_a_tree_with_errors_cannot_be_run(tree: Path) -> None:
    tree.write_text(TREE.replace("</Fallback>", "<Inverter/></Fallback>"), encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        assert await lenses(client, tree) == ["1 error: cannot be run or verified"]


async def test_clients_without_commands_only_verify(tree: Path) -> None:
    async with connect(tree.parent) as client:
        client.open(tree, language="xml")
        assert await lenses(client, tree) == ["Verify"]


async def set_mock(client: Client, tree: Path, **values: object) -> Any:
    return await ask(client, SET_MOCK, document(tree, **values))


def edited(answer: Any) -> list[tuple[int, int, str]]:
    (edits,) = answer["edit"]["changes"].values()
    return [(edit["range"]["start"]["line"], edit["range"]["end"]["character"], edit["newText"]) for edit in edits]


async def test_mocks_are_shown_and_edited(tree: Path) -> None:
    beside = tree.with_suffix(".mocks")
    beside.write_text("# mine\n  Wait: 0.5 in 1 s   # slow\n*: 0.9\n", encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        known = await ask(client, MOCKS, document(tree))
        assert (known["uri"], known["exists"]) == (beside.as_uri(), True)
        follow, wait = known["rows"]
        assert (follow["pattern"], follow["origin"], follow["probability"]) == ("FollowPath", "from `*`", 0.9)
        assert (wait["pattern"], wait["origin"], wait["milliseconds"]) == ("Wait", "", 1000)
        answer = await set_mock(client, tree, pattern="Wait", probability=0.25, milliseconds=1500)
        assert edited(answer) == [(1, 18, "Wait: 0.25 in 1.5 s")]
        answer = await set_mock(client, tree, pattern="FollowPath", probability=1, milliseconds=0)
        assert edited(answer) == [(3, 0, "FollowPath: 1\n")]
        assert "no leaf has the name" in (await set_mock(client, tree, pattern="Nothing"))["problem"]
        assert "from 0 to 1" in (await set_mock(client, tree, pattern="Wait", probability=2))["problem"]


async def test_an_edit_keeps_the_mocks_of_nodes_with_children(tree: Path) -> None:
    """A leaf and a node with children can have the same name."""
    nodes = "<Sequence><Own><Own/></Own><Lock><AlwaysSuccess/></Lock></Sequence>"
    tree.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="M">{nodes}</BehaviorTree></root>', "utf-8")
    tree.with_suffix(".mocks").write_text("Own: as Inverter\n*: 0.9\n", encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        answer = await set_mock(client, tree, pattern="Own", probability=0.25, milliseconds=0)
        assert edited(answer) == [(2, 0, "Own: 0.25\n")]
        assert "no leaf has the name" in (await set_mock(client, tree, pattern="Lock", probability=1))["problem"]


async def test_an_edit_keeps_a_drawn_duration(tree: Path) -> None:
    beside = tree.with_suffix(".mocks")
    beside.write_text("Wait: 0.5 in normal(1 s, 200 ms)\n*: 0.9\n", encoding="utf-8")
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        _, wait = (await ask(client, MOCKS, document(tree)))["rows"]
        assert wait["milliseconds"] is None
        answer = await set_mock(client, tree, pattern="Wait", probability=0.25, milliseconds=None)
        assert edited(answer) == [(0, 32, "Wait: 0.25 in normal(1 s, 200 ms)")]


async def test_the_first_edit_creates_the_file_with_all_proposals(tree: Path) -> None:
    async with connect(tree.parent, options=COMMANDS) as client:
        client.open(tree, language="xml")
        known = await ask(client, MOCKS, document(tree))
        assert [(row["pattern"], row["origin"]) for row in known["rows"]] == [
            ("FollowPath", "proposed"),
            ("Wait", "proposed"),
        ]
        answer = await set_mock(client, tree, pattern="Wait", probability=0.5, milliseconds=500)
        text = str(answer["edit"])
        assert "FollowPath: 0.9 in 10 s  # action" in text
        assert "Wait: 0.5 in 500 ms  # action: waiting" in text
