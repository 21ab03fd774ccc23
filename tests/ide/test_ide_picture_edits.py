# SPDX-License-Identifier: Apache-2.0
"""Actions on the parts of pictures: what they ask, and the text after them."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from ide_case import analysis_of, path_of

from fixture import split_files
from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.ide.diagrams import DiagramKind, Picture, picture_of
from roaml.ide.picture_edits import ActionRefusal, Answer, PictureAction, PictureParts, UserQuestion, answer
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.text import Location, apply_edits

MACHINE = """\
<ascxml name="Lamp" version="1.0" initial="off">
    <ros_topic_subscriber name="switch" topic="/switch" type="std_msgs/Bool" />
    <ros_time_rate name="tick" rate_hz="1" />

    <!-- It is dark. -->
    <state id="off">
        <ros_topic_callback name="switch" cond="_msg.data" target="on" />
    </state>

    <!-- A section about light. -->

    <!-- It is bright.
         Very. -->
    <state id="on">
        <onentry>
            <send event="lit" />
        </onentry>
        <!-- Somebody switches it off. -->
        <ros_topic_callback name="switch" cond="!_msg.data" target="off" />
        <ros_rate_callback name="tick"> <!-- It may break. -->
            <target id="on" prob="0.75" />
            <target id="broken" prob="0.25" />
        </ros_rate_callback>
    </state>

    <state id="broken" />
</ascxml>
"""


def machine(text: str = MACHINE) -> tuple[Analysis, Picture]:
    analysis = analysis_of({"lamp.ascxml": text})
    picture = picture_of(DiagramKind.MACHINE, analysis, path_of("lamp.ascxml"))
    assert picture is not None
    return analysis, picture


def node(picture: Picture, label: str) -> Location:
    (place,) = (node.place for node in picture.nodes if node.label == label)
    assert place is not None
    return place


def edge(picture: Picture, *labels: str) -> Location:
    places = {edge.place for edge in picture.edges if all(label in edge.labels for label in labels)}
    (place,) = places
    assert place is not None
    return place


def respond(analysis: Analysis, place: Location, action: str, *answers: str) -> Answer:
    chosen = PictureAction(action)
    assert chosen in PictureParts(analysis).actions(place)
    return answer(analysis, place.path, place.span, chosen, answers)


def text_after(analysis: Analysis, place: Location, action: str, *answers: str) -> str:
    """The text of the file at `place` after the action."""
    change = respond(analysis, place, action, *answers)
    assert isinstance(change, WorkspaceEdit), change
    source = analysis.source(place.path)
    assert source is not None
    return apply_edits(source.text, change.edits[place.path])


def lines_after(analysis: Analysis, place: Location, action: str, *answers: str) -> tuple[list[str], list[str]]:
    """The removed lines and the new lines, without indentation."""
    source = analysis.source(place.path)
    assert source is not None
    before, after = source.text.splitlines(), text_after(analysis, place, action, *answers).splitlines()
    removed, added = list(before), list(after)
    for line in before:
        if line in added:
            added.remove(line)
            removed.remove(line)
    return [line.strip() for line in removed], [line.strip() for line in added]


def states_of(text: str) -> list[str]:
    _, picture = machine(text)
    return [node.label for node in picture.nodes if node.kind.value == "state"]


# -------------------------------------------------------------------- states


def test_a_state_is_added_after_another_with_the_empty_line_of_the_file() -> None:
    analysis, picture = machine()
    place = node(picture, "off")
    assert respond(analysis, place, "addState") == UserQuestion("The name of the new state")
    text = text_after(analysis, place, "addState", " dim ")
    assert '    </state>\n\n    <state id="dim" />\n\n    <!-- A section' in text
    assert states_of(text) == ["off", "dim", "on", "broken"]


def test_a_state_is_added_to_a_machine_without_states() -> None:
    analysis = analysis_of({"empty.ascxml": '<ascxml name="Empty" version="1.0" initial="a" />\n'})
    change = answer(analysis, path_of("empty.ascxml"), None, PictureAction.ADD_STATE, ["a"])
    assert isinstance(change, WorkspaceEdit)
    text = apply_edits('<ascxml name="Empty" version="1.0" initial="a" />\n', change.edits[path_of("empty.ascxml")])
    assert text == '<ascxml name="Empty" version="1.0" initial="a">\n    <state id="a" />\n</ascxml>\n'


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("on", "a state `on` already exists"),
        ("a b", "`a b` is not a valid name of a state"),
        ("", "`` is not a valid name of a state"),
        ('a"/>', '`a"/>` is not a valid name of a state'),
    ],
)
def test_names_that_a_new_state_cannot_have(name: str, reason: str) -> None:
    analysis, picture = machine()
    assert respond(analysis, node(picture, "off"), "addState", name) == ActionRefusal(reason)


def test_a_state_is_renamed_with_all_its_uses() -> None:
    analysis, picture = machine()
    place = node(picture, "off")
    assert respond(analysis, place, "rename") == UserQuestion("The new name of `off`", proposal="off")
    text = text_after(analysis, place, "rename", "dark")
    assert text == MACHINE.replace('"off"', '"dark"')
    assert respond(analysis, place, "rename", "on") == ActionRefusal("a state `on` already exists")


def test_another_state_becomes_the_initial_one() -> None:
    analysis, picture = machine()
    place = node(picture, "broken")
    assert text_after(analysis, place, "setInitial") == MACHINE.replace('initial="off"', 'initial="broken"')
    assert PictureAction.SET_INITIAL not in PictureParts(analysis).actions(node(picture, "off"))


def test_a_missing_initial_state_is_added() -> None:
    analysis, picture = machine(MACHINE.replace(' initial="off"', ""))
    text = text_after(analysis, node(picture, "off"), "setInitial")
    assert text.startswith('<ascxml initial="off" name="Lamp" version="1.0">')


def test_a_state_is_deleted_with_its_comment_and_the_transitions_to_it() -> None:
    analysis, picture = machine()
    removed, added = lines_after(analysis, node(picture, "on"), "delete")
    # The state `off` has no transitions any more.
    assert added == ['<state id="off" />']
    assert '<state id="off">' in removed
    assert '<ros_topic_callback name="switch" cond="_msg.data" target="on" />' in removed
    assert "Very. -->" in removed
    text = text_after(analysis, node(picture, "on"), "delete")
    assert "<!-- A section about light. -->" in text
    assert "<!-- It is dark. -->" in text
    assert states_of(text) == ["off", "broken"]


def test_if_the_initial_state_is_deleted_the_next_one_is_initial() -> None:
    analysis, picture = machine()
    text = text_after(analysis, node(picture, "off"), "delete")
    assert 'initial="on"' in text
    assert "dark" not in text
    assert "switches it off" not in text
    assert states_of(text) == ["on", "broken"]


def test_a_random_target_is_deleted_with_its_state() -> None:
    analysis, picture = machine()
    removed, added = lines_after(analysis, node(picture, "broken"), "delete")
    # The other target receives the whole probability.
    assert added == ['<target id="on" />']
    assert sorted(removed) == [
        "",
        '<state id="broken" />',
        '<target id="broken" prob="0.25" />',
        '<target id="on" prob="0.75" />',
    ]


def test_the_only_state_is_not_deleted() -> None:
    analysis, picture = machine('<ascxml name="M" version="1.0" initial="a">\n    <state id="a" />\n</ascxml>\n')
    assert respond(analysis, node(picture, "a"), "delete") == ActionRefusal(
        "this is the only state, and a state machine needs at least one"
    )


def test_of_two_states_with_one_name_only_the_element_is_deleted() -> None:
    analysis, picture = machine(MACHINE.replace("</ascxml>", '    <state id="on"></state>\n</ascxml>'))
    text = text_after(analysis, node(picture, "on"), "delete")
    assert 'target="on"' in text
    assert '<state id="on"></state>' in text


def test_states_of_action_threads_are_separate() -> None:
    text = MACHINE.replace(
        "</ascxml>",
        """\
    <ros_action_thread name="walk" n_threads="2" initial="off">
        <state id="off">
            <transition event="go" target="on" />
        </state>
        <state id="on" />
    </ros_action_thread>
</ascxml>""",
    )
    analysis, picture = machine(text)
    thread = next(node for node in picture.nodes if node.parent and node.label == "on")
    assert thread.place is not None
    changed = text_after(analysis, thread.place, "setInitial")
    assert changed == text.replace('n_threads="2" initial="off"', 'n_threads="2" initial="on"')
    changed = text_after(analysis, thread.place, "delete")
    assert changed == text.replace(
        '<state id="off">\n            <transition event="go" target="on" />\n        </state>\n'
        '        <state id="on" />',
        '<state id="off" />',
    )


# --------------------------------------------------------------- transitions


def test_a_transition_is_added_for_each_trigger_of_the_machine() -> None:
    analysis, picture = machine()
    place = node(picture, "broken")
    targets = respond(analysis, place, "addTransition")
    assert isinstance(targets, UserQuestion)
    assert [option.answer for option in targets.options] == ["off", "on", "broken"]
    triggers = respond(analysis, place, "addTransition", "off")
    assert isinstance(triggers, UserQuestion)
    assert [(option.label, option.answer) for option in triggers.options] == [
        ("timer tick", 'ros_rate_callback name="tick"'),
        ("/switch", 'ros_topic_callback name="switch"'),
        ("no event", "transition"),
    ]
    text = text_after(analysis, place, "addTransition", "off", 'ros_topic_callback name="switch"')
    assert text == MACHINE.replace(
        '    <state id="broken" />',
        '    <state id="broken">\n        <ros_topic_callback name="switch" target="off" />\n    </state>',
    )


def test_a_transition_is_added_behind_the_other_children() -> None:
    analysis, picture = machine()
    text = text_after(analysis, node(picture, "on"), "addTransition", "broken", 'ros_rate_callback name="tick"')
    assert '</ros_rate_callback>\n        <ros_rate_callback name="tick" target="broken" />\n    </state>' in text


@pytest.mark.parametrize("answers", [("nowhere",), ("off", 'script src="x"'), ("off", "")])
def test_answers_that_were_not_offered_are_refused(answers: Sequence[str]) -> None:
    analysis, picture = machine()
    assert isinstance(respond(analysis, node(picture, "on"), "addTransition", *answers), ActionRefusal)


def test_plain_events_and_ticks_are_triggers_of_plugins() -> None:
    files = """\
-- main.xml --
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="walk.ascxml" />
    </behavior_tree>
    <node_models><input type="node-ascxml" src="bell.ascxml" /></node_models>
</roaml>
-- tree.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <!-- Both. -->
        <Sequence name="both">
            <Walk name="first" />
            <!-- Again. -->
            <Walk />
        </Sequence>
    </BehaviorTree>
</root>
-- walk.ascxml --
<ascxml name="Walk" version="1.0" initial="ready">
    <state id="ready">
        <bt_tick target="ready"><bt_return_status status="SUCCESS" /></bt_tick>
        <bt_halt target="ready"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
-- bell.ascxml --
<ascxml name="Bell" version="1.0" initial="on">
    <state id="on"><onentry><send event="rings" /></onentry></state>
</ascxml>
"""
    workspace = Workspace((path_of(""),), Settings())
    for name, text in split_files(files).items():
        workspace.open(path_of(name), text)
    analysis = workspace.snapshot().analysis
    plugin = picture_of(DiagramKind.MACHINE, analysis, path_of("walk.ascxml"))
    assert plugin is not None
    triggers = respond(analysis, node(plugin, "ready"), "addTransition", "ready")
    assert isinstance(triggers, UserQuestion)
    tags = [option.answer for option in triggers.options]
    assert tags == ["bt_tick", "bt_halt", 'transition event="rings"', "transition"]

    tree = picture_of(DiagramKind.TREE, analysis, path_of("main.xml"))
    assert tree is not None
    changed = text_after(analysis, node(tree, "Walk"), "delete")
    assert "Again" not in changed
    assert changed.count("<Walk") == 1
    assert PictureAction.DELETE not in PictureParts(analysis).actions(node(tree, "both : Sequence"))
    changed = text_after(analysis, node(tree, "first : Walk"), "rename", "one")
    assert '<Walk name="one" />' in changed

    graph = picture_of(DiagramKind.SYSTEM, analysis, path_of("main.xml"))
    assert graph is not None
    change = respond(analysis, node(graph, "Walk"), "rename", "Run")
    assert isinstance(change, WorkspaceEdit)
    assert {path.rpartition("/")[2].rpartition("\\")[2] for path in change.edits} == {"tree.xml", "walk.ascxml"}


def test_a_transition_is_deleted_with_its_comment() -> None:
    analysis, picture = machine()
    removed, added = lines_after(analysis, edge(picture, "/switch", "[!_msg.data]"), "delete")
    assert removed == [
        "<!-- Somebody switches it off. -->",
        '<ros_topic_callback name="switch" cond="!_msg.data" target="off" />',
    ]
    assert added == []


def test_the_last_transition_leaves_an_empty_state() -> None:
    analysis, picture = machine()
    text = text_after(analysis, edge(picture, "/switch", "[_msg.data]"), "delete")
    assert text == MACHINE.replace(
        '<state id="off">\n        <ros_topic_callback name="switch" cond="_msg.data" target="on" />\n    </state>',
        '<state id="off" />',
    )


def test_a_random_transition_is_deleted_as_a_whole_or_one_target() -> None:
    analysis, picture = machine()
    assert "ros_rate_callback" not in text_after(analysis, edge(picture, "timer tick"), "delete")
    text = text_after(analysis, edge(picture, "0.75"), "delete")
    assert '<target id="on"' not in text
    assert '<target id="broken" />' in text
    assert "It may break" in text


def test_the_rest_of_the_probability_is_not_changed() -> None:
    text = MACHINE.replace('id="broken" prob="0.25"', 'id="broken"')
    analysis, picture = machine(text)
    assert lines_after(analysis, edge(picture, "0.75"), "delete") == (['<target id="on" prob="0.75" />'], [])
    removed, added = lines_after(analysis, edge(picture, "otherwise"), "delete")
    assert (removed, added) == (
        ['<target id="on" prob="0.75" />', '<target id="broken" />'],
        ['<target id="on" />'],
    )


def test_one_of_several_transitions_of_a_state_is_chosen() -> None:
    analysis, picture = machine()
    place = node(picture, "on")
    question = respond(analysis, place, "deleteTransition")
    assert isinstance(question, UserQuestion)
    assert [option.label for option in question.options] == [
        "/switch [!_msg.data] → off",
        "timer tick → on, broken",
    ]
    assert "ros_rate_callback" not in text_after(analysis, place, "deleteTransition", "1")
    assert isinstance(respond(analysis, place, "deleteTransition", "7"), ActionRefusal)
    # The only transition of a state needs no question.
    assert '<state id="off" />' in text_after(analysis, node(picture, "off"), "deleteTransition")


def test_line_ends_and_indentation_are_those_of_the_file() -> None:
    analysis, picture = machine(MACHINE.replace("    ", "\t").replace("\n", "\r\n"))
    text = text_after(analysis, node(picture, "broken"), "addTransition", "off", "transition")
    assert '\r\n\t<state id="broken">\r\n\t\t<transition target="off" />\r\n\t</state>\r\n' in text
    text = text_after(analysis, edge(picture, "/switch", "[!_msg.data]"), "delete")
    assert "Somebody" not in text
    assert text.count("\n") == text.count("\r\n") == MACHINE.count("\n") - 2


def test_a_place_that_has_changed_is_refused() -> None:
    _, picture = machine()
    place = node(picture, "on")
    later, _ = machine(MACHINE.replace("It is dark", "It is very dark"))
    assert isinstance(answer(later, place.path, place.span, PictureAction.DELETE), ActionRefusal)


# --------------------------------------------------------------------- trees

TREE = """\
<root BTCPP_format="4" main_tree_to_execute="Main">
    <BehaviorTree ID="Main">
        <Sequence name="all">
            <!-- Wait for
                 the robot. -->
            <Wait wait_duration="5" />
            <Fallback>
                <Spin spin_dist="1.57"
                      name="turn" />
                <SubTree ID="Home" speed="2" />
            </Fallback>
            <Inverter><GoalUpdated /></Inverter>
        </Sequence>
    </BehaviorTree>
    <BehaviorTree ID="Home">
        <Action ID="BackUp" backup_dist="0.3" backup_speed="0.05" />
    </BehaviorTree>
</root>
"""


def lone_tree(text: str = TREE) -> tuple[Analysis, Picture]:
    analysis = analysis_of({"tree.xml": text})
    picture = picture_of(DiagramKind.TREE, analysis, path_of("tree.xml"))
    assert picture is not None
    return analysis, picture


def tree_texts(question: Answer) -> dict[str, str]:
    assert isinstance(question, UserQuestion)
    return {option.answer: option.description for option in question.options}


def test_a_child_is_added_with_the_ports_that_it_needs() -> None:
    analysis, picture = lone_tree()
    place = node(picture, "Fallback")
    nodes = tree_texts(respond(analysis, place, "addChild"))
    assert nodes["SubTree Home"] == "subtree"
    assert "SubTree Main" not in nodes
    assert (nodes["Delay"], nodes["AlwaysSuccess"], nodes["IsBatteryLow"]) == ("decorator", "action", "condition")
    removed, added = lines_after(analysis, place, "addChild", "AlwaysSuccess")
    assert (removed, added) == ([], ["<AlwaysSuccess />"])
    question = respond(analysis, place, "addChild", "FollowPath")
    assert isinstance(question, UserQuestion)
    assert "`path`" in question.text
    assert question.proposal == "{path}"
    assert isinstance(respond(analysis, place, "addChild", "FollowPath", " "), ActionRefusal)
    text = text_after(analysis, place, "addChild", "FollowPath", 'a"&<b')
    assert "                <FollowPath path='a\"&amp;&lt;b' />\n            </Fallback>" in text
    assert '<SubTree ID="Home" />' in text_after(analysis, node(picture, "all : Sequence"), "addChild", "SubTree Home")
    assert isinstance(respond(analysis, place, "addChild", "Nothing"), ActionRefusal)


def test_a_node_is_added_after_another() -> None:
    analysis, picture = lone_tree()
    text = text_after(analysis, node(picture, "turn : Spin"), "addAfter", "ForceSuccess")
    assert 'name="turn" />\n                <ForceSuccess />\n                <SubTree' in text


@pytest.mark.parametrize(
    ("label", "actions"),
    [
        # A sequence has any number of children, a tree one root.
        ("all : Sequence", "addChild rename changeNode wrap"),
        # A leaf has none; it is the first child.
        ("Wait", "addAfter setName changeNode wrap moveLater delete"),
        ("turn : Spin", "addAfter rename changeNode wrap moveLater delete"),
        ("Fallback", "addChild addAfter setName changeNode wrap unwrap moveEarlier moveLater delete"),
        # A decorator has one child, which may replace it.
        ("Inverter", "addAfter setName changeNode wrap unwrap moveEarlier delete"),
        ("GoalUpdated", "setName changeNode wrap delete"),
        ("BackUp", "setName changeNode wrap"),
    ],
)
def test_a_node_allows_what_its_tree_allows(label: str, actions: str) -> None:
    analysis, picture = lone_tree()
    allowed = [action.value for action in PictureParts(analysis).actions(node(picture, label))]
    assert [action for action in allowed if action != "rename" or "rename" in actions] == actions.split()


def test_a_node_is_wrapped_and_unwrapped() -> None:
    analysis, picture = lone_tree()
    place = node(picture, "Fallback")
    nodes = tree_texts(respond(analysis, place, "wrap"))
    assert {"Inverter", "Sequence", "RetryUntilSuccessful"} <= nodes.keys()
    assert not {"Wait", "SubTree Home", "IfThenElse", "WhileDoElse"} & nodes.keys()
    text = text_after(analysis, place, "wrap", "RetryUntilSuccessful", "3")
    assert text == TREE.replace(
        """\
            <Fallback>
                <Spin spin_dist="1.57"
                      name="turn" />
                <SubTree ID="Home" speed="2" />
            </Fallback>
""",
        """\
            <RetryUntilSuccessful num_attempts="3">
                <Fallback>
                    <Spin spin_dist="1.57"
                          name="turn" />
                    <SubTree ID="Home" speed="2" />
                </Fallback>
            </RetryUntilSuccessful>
""",
    )
    analysis, picture = lone_tree(text)
    assert text_after(analysis, node(picture, "RetryUntilSuccessful"), "unwrap") == TREE


def test_nodes_in_one_line_are_wrapped_and_unwrapped_in_it() -> None:
    analysis, picture = lone_tree()
    text = text_after(analysis, node(picture, "GoalUpdated"), "wrap", "ForceFailure")
    assert "<Inverter><ForceFailure><GoalUpdated /></ForceFailure></Inverter>" in text
    analysis, picture = lone_tree(text)
    assert text_after(analysis, node(picture, "ForceFailure"), "unwrap") == TREE
    analysis, picture = lone_tree()
    assert text_after(analysis, node(picture, "Inverter"), "unwrap") == TREE.replace(
        "<Inverter><GoalUpdated /></Inverter>", "<GoalUpdated />"
    )


def test_lines_in_values_of_attributes_are_not_moved() -> None:
    text = TREE.replace('wait_duration="5"', '_skipIf="a == 1 ||\n  b == 2"')
    analysis, picture = lone_tree(text)
    changed = text_after(analysis, node(picture, "Wait"), "wrap", "Inverter")
    assert '                <Wait _skipIf="a == 1 ||\n  b == 2" />\n            </Inverter>' in changed


def test_a_node_gets_another_type() -> None:
    analysis, picture = lone_tree()
    place = node(picture, "turn : Spin")
    nodes = tree_texts(respond(analysis, place, "changeNode"))
    assert {"Wait", "SubTree Home", "GoalUpdated"} <= nodes.keys()
    assert not {"Spin", "Sequence", "Inverter"} & nodes.keys()
    # The ports that the new type does not have are removed; those that it needs are added.
    text = text_after(analysis, place, "changeNode", "FollowPath", "{p}")
    assert '                <FollowPath path="{p}"\n                      name="turn" />' in text
    text = text_after(analysis, place, "changeNode", "SubTree Home")
    assert '<SubTree ID="Home" spin_dist="1.57"\n                      name="turn" />' in text
    # An explicit node stays explicit, and a subtree becomes a node in the compact form.
    assert '<Condition ID="GoalUpdated" />' in text_after(
        analysis, node(picture, "BackUp"), "changeNode", "GoalUpdated"
    )
    (use,) = (shown.use for shown in picture.nodes if shown.label == "Home")
    assert use is not None
    assert "                <AlwaysSuccess />\n" in text_after(analysis, use, "changeNode", "AlwaysSuccess")
    # The end tag changes, too.
    text = text_after(analysis, node(picture, "Fallback"), "changeNode", "ReactiveFallback")
    assert text == TREE.replace("Fallback", "ReactiveFallback")
    nodes = tree_texts(respond(analysis, node(picture, "Inverter"), "changeNode"))
    assert "ForceSuccess" in nodes
    assert "Wait" not in nodes


def test_nodes_are_moved_with_their_comments() -> None:
    analysis, picture = lone_tree()
    text = text_after(analysis, node(picture, "Wait"), "moveLater")
    assert text.index("<Fallback>") < text.index("Wait for") < text.index("<Wait ") < text.index("<Inverter>")
    analysis, picture = lone_tree(text)
    assert text_after(analysis, node(picture, "Wait"), "moveEarlier") == TREE


def test_a_subtree_is_edited_where_it_is_used() -> None:
    analysis, picture = lone_tree()
    (home,) = (shown for shown in picture.nodes if shown.label == "Home")
    assert home.use is not None
    assert home.place != home.use
    assert lines_after(analysis, home.use, "delete") == (['<SubTree ID="Home" speed="2" />'], [])
    assert '<SubTree ID="Home" name="base" speed="2" />' in text_after(analysis, home.use, "setName", "base")
    text = text_after(analysis, home.use, "moveEarlier")
    assert text.index('<SubTree ID="Home"') < text.index("<Spin")


def test_a_node_gets_a_name() -> None:
    analysis, picture = lone_tree()
    place = node(picture, "Wait")
    assert respond(analysis, place, "setName") == UserQuestion("The name of the node")
    assert '<Wait name="a &amp; b" wait_duration="5" />' in text_after(analysis, place, "setName", " a & b ")
    assert isinstance(respond(analysis, place, "setName", ""), ActionRefusal)
    backup = text_after(analysis, node(picture, "BackUp"), "setName", "away")
    assert '<Action ID="BackUp" name="away" backup_dist' in backup
