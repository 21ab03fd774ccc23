# SPDX-License-Identifier: Apache-2.0
"""Systems with several trees (docs/spec/trees.md#several-trees)."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from mending import applied
from roaml import api
from roaml.api.mocked_systems import mock_system
from roaml.debugging.sources import Sources
from roaml.debugging.start import Start, start
from roaml.diagnostics import Severity, Symbol
from roaml.ide.code_actions import actions
from roaml.ide.describe import describe
from roaml.ide.diagrams.ros import ros_picture
from roaml.ide.diagrams.tree import tree_picture
from roaml.ide.expectation import is_written_in_file
from roaml.ide.names.lookup import symbol_group, symbol_group_at
from roaml.ide.rename import RenameRefusal, Renaming, rename
from roaml.ide.verifiable import expected_beside, verifiable
from roaml.jani.writer import write
from roaml.mocks.mock import MockError, read_mock
from roaml.roles import SymbolKind
from roaml.text import Span, apply_edits

FLEET = Path(__file__).resolve().parents[2] / "examples" / "fleet"
DELIVERS = {"anna": 0.9 * 0.99, "bert": 0.9 * 0.99, "carl": 0.9 * 0.75}
"""Robot -> the probability that it delivers: it is not blocked, and the parcel slips at most once in two attempts."""


NODE_PORT = """<ports><bt_node node="{}" event="response">
            <state_var id="status" type="int32" field="status" expr="0" />
        </bt_node>"""
"""The begin of ports with a node of a tree."""


@pytest.fixture
def fleet(tmp_path: Path) -> Path:
    shutil.copytree(FLEET, tmp_path / "fleet")
    return tmp_path / "fleet"


def jani(main: Path) -> str:
    return "".join(write(api.to_jani(api.load(str(main)))))


def exact(capsys: pytest.CaptureFixture[str], main: Path, *options: str) -> Mapping[str, tuple[float, float]]:
    """Property -> its minimum and maximum over all schedulers."""
    capsys.readouterr()
    run(["verify", str(main), "--exhaustive", "--format", "json", "--jobs", "1", *options])
    results = json.loads(capsys.readouterr().out)["results"]
    return {result["property"]: (result["exact"]["least"], result["exact"]["greatest"]) for result in results}


def problems(main: Path) -> list[str]:
    return [d.message for d in api.check([str(main)]).diagnostics if d.severity >= Severity.WARNING]


# ------------------------------------------------------------------- the example


def test_the_fleet_has_the_probabilities_of_closed_forms(capsys: pytest.CaptureFixture[str]) -> None:
    assert problems(FLEET / "main.xml") == []
    values = exact(capsys, FLEET / "main.xml")
    everyone = DELIVERS["anna"] * DELIVERS["bert"] * DELIVERS["carl"]
    assert values.keys() == {"all_deliver", *(f"{robot}_delivers" for robot in DELIVERS)}
    assert values["all_deliver"] == pytest.approx((everyone, everyone), abs=1e-9)
    for robot, value in DELIVERS.items():
        assert values[f"{robot}_delivers"] == pytest.approx((value, value), abs=1e-9)


@pytest.mark.parametrize("robot", DELIVERS)
def test_each_robot_alone_has_the_same_value(robot: str, fleet: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A system with one tree without a name, written by hand."""
    slips = "0.5" if robot == "carl" else "0.1"
    rate = "2" if robot == "bert" else "1"
    for path, old, new in (
        ("plugins/hand_over.ascxml", 'value="0.1"', f'value="{slips}"'),
        ("delivers.xml", "/$(var robot)/delivered", "delivered"),
    ):
        text = (fleet / path).read_text(encoding="utf-8")
        assert old in text
        (fleet / path).write_text(text.replace(old, new), encoding="utf-8")
    (fleet / "main.xml").write_text(
        f"""<roaml>
    <parameters>
        <max_time value="6" unit="s" reaction_time="instant" />
        <bt_tick_rate value="{rate}" />
    </parameters>
    <behavior_tree tree-semantics="behaviortree-cpp">
        <input type="bt.cpp-xml" src="deliver.xml" />
        <input type="bt-plugin-ascxml" src="plugins/drive.ascxml" />
        <input type="bt-plugin-ascxml" src="plugins/hand_over.ascxml" />
    </behavior_tree>
    <node_models><input type="node-ascxml" src="base.ascxml" /></node_models>
    <properties><input type="xml" src="delivers.xml" /></properties>
</roaml>
""",
        encoding="utf-8",
    )
    assert exact(capsys, fleet / "main.xml")["anna_delivers"] == pytest.approx((DELIVERS[robot],) * 2, abs=1e-9)


def test_values_from_outside_are_for_one_tree_or_for_all(capsys: pytest.CaptureFixture[str]) -> None:
    one = ("--property", "carl_delivers", "--property", "anna_delivers", "--set", "carl.slips=0.3")
    values = exact(capsys, FLEET / "main.xml", *one)
    assert values["carl_delivers"][0] == pytest.approx(0.9 * (1 - 0.3**2), abs=1e-9)
    assert values["anna_delivers"][0] == pytest.approx(DELIVERS["anna"], abs=1e-9)
    every = ("--property", "anna_delivers", "--set", "HandOver.slips=0.3")
    assert exact(capsys, FLEET / "main.xml", *every)["anna_delivers"][0] == pytest.approx(0.819, abs=1e-9)


def test_the_expanded_files_have_the_same_translation(fleet: Path, tmp_path: Path) -> None:
    plain = tmp_path / "plain"
    assert run(["translate", str(fleet / "main.xml"), "--expand", str(plain), "-o", str(tmp_path / "x.jani")]) == 0
    assert {path.name for path in (plain / "plugins").iterdir()} == {
        f"{robot}_{plugin}.ascxml" for robot in DELIVERS for plugin in ("drive", "hand_over")
    }
    assert jani(plain / "main.xml") == jani(fleet / "main.xml")


def test_automata_are_named_after_their_tree() -> None:
    names = {automaton.name for automaton in api.to_jani(api.load(str(FLEET / "main.xml"))).automata}
    for robot, number in (("anna", 1000), ("bert", 2000), ("carl", 3000)):
        assert {f"bt_root_fsm_{robot}", f"bt_blackboard_fsm_{robot}", f"{robot}_base"} <= names
        assert f"BT_plugin_{number + 1}_{robot}.Drive" in names
        assert f"bt_blackboard_set_{robot}__place" in names


def test_pictures_show_the_trees() -> None:
    analysis = api.check([str(FLEET / "main.xml")]).snapshot.analysis
    graph = ros_picture(analysis, str(FLEET / "main.xml"))
    assert graph is not None
    titles = {node.label for node in graph.nodes}
    assert {f"{robot}.Drive" for robot in DELIVERS} | {f"/{robot}/go_to" for robot in DELIVERS} <= titles
    edges = {(edge.source.rpartition("/")[2], edge.target) for edge in graph.edges}
    assert len([edge for edge in edges if edge[0] == "drive.ascxml"]) == len(DELIVERS)
    tree = tree_picture(analysis, str(FLEET / "main.xml"))
    assert tree is not None
    assert {f"{robot} : Deliver" for robot in DELIVERS} <= {node.label for node in tree.nodes}


def test_each_tree_has_a_stack_in_the_debugger() -> None:
    system = api.load(str(FLEET / "main.xml"))
    debugger = start(Sources(api.as_target(system), system.analysis), Start(), lambda *_: None)
    assert [thread.name for thread in debugger.threads[:4]] == [*(f"tree {robot}" for robot in DELIVERS), "anna_base"]
    stacks = {thread.name: debugger.stacks.stack(thread) for thread in debugger.threads}
    for robot in DELIVERS:
        assert [frame.name for frame in stacks[f"tree {robot}"]] == [f"{robot}.Sequence: IDLE"]
    texts = set()
    while debugger.session.step() and "the tree carl begins its next tick" not in texts:
        texts |= {choice.text for choice in debugger.session.choices()}
    assert "the tree begins its next tick" not in texts
    assert "the tree bert begins its next tick" in texts


# ----------------------------------------------------------------------- editing


def test_the_name_of_a_tree_is_a_definition_with_a_description(fleet: Path) -> None:
    analysis = api.check([str(fleet / "main.xml")]).snapshot.analysis
    symbol = Symbol(str(fleet / "deliver.xml"), SymbolKind.MACHINE, "bert")
    assert [Path(place.path).name for place in symbol_group(analysis, (symbol,)).definitions] == ["main.xml"]
    shown = describe(analysis, symbol)
    assert "tree bert : Deliver" in shown
    assert "Ticked at 2 Hz" in shown
    assert "Plugins `Drive`, `HandOver`" in shown


def test_a_tree_is_renamed_with_its_references(fleet: Path) -> None:
    properties = fleet / "delivers.xml"
    text = properties.read_text(encoding="utf-8").replace("<ports>", NODE_PORT.format("bert/Sequence"))
    properties.write_text(text, encoding="utf-8")
    main = fleet / "main.xml"
    listed = main.read_text(encoding="utf-8").replace('hand_over.ascxml" />', 'hand_over.ascxml" />\n<x />')
    other = '<input type="bt-plugin-ascxml" src="plugins/look.ascxml" tree="bert" />'
    main.write_text(listed.replace("<x />", other), encoding="utf-8")
    look = (fleet / "plugins" / "drive.ascxml").read_text(encoding="utf-8").replace('"Drive"', '"Look"')
    (fleet / "plugins" / "look.ascxml").write_text(look, encoding="utf-8")
    formulas = fleet / "all_deliver.jani"
    variable = '"bt_blackboard_set_bert__place__value"'
    formulas.write_text(formulas.read_text(encoding="utf-8").replace('"bt_2000_response__status"', variable), "utf-8")
    analysis = api.check([str(main)]).snapshot.analysis
    renaming = rename(analysis, str(main), main.read_text(encoding="utf-8").index('"bert"') + 1, "bob")
    assert isinstance(renaming, Renaming), renaming
    for changed, edits in renaming.edits.items():
        Path(changed).write_text(apply_edits(Path(changed).read_text("utf-8"), tuple(edits)), "utf-8")
    assert 'name="bob" namespace="bert"' in main.read_text(encoding="utf-8")
    assert 'tree="bob"' in main.read_text(encoding="utf-8")
    assert '"bob/Sequence"' in properties.read_text(encoding="utf-8")
    assert "bt_blackboard_set_bob__place__value" in formulas.read_text(encoding="utf-8")


def test_a_node_of_a_shared_tree_file_is_renamed_for_all_trees(fleet: Path) -> None:
    tree = fleet / "deliver.xml"
    tree.write_text(tree.read_text(encoding="utf-8").replace("<Sequence>", '<Sequence name="top">'), encoding="utf-8")
    properties = fleet / "delivers.xml"
    text = properties.read_text(encoding="utf-8").replace("<ports>", NODE_PORT.format("bert/top"))
    properties.write_text(text, encoding="utf-8")
    analysis = api.check([str(fleet / "main.xml")]).snapshot.analysis
    renaming = rename(analysis, str(properties), text.index("/top") + 2, "all")
    assert isinstance(renaming, Renaming), renaming
    assert {Path(path).name for path in renaming.edits} == {"deliver.xml", "delivers.xml"}


@pytest.mark.parametrize(("place", "new"), [("/top", "all"), ("/top", "bert"), ("/Drive", "Go")])
def test_a_node_after_a_parameter_is_renamed(place: str, new: str, fleet: Path) -> None:
    """The name of the tree comes from a parameter, and that of the node is written in the path."""
    replaced(fleet / "deliver.xml", ("<Sequence>", '<Sequence name="top">'))
    properties = fleet / "delivers.xml"
    ports = NODE_PORT.format(f"$(var robot){place}")
    replaced(properties, ("<ports>", ports), ("place == 2", "place == 2 &amp;&amp; status == 1"))
    assert problems(fleet / "main.xml") == []
    before = jani(fleet / "main.xml")
    analysis = api.check([str(fleet / "main.xml")]).snapshot.analysis
    at = properties.read_text(encoding="utf-8").index(place) + 1
    renaming = rename(analysis, str(properties), at, new)
    if new == "bert":
        assert isinstance(renaming, RenameRefusal)
        return
    assert isinstance(renaming, Renaming), renaming
    for changed, edits in renaming.edits.items():
        Path(changed).write_text(apply_edits(Path(changed).read_text("utf-8"), tuple(edits)), "utf-8")
    assert f"$(var robot)/{new}" in properties.read_text(encoding="utf-8")
    assert problems(fleet / "main.xml") == []
    assert jani(fleet / "main.xml") == re.sub(rf"\b{place[1:]}\b", new, before)


def test_a_tree_that_a_parameter_names_is_not_renamed(fleet: Path) -> None:
    main = fleet / "main.xml"
    at = main.read_text(encoding="utf-8").index('"bert"') + 1

    def renamed() -> Renaming | RenameRefusal:
        return rename(api.check([str(main)]).snapshot.analysis, str(main), at, "bob")

    assert isinstance(renamed(), Renaming)
    replaced(fleet / "delivers.xml", ("<ports>", NODE_PORT.format("$(var robot)/Drive")))
    refusal = renamed()
    assert isinstance(refusal, RenameRefusal)
    assert refusal.reason.startswith("`delivers.xml` takes the name `bert` from the value of a parameter")


# ---------------------------------------------------------------- what is reported

FIRST, SECOND = 'name="anna" namespace="anna"', 'name="bert" namespace="bert" tick_rate="2"'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (FIRST, "", "needs a `name`"),
        (SECOND, 'name="anna" namespace="bert"', "there are two trees `anna`"),
        (SECOND, 'name="b__c" namespace="bert"', "`b__c` cannot be the name of a tree"),
        (SECOND, 'name="b_" namespace="bert"', "`b_` cannot be the name of a tree"),
        (SECOND, 'name="2b" namespace="bert"', "`2b` cannot be the name of an instance"),
        ('name="slips"', 'name="slip"', "no plugin of this tree has a parameter `slip`"),
        ("</input>", '<remap from="nothing" to="x" /></input>', "no topic, service, action or event `nothing`"),
        ('drive.ascxml"', 'drive.ascxml" tree="anne"', "there is no tree `anne`; did you mean `anna`?"),
        ('drive.ascxml"', 'drive.ascxml" tree="anna"', "the tree `bert` uses `Drive`, too"),
        (SECOND, f'{SECOND[:-3]}"0.1"', "the tree is never ticked"),
    ],
)
def test_mistakes_are_reported(old: str, new: str, message: str, fleet: Path) -> None:
    main = fleet / "main.xml"
    text = main.read_text(encoding="utf-8")
    assert old in text
    main.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert [found for found in problems(main) if message in found]


def replaced(path: Path, *changes: tuple[str, str]) -> None:
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (SECOND, 'namespace="bert"'),
        (SECOND, 'name="anna" namespace="bert"'),
        (SECOND, 'name="bert robot" namespace="bert"'),
        ('drive.ascxml"', 'drive.ascxml" tree="anne"'),
    ],
)
def test_a_wrong_name_of_a_tree_is_one_mistake(old: str, new: str, fleet: Path) -> None:
    """Neither the copies of the plugins for the trees nor the topics of these are reported."""
    replaced(fleet / "main.xml", (old, new))
    assert len(problems(fleet / "main.xml")) == 1


def test_a_plugin_can_be_listed_for_each_tree(fleet: Path, capsys: pytest.CaptureFixture[str]) -> None:
    drive = '<input type="bt-plugin-ascxml" src="plugins/drive.ascxml"'
    for_each = "\n        ".join(f'{drive} tree="{robot}" />' for robot in DELIVERS)
    before = jani(fleet / "main.xml")
    replaced(fleet / "main.xml", (f"{drive} />", for_each))
    assert problems(fleet / "main.xml") == []
    assert jani(fleet / "main.xml") == before


def test_scripts_of_all_trees_create_entries(fleet: Path) -> None:
    tree = ("<Sequence>", '<Sequence><Script code="tries := 0" />'), ("<Drive ", '<Drive _onSuccess="tries += 1" ')
    replaced(fleet / "deliver.xml", *tree)
    assert problems(fleet / "main.xml") == []
    replaced(fleet / "deliver.xml", ("tries := 0", "trys := 0"))
    assert len(problems(fleet / "main.xml")) == 1


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            '"{place}" />\n            </R',
            '"{plase}" />\n            </R',
            "no node writes the blackboard variable `plase`",
        ),
        ('HandOver place="{place}"', 'HandOver place="2"', "no node reads the blackboard variable `place`"),
        ('HandOver place="{place}"', 'HandOver place="{plase}"', "variable `place`; did you mean `plase`?"),
        ('Drive place="2"', 'Drive place="{place}"', '`place="{place}"` in the tree binds the port'),
    ],
)
def test_a_variable_is_shown_as_in_its_tree(old: str, new: str, message: str, fleet: Path) -> None:
    """Messages name a variable without the name of its tree, and each mistake is reported once
    for all robots."""
    replaced(fleet / "deliver.xml", (old, new))
    assert len([found for found in problems(fleet / "main.xml") if message in found]) == 1


def test_files_with_different_trees_of_one_name_are_reported(fleet: Path) -> None:
    shutil.copy(fleet / "deliver.xml", fleet / "other.xml")
    main = fleet / "main.xml"
    text = main.read_text(encoding="utf-8")
    main.write_text(text.replace('src="deliver.xml" name="carl"', 'src="other.xml" name="carl"'), encoding="utf-8")
    assert [found for found in problems(main) if "two trees are called `Deliver`" in found]


# ------------------------------------------------------------------------- mocks

HAND_OVER = '        <input type="bt-plugin-ascxml" src="plugins/hand_over.ascxml" />\n'
VALUE = """            <param name="slips" value="0.5" />
"""


def without_hand_over(fleet: Path) -> Path:
    """The fleet without the plugin that hands over, with a property for each tree: it succeeds."""
    replaced(fleet / "main.xml", (HAND_OVER, ""), (VALUE, ""), ("delivers.xml", "ignored.xml"))
    text = (fleet / "main.xml").read_text(encoding="utf-8")
    text = re.sub(r'<input type="xml" src="ignored.xml">.*?</input>', "", text, flags=re.DOTALL)
    (fleet / "main.xml").write_text(text, encoding="utf-8")
    properties = [
        {
            "name": robot,
            "expression": {
                "op": "filter",
                "fun": "values",
                "values": {
                    "op": "Pmin",
                    "exp": {
                        "op": "F",
                        "exp": {"op": "=", "left": f"bt_{number}_response__status", "right": 1},
                    },
                },
                "states": {"op": "initial"},
            },
        }
        for number, robot in ((1000, "anna"), (2000, "bert"), (3000, "carl"))
    ]
    (fleet / "all_deliver.jani").write_text(json.dumps({"properties": properties}), encoding="utf-8")
    return fleet / "main.xml"


def test_mocks_are_for_all_trees_or_for_one(fleet: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = without_hand_over(fleet)
    one = ("--mock", "HandOver: 0.9", "--mock", "carl/HandOver: 0.5")
    values = exact(capsys, main, *one)
    for robot, expected in DELIVERS.items():
        assert values[robot] == pytest.approx((expected, expected), abs=1e-9), robot
    whole = ("--mock", "carl/*: 0.5", "--mock", "*: 0.9")
    assert exact(capsys, main, *whole) == values


def test_the_duration_of_a_mock_has_the_rate_of_each_tree(fleet: Path) -> None:
    """Bert is ticked twice as often, so its mock is another plugin; the others share one."""
    main = without_hand_over(fleet)
    planned = mock_system(str(main), (read_mock("HandOver: 1 in 2 s"),)).planned
    assert {(mock.trees, Path(mock.path).name) for mock in planned} == {
        (("anna", "carl"), "mock_anna_hand_over.ascxml"),
        (("bert",), "mock_bert_hand_over.ascxml"),
    }
    texts = {mock.trees[0]: mock.text for mock in planned}
    assert "for 2 ticks" in texts["anna"]
    assert "for 4 ticks" in texts["bert"]


def test_a_mock_belongs_to_the_trees_without_a_plugin(fleet: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = without_hand_over(fleet)
    replaced(main, ("    </behavior_tree>", HAND_OVER.replace(" />", ' tree="anna" />') + "    </behavior_tree>"))
    values = exact(capsys, main, "--mock", "HandOver: 1")
    assert values["anna"] == pytest.approx((DELIVERS["anna"],) * 2, abs=1e-9)
    assert values["bert"] == values["carl"] == pytest.approx((0.9, 0.9), abs=1e-9)


def test_defaults_of_mocks_are_declared_in_the_files_of_all_trees(fleet: Path) -> None:
    """In one of the trees, a node sets a port that the others do not set."""
    main = without_hand_over(fleet)
    text = (fleet / "deliver.xml").read_text(encoding="utf-8").replace('ID="Deliver"', 'ID="Other"')
    (fleet / "other.xml").write_text(text.replace("<HandOver ", '<HandOver gently="true" '), encoding="utf-8")
    replaced(main, ('src="deliver.xml" name="carl"', 'src="other.xml" name="carl"'))
    mocked = mock_system(str(main), (read_mock("*: 1"),))
    api.to_jani(api.load(str(main), texts=mocked.texts))


def test_a_mock_that_matches_nothing_in_its_tree_is_named(fleet: Path) -> None:
    mocks = tuple(map(read_mock, ("*: 1", "anna/HandOver: 1", "ana/*: 1", "a*: 1", "anna/Lift: 1", "c*/Hand*: 1")))
    words = mock_system(str(without_hand_over(fleet)), mocks).words
    assert {mock.pattern: reason for mock in mocks if (reason := words.why_unused(mock))} == {
        "ana/*": "matches no node of the trees; remove it",
        "a*": "matches no node of the trees; remove it",
        "anna/Lift": "matches no node of the trees; did you mean `anna/Drive`?",
    }


def test_a_mock_of_a_name_that_is_not_used_is_named(fleet: Path) -> None:
    """Nodes of a type share a plugin, so a name among several has no mock of its own; neither in the picture."""
    main = without_hand_over(fleet)
    hand_over = '<HandOver place="{place}" />'
    two = f'<Sequence><HandOver name="give" place="{{place}}" />{hand_over}</Sequence>'
    replaced(fleet / "deliver.xml", (hand_over, two))
    mocks = tuple(map(read_mock, ("give: 0.5", "bert/gi*: 0.5", "HandOver: 0.9")))
    mocked = mock_system(str(main), mocks)
    assert [mocked.words.why_unused(mock).partition(",")[0] for mock in mocks] == ["is for one name"] * 2 + [""]
    assert {mock.mock.pattern for mock in mocked.planned} == {"HandOver"}
    picture = tree_picture(api.check([str(main)]).snapshot.analysis, str(main), mocks)
    assert picture is not None
    shown = {detail.text for node in picture.nodes for detail in node.details if "mock" in detail.text}
    assert shown == {"mock: 0.9"}


def test_a_mock_of_a_node_with_a_plugin_is_named(fleet: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """All trees list a plugin for `Drive`, one of them for `HandOver`."""
    main = without_hand_over(fleet)
    replaced(main, ("    </behavior_tree>", HAND_OVER.replace(" />", ' tree="anna" />') + "    </behavior_tree>"))
    patterns = ("Drive", "Dr*", "carl/Drive", "anna/HandOver", "HandOver", "*")
    mocks = tuple(read_mock(f"{pattern}: 0.5") for pattern in patterns)
    words = mock_system(str(main), mocks).words
    reasons = {mock.pattern for mock in mocks if "lists a plugin for the node" in words.why_unused(mock)}
    assert reasons == {"Drive", "Dr*", "carl/Drive", "anna/HandOver"}
    assert not any(words.why_unused(mock) for mock in mocks if mock.pattern not in reasons)
    run(["verify", str(FLEET / "main.xml"), "--mock", "Drive: 0.5", "--property", "anna_delivers"])
    notes = capsys.readouterr().err
    assert "the mock `Drive` is not used, because the system lists a plugin" in notes
    assert "uses mocks for" not in notes


@pytest.mark.parametrize("pattern", ["Lock", "outer", "*", "carl/Lock", "carl/*"])
def test_own_nodes_with_children_need_plugins(pattern: str, fleet: Path) -> None:
    main = without_hand_over(fleet)
    replaced(
        fleet / "deliver.xml", ("<Sequence>", '<Lock name="outer"><Sequence>'), ("</Sequence>", "</Sequence></Lock>")
    )
    mocks = (read_mock("*: 1"), read_mock(f"{pattern}: as Sequence"))
    with pytest.raises(MockError, match="cannot be used for `Lock`: in a system, a node with children needs a plugin"):
        mock_system(str(main), mocks)
    assert mock_system(str(main), (read_mock("*: 1"), read_mock("dora/Lock: as Sequence"))).planned


def test_the_picture_shows_the_mocks_of_each_tree(fleet: Path) -> None:
    main = without_hand_over(fleet)
    mocks = tuple(map(read_mock, ("HandOver: 0.9", "carl/HandOver: 0.5")))
    picture = tree_picture(api.check([str(main)]).snapshot.analysis, str(main), mocks)
    assert picture is not None
    shown = [(detail.text, node.id) for node in picture.nodes for detail in node.details if "mock" in detail.text]
    assert shown == [("mock: 0.9", "1003"), ("mock: 0.9", "2003"), ("mock: 0.5", "3003")]


def test_an_event_of_a_shared_node_has_one_probability(fleet: Path) -> None:
    main = without_hand_over(fleet)
    replaced(
        fleet / "deliver.xml",
        ("<HandOver ", "<GoalUpdatedController><HandOver "),
        ('"{place}" />\n            </R', '"{place}" /></GoalUpdatedController>\n            </R'),
    )
    mocks = tuple(map(read_mock, ("HandOver: 1", "anna/GoalUpdatedController: 0.5", "GoalUpdatedController: 0.5")))
    assert mock_system(str(main), mocks).events == 1
    with pytest.raises(
        MockError, match="`anna/GoalUpdatedController` and `GoalUpdatedController` give different probabilities"
    ):
        mock_system(str(main), (*mocks[:2], read_mock("GoalUpdatedController: 0.4")))


def test_an_action_creates_mocks_for_all_trees(fleet: Path) -> None:
    """The plugins of a type that only some trees lack belong to these."""
    main, tree = without_hand_over(fleet), fleet / "deliver.xml"
    replaced(main, ("    </behavior_tree>", HAND_OVER.replace(" />", ' tree="anna" />') + "    </behavior_tree>"))
    snapshot = api.check([str(main)]).snapshot
    at = tree.read_text(encoding="utf-8").index("<HandOver") + 1
    offered = actions(snapshot, str(tree), Span(at, at), lambda _: True)
    (action,) = (action for action in offered if action.title == "Create a mock of `HandOver`")
    for path, text in applied(snapshot, action.make()).items():
        Path(path).write_text(text, encoding="utf-8")
    listed = re.findall(r'src="(mock_[a-z_]*.ascxml)" tree="([a-z]*)"', main.read_text(encoding="utf-8"))
    assert listed == [("mock_bert_hand_over.ascxml", "bert"), ("mock_carl_hand_over.ascxml", "carl")]
    api.load(str(main))


def test_mocks_in_an_experiment(fleet: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = without_hand_over(fleet)
    options = ["--property", "carl", "--mock", "*: 0.5", "--set", "carl_base.blocked=0.1,0.2", "--format", "json"]
    assert run(["experiment", str(main), "--jobs", "1", *options]) == 0
    points = json.loads(capsys.readouterr().out)["points"]
    assert [point["value"] for point in points] == pytest.approx([0.9 * 0.75, 0.8 * 0.75], abs=1e-9)


# ----------------------------------------------------------------------- meaning


SHOW = """<ascxml name="Show" version="1.0" initial="on">
    <bt_declare_port_in key="value" type="int32" />
    <ros_topic_publisher name="shown" topic="shown" type="std_msgs/Int32" />
    <datamodel><data id="last" type="int32" expr="0" /></datamodel>
    <state id="on">
        <bt_tick target="on">
            <assign location="last"><expr><bt_get_input key="value" /></expr></assign>
            <ros_topic_publish name="shown"><field name="data" expr="last" /></ros_topic_publish>
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="on"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
"""
PUT = """<ascxml name="Put" version="1.0" initial="on">
    <parameter name="number" type="int32" value="1" />
    <bt_declare_port_out key="value" type="int32" />
    <state id="on">
        <bt_tick target="on">
            <bt_set_output key="value" expr="number" />
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="on"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
"""
TREE = """<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <Sequence><Put value="{v}" /><SubTree ID="Inner" /></Sequence>
    </BehaviorTree>
    <BehaviorTree ID="Inner"><Show value="{@v}" /></BehaviorTree>
</root>
"""


def small(folder: Path, semantics: str, trees: str, expression: str, max_time: int = 1) -> Path:
    (folder / "show.ascxml").write_text(SHOW, encoding="utf-8")
    (folder / "put.ascxml").write_text(PUT, encoding="utf-8")
    (folder / "tree.xml").write_text(TREE, encoding="utf-8")
    states = {"op": "initial"}
    written = {"op": "Pmin", "exp": json.loads(expression)}
    property_ = {"name": "p", "expression": {"op": "filter", "fun": "values", "values": written, "states": states}}
    (folder / "p.jani").write_text(json.dumps({"properties": [property_]}), encoding="utf-8")
    main = folder / "main.xml"
    main.write_text(
        f"""<roaml>
    <parameters><max_time value="{max_time}" unit="s" /></parameters>
    <behavior_tree tree-semantics="{semantics}">
        {trees}
        <input type="bt-plugin-ascxml" src="put.ascxml" />
        <input type="bt-plugin-ascxml" src="show.ascxml" />
    </behavior_tree>
    <properties><input type="jani" src="p.jani" /></properties>
</roaml>
""",
        encoding="utf-8",
    )
    return main


TWO = """<input type="bt.cpp-xml" src="tree.xml" name="a" namespace="a" />
        <input type="bt.cpp-xml" src="tree.xml" name="b" namespace="b"><param name="number" value="2" /></input>"""


@pytest.mark.parametrize("semantics", ["behaviortree-cpp", "as2fm"])
def test_each_tree_has_its_own_blackboard(semantics: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Whatever the order of the steps of both trees, none reads what the other one, or nothing, has written: each
    message has the number of its tree."""
    wrong = [
        {
            "op": "∧",
            "left": f"topic_{tree}__shown_msg.valid",
            "right": {"op": "≠", "left": f"topic_{tree}__shown_msg__ros_fields__data", "right": number},
        }
        for tree, number in (("a", 1), ("b", 2))
    ]
    never = {"op": "G", "exp": {"op": "¬", "exp": {"op": "∨", "left": wrong[0], "right": wrong[1]}}}
    main = small(tmp_path, semantics, TWO, json.dumps(never))
    assert exact(capsys, main)["p"] == (1, 1)
    both = {"op": "∧", "left": "topic_a__shown_msg.valid", "right": "topic_b__shown_msg.valid"}
    main = small(tmp_path, semantics, TWO, json.dumps({"op": "F", "exp": both}))
    assert exact(capsys, main, "--reaction-time", "instant")["p"] == (1, 1)


def test_a_tree_that_has_ended_does_not_stop_the_others(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The first tree ends after 1 s, and the second one is ticked after 3 s."""
    third = TWO.replace('name="b" namespace="b"', 'name="b" namespace="b" tick_rate="0.25"')
    main = small(tmp_path, "behaviortree-cpp", third, '{"op": "F", "exp": "topic_b__shown_msg.valid"}', 5)
    assert exact(capsys, main, "--reaction-time", "instant")["p"] == (1, 1)


def test_one_tree_with_a_name_is_the_tree_without_a_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The translations differ only in names."""
    goal = '{"op": "F", "exp": "topic_shown_msg.valid"}'
    unnamed = jani(small(tmp_path, "as2fm", '<input type="bt.cpp-xml" src="tree.xml" />', goal))
    named = jani(small(tmp_path, "as2fm", '<input type="bt.cpp-xml" src="tree.xml" name="tree" />', goal))
    assert named != unnamed
    for renamed in (r"(bt_blackboard_(?:fsm|req|get))_tree", r"(BT_plugin_\d+_)tree\."):
        named = re.sub(renamed, r"\1", named)
    assert sorted(re.findall(r"[\w.]+", named.replace("tree__v", "v"))) == sorted(re.findall(r"[\w.]+", unnamed))


# ------------------------------------------------------- plugins with the same name

ACT = """<ascxml name="Act" version="1.0" initial="on">
    <bt_declare_port_in key="{key}" type="int32" />
    <datamodel><data id="last" type="int32" expr="0" /></datamodel>
    <state id="on">
        <bt_tick target="on">
            <assign location="last"><expr><bt_get_input key="{key}" /></expr></assign>
            <bt_return_status status="{status}" />
        </bt_tick>
        <bt_halt target="on"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
"""


def three_acts(folder: Path) -> Path:
    """Three trees, each with a plugin `Act` of its own, which has other ports."""
    keys = {"place": "SUCCESS", "zone": "FAILURE", "area": "SUCCESS"}
    inputs = ""
    for number, (key, status) in enumerate(keys.items()):
        (folder / f"{key}.ascxml").write_text(ACT.format(key=key, status=status), encoding="utf-8")
        tree = f'<root BTCPP_format="4"><BehaviorTree ID="T{number}"><Act {key}="2" /></BehaviorTree></root>\n'
        (folder / f"{key}.xml").write_text(tree, encoding="utf-8")
        inputs += f'<input type="bt.cpp-xml" src="{key}.xml" name="{key}" />\n'
        inputs += f'<input type="bt-plugin-ascxml" src="{key}.ascxml" tree="{key}" />\n'
    fails = '{"op": "F", "exp": {"op": "=", "left": "bt_2000_response__status", "right": 2}}'
    main = small(folder, "as2fm", inputs, fails)
    text = main.read_text(encoding="utf-8")
    main.write_text(re.sub(r'<input type="bt-plugin-ascxml" src="(put|show).ascxml" />', "", text), encoding="utf-8")
    return main


def test_each_tree_is_checked_with_its_own_plugins(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = three_acts(tmp_path)
    assert problems(main) == []
    assert exact(capsys, main)["p"] == (1, 1)
    replaced(tmp_path / "area.xml", ("area=", "zone="))
    assert [found for found in problems(main) if "`Act` has no port `zone`" in found]


@pytest.mark.parametrize("key", ["place", "zone", "area"])
def test_a_node_leads_to_the_plugin_of_its_tree(key: str, tmp_path: Path) -> None:
    analysis = api.check([str(three_acts(tmp_path))]).snapshot.analysis
    tree = tmp_path / f"{key}.xml"
    group = symbol_group_at(analysis, str(tree), tree.read_text(encoding="utf-8").index("<Act") + 1)
    assert group is not None
    assert {Path(symbol.path).name for symbol in group.symbols} == {f"{key}.ascxml"}


def test_trees_that_share_a_file_need_plugins_with_the_same_ports(tmp_path: Path) -> None:
    main = three_acts(tmp_path)
    replaced(main, ('src="zone.xml"', 'src="place.xml"'))
    (problem,) = problems(main)
    assert problem.startswith("the trees `place` and `zone` execute one file, in which their plugins `Act` have")


# ------------------------------------------------------- properties of instances

EACH = {
    "properties": [
        {
            "name": "$(var robot)_ends",
            "expression": {
                "op": "filter",
                "fun": "values",
                "values": {
                    "op": "Pmin",
                    "exp": {
                        "op": "F",
                        "exp": {"op": "=", "left": "bt_$(var number)_response__status", "right": "status"},
                    },
                },
                "states": {"op": "initial"},
            },
        }
    ]
}
ENDS = {"anna": ("1000", "1", DELIVERS["anna"]), "carl": ("3000", "2", 0.9 * 0.25)}
"""Robot -> number of its tree, status with which it ends, probability of this. A blocked robot waits for ever."""


@pytest.fixture
def each(fleet: Path) -> Path:
    """The fleet with a file of properties in JANI that is listed for two robots."""
    (fleet / "each.jani").write_text(json.dumps(EACH), encoding="utf-8")
    inputs = "".join(
        f'<input type="jani" src="each.jani"><param name="robot" value="{robot}" />'
        f'<param name="number" value="{number}" /><param name="status" value="{status}" /></input>\n'
        for robot, (number, status, _) in ENDS.items()
    )
    replaced(fleet / "main.xml", ("    </properties>", f"{inputs}    </properties>"))
    return fleet / "main.xml"


def test_properties_in_jani_are_listed_for_each_robot(each: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert problems(each) == []
    values = exact(capsys, each, "--property", "anna_ends", "--property", "carl_ends")
    for robot, (_, _, expected) in ENDS.items():
        assert values[f"{robot}_ends"] == pytest.approx((expected, expected), abs=1e-9)
    plain = each.parent / "plain"
    assert run(["translate", str(each), "--expand", str(plain), "-o", str(each.parent / "x.jani")]) == 0
    assert jani(plain / "main.xml") == jani(each)


def test_editors_know_the_names_of_properties_of_instances(each: Path) -> None:
    """Each property has the name with which it can be verified, and the place of the text that the user wrote."""
    analysis = api.check([str(each)]).snapshot.analysis
    found = verifiable(analysis, str(each))
    written = {p.name: Path(p.path).read_text("utf-8")[p.name_span.start : p.name_span.end] for p in found}
    assert written == {
        **{f"{robot}_delivers": "$(var robot)_delivers" for robot in DELIVERS},
        "all_deliver": "all_deliver",
        **{f"{robot}_ends": "$(var robot)_ends" for robot in ENDS},
    }
    assert set(written) == {property_.name for property_ in api.to_jani(api.load(str(each))).properties}


def test_the_expectation_of_one_instance_is_in_the_configuration(each: Path) -> None:
    """That of all of them is in the file."""
    analysis = api.check([str(each)]).snapshot.analysis
    assert not any(is_written_in_file(analysis, property_) for property_ in verifiable(analysis, str(each)))
    replaced(each.parent / "delivers.xml", ('pattern="existence"', 'pattern="existence" expect="&gt;= 0.7"'))
    analysis = api.check([str(each)]).snapshot.analysis
    assert expected_beside(analysis, str(each)).keys() == {f"{robot}_delivers" for robot in DELIVERS}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('<param name="status"', '<param name="stat"', "does not use the parameter `stat`; remove it"),
        (
            '<param name="robot" value="carl" /><param name="n',
            '<param name="n',
            "there is no parameter `robot`; declare",
        ),
    ],
)
def test_wrong_parameters_of_properties_in_jani(old: str, new: str, message: str, each: Path) -> None:
    replaced(each, (old, new))
    found = problems(each)
    assert not any("no such file" in text for text in found)
    assert [text for text in found if message in text]


def test_a_parameter_of_properties_in_jani_is_renamed(each: Path) -> None:
    before = jani(each)
    analysis = api.check([str(each)]).snapshot.analysis
    at = each.read_text(encoding="utf-8").index('"number"') + 1
    renaming = rename(analysis, str(each), at, "place")
    assert isinstance(renaming, Renaming), renaming
    for changed, edits in renaming.edits.items():
        Path(changed).write_text(apply_edits(Path(changed).read_text("utf-8"), tuple(edits)), "utf-8")
    assert "bt_$(var place)_response" in (each.parent / "each.jani").read_text("utf-8")
    assert jani(each) == before


# --------------------------------------------------------- parameters in tree files


@pytest.fixture
def attempts(fleet: Path) -> Path:
    """The fleet whose tree file has the number of attempts from the trees."""
    replaced(fleet / "deliver.xml", ('num_attempts="2"', 'num_attempts="$(var attempts)"'))
    return fleet / "main.xml"


def with_attempts(main: Path, **attempts: str) -> None:
    """Set the number of attempts of some trees."""
    text = main.read_text(encoding="utf-8")
    for robot, value in attempts.items():
        param = f'<param name="attempts" value="{value}" />'
        text = re.sub(rf'(name="{robot}" namespace="{robot}"[^/>]*) />', rf"\1>{param}</input>", text)
        text = re.sub(rf'(name="{robot}" namespace="{robot}"[^/>]*>)(?!<param name="attempts")', rf"\1{param}", text)
    main.write_text(text, encoding="utf-8")


def test_a_tree_file_uses_the_values_of_its_trees(attempts: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with_attempts(attempts, anna="3", bert="3", carl="3")
    assert problems(attempts) == []
    values = exact(capsys, attempts, "--property", "carl_delivers")
    assert values["carl_delivers"][0] == pytest.approx(0.9 * (1 - 0.5**3), abs=1e-9)
    plain = attempts.parent / "plain"
    assert run(["translate", str(attempts), "--expand", str(plain), "-o", str(attempts.parent / "x.jani")]) == 0
    assert jani(plain / "main.xml") == jani(attempts)


@pytest.mark.parametrize("missing", ["is 2 in the tree `carl`", "has no value in the tree `carl`"])
def test_different_values_in_one_tree_file_are_reported(missing: str, attempts: Path) -> None:
    with_attempts(attempts, anna="3", bert="3", **({"carl": "2"} if "is 2" in missing else {}))
    (found,) = problems(attempts)
    assert found.startswith("`attempts` is 3 in the tree `anna` and ")
    assert missing in found
    assert "list a copy of the file with other IDs" in found


def test_a_copy_of_a_tree_file_has_other_values(attempts: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As the message proposes."""
    text = (attempts.parent / "deliver.xml").read_text(encoding="utf-8").replace("Deliver", "DeliverOnce")
    (attempts.parent / "once.xml").write_text(text, encoding="utf-8")
    replaced(attempts, ('src="deliver.xml" name="carl"', 'src="once.xml" name="carl"'))
    with_attempts(attempts, anna="2", bert="2", carl="1")
    assert problems(attempts) == []
    values = exact(capsys, attempts, "--property", "carl_delivers", "--property", "anna_delivers")
    assert values["carl_delivers"][0] == pytest.approx(0.9 * 0.5, abs=1e-9)
    assert values["anna_delivers"][0] == pytest.approx(DELIVERS["anna"], abs=1e-9)


def test_a_value_of_a_tree_precedes_that_of_the_system(attempts: Path) -> None:
    """It has the type of the parameter of the system."""
    declared = '<parameter name="attempts" type="int32" value="2" min="1" max="5" />'
    replaced(
        attempts, ("    <parameters>", f"<parameter_declarations>{declared}</parameter_declarations>\n    <parameters>")
    )
    before = jani(attempts)
    with_attempts(attempts, anna="1 + 1")
    assert problems(attempts) == []
    assert jani(attempts) == before
    replaced(attempts, ("1 + 1", "6"))
    assert any("greater than its `max`" in text for text in problems(attempts))


def test_a_value_of_trees_is_renamed(attempts: Path) -> None:
    with_attempts(attempts, anna="3", bert="3", carl="3")
    before = jani(attempts)
    tree = attempts.parent / "deliver.xml"
    at = tree.read_text(encoding="utf-8").index("$(var attempts)") + len("$(var a")
    renaming = rename(api.check([str(attempts)]).snapshot.analysis, str(tree), at, "trials")
    assert isinstance(renaming, Renaming), renaming
    for changed, edits in renaming.edits.items():
        Path(changed).write_text(apply_edits(Path(changed).read_text("utf-8"), tuple(edits)), "utf-8")
    assert attempts.read_text(encoding="utf-8").count('name="trials"') == 3
    assert jani(attempts) == before


def test_values_from_outside_replace_those_of_trees(attempts: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with_attempts(attempts, anna="2", bert="2", carl="2")
    asked = ("--property", "anna_delivers")
    assert exact(capsys, attempts, *asked)["anna_delivers"][0] == pytest.approx(DELIVERS["anna"], abs=1e-9)
    once = [word for robot in DELIVERS for word in ("--set", f"{robot}.attempts=1")]
    assert exact(capsys, attempts, *asked, *once)["anna_delivers"][0] == pytest.approx(0.9 * 0.9, abs=1e-9)
    assert run(["verify", str(attempts), *asked, "--set", "anna.attempts=1"]) == 1, "the trees execute the same file"
    assert "`attempts` is 1 in the tree `anna` and is 2 in the tree `bert`" in capsys.readouterr().err
    assert run(["verify", str(attempts), *asked, "--set", "anna.attemps=1"]) == 2
    assert "did you mean `anna.attempts`?" in capsys.readouterr().err
