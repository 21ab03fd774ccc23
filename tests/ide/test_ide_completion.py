# SPDX-License-Identifier: Apache-2.0
"""Completions at a caret. A case is a text with `‸`, which replaces a mark in a system, and the expected items.

Expected items are below the text: `LABEL`, `LABEL : DETAIL`, `LABEL => INSERTED` (up to `…`). They occur in this order,
with others in between. `no LABEL` must not occur, `nothing` means that there are no completions, and `only` that there
are no others.
"""

from __future__ import annotations

import re

import pytest
from ide_case import FOLDER, marked, path_of
from ide_models import system_file

from fixture import split_files
from roaml.ide.completion import Completions, complete, document, plain
from roaml.ide.completion.expressions import beginning
from roaml.ide.completion.item import Snippet
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace

SYSTEM = (
    "-- main.xml --\n"
    + system_file(
        "data_declarations xml types.xml",
        "behavior_tree bt.cpp-xml tree.xml",
        "behavior_tree bt-plugin-ascxml walk.ascxml",
        "node_models node-ascxml node.ascxml",
        "node_models node-ascxml other.ascxml",
        "properties jani properties.jani",
    )
    + """
-- types.xml --
<types>
  <struct id="Pose"><member id="x" type="float64"/><member id="seen" type="bool"/></struct>
  <struct id="Path"><member id="poses" type="Pose[4]"/></struct>
  <!--types-->
</types>
-- node.ascxml --
<ascxml name="Node" version="1.0" initial="start">
  <datamodel>
    <data id="pose" type="Pose" expr="{'x': 0.0, 'seen': false}"/>
    <data id="path" type="Path" expr="{'poses': []}"/>
    <data id="count" type="int32" expr="0"/>
    <data id="ready" type="bool" expr="false"/>
    <!--data-->
  </datamodel>
  <ros_topic_subscriber name="plan" topic="/plan" type="nav_msgs/Path"/>
  <ros_topic_publisher name="level" topic="/level" type="std_msgs/Int32"/>
  <ros_topic_publisher name="twist" topic="/cmd_vel" type="geometry_msgs/Twist"/>
  <ros_service_client name="trigger" service_name="/trigger" type="std_srvs/SetBool"/>
  <ros_time_rate name="clockwork" rate_hz="10"/>
  <!--top-->
  <state id="start">
    <onentry><!--entry--></onentry>
    <transition event="go" target="stop"><!--go--></transition>
    <ros_topic_callback name="plan" target="start"><!--callback--></ros_topic_callback>
    <!--state-->
  </state>
  <state id="stop">
    <onentry><ros_topic_publish name="level"><field name="data" expr="count"/></ros_topic_publish></onentry>
  </state>
</ascxml>
-- other.ascxml --
<ascxml name="Other" version="1.0" initial="s">
  <datamodel><data id="p" type="Pose" expr="{'x': 0.0, 'seen': false}"/></datamodel>
  <ros_topic_subscriber name="level" topic="/level" type="std_msgs/Int32"/>
  <state id="s">
    <transition event="done" target="s"><assign location="p.x" expr="_event.data.at"/></transition>
    <transition target="s">
      <send event="go"><param name="speed" expr="1.5"/><param name="to" expr="p"/></send>
    </transition>
  </state>
</ascxml>
-- walk.ascxml --
<ascxml name="Walk" version="1.0" initial="s">
  <bt_declare_port_in key="goal" type="int32"/>
  <bt_declare_port_in key="topic" type="string"/>
  <bt_declare_port_out key="reached" type="bool"/>
  <ros_topic_publisher name="pub" type="std_msgs/Int32"><topic><bt_get_input key="topic"/></topic></ros_topic_publisher>
  <!--walk-->
  <state id="s">
    <bt_tick target="s"><!--tick--><bt_return_status status="SUCCESS"/></bt_tick>
    <bt_halt target="s"><bt_return_halted/></bt_halt>
  </state>
</ascxml>
-- tree.xml --
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <Walk goal="1" topic="/level" reached="{there}"/>
      <!--tree-->
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Rest"><Script code="{power} := 1"/></BehaviorTree>
  <BehaviorTree ID="Home"><Walk goal="{where}" topic="/level" reached="{there}"/></BehaviorTree>
  <!--root-->
</root>
-- properties.jani --
{"properties": [
  //property//
]}
"""
)

FILES = split_files(SYSTEM)

# ---------------------------------------------------------------------- elements and attributes

ELEMENTS = """
state  <‸
    transition => transition event="${1|go,done|}" target="${2|start,stop|}">\\n\\t$0\\n</transition>
    ros_topic_callback => ros_topic_callback name="${1:plan}" target="${2|start,stop|}">\\n\\t$0\\n</ros_topic_callback>
    ros_action_handle_goal
    no assign

state  <ros_action_handle_cancel‸
    ros_action_handle_cancel_goal => ros_action_handle_cancel_goal name="$1" target="${2|start,stop|}">\\n\\t$0\\n…

callback  <ros_action_cancel‸
    ros_action_cancel_goal => ros_action_cancel_goal name="$1"/>$0
    ros_action_canceled => ros_action_canceled name="$1" goal_id="$2"…

state  <tr‸ansition target="start"/>
    transition => transition

state  ‸
    onexit => <onexit>\\n\\t$0\\n</onexit>
    transition => <transition event="${1|go,done|}" target="${2|start,stop|}">\\n\\t$0\\n</transition>

top  <ros_t‸
    ros_topic_publisher => ros_topic_publisher name="$1" topic="${2|/plan,/level,/cmd_vel|}" type="$3"/>$0
    ros_time_rate => ros_time_rate name="$1" rate_hz="$2"/>$0

callback  <ros_topic_publish‸
    ros_topic_publish level => ros_topic_publish name="level">\\n\\t<field name="data" expr="${1:0}"/>\\n…
    ros_topic_publish twist : linear.x, linear.y, linear.z, angular.x, angular.y, angular.z
    ros_topic_publish => ros_topic_publish name="${1|level,twist|}">\\n\\t$0\\n</ros_topic_publish>
    ros_action_send_goal

callback  <ros_topic_publish name="twist"><field name="linear.x" expr="1.0"/>‸</ros_topic_publish>
    all missing fields : linear.y, linear.z, angular.x, angular.y, angular.z
    field linear.y => <field name="linear.y" expr="${1:0.0}"/>
    no field linear.x
    field

callback  <assign location="count" expr="1"></‸
    assign => assign>

entry  <send event="go">‸</send>
    all parameters => <param name="speed" expr="$1"/>\\n<param name="to" expr="$2"/>
    param speed : float
    param to => <param name="to" expr="$1"/>
    param => <param name="${1|speed,to|}" expr="$2"/>$0

callback  <if cond="ready"><‸
    /if => /if>
    assign
    else => else/>$0

types  <struct id="A"><‸
    member => member id="$1" type="${2|bool,int8,int16,…

types  ‸
    struct => <struct id="$1">\\n\\t$0\\n</struct>

tree  <‸
    Walk => Walk goal="$1" topic="$2" reached="${3:{reached\\}}"/>$0
    SubTree Rest => SubTree ID="Rest"$0/>
    SubTree Home
    Sequence => Sequence>\\n\\t$0\\n</Sequence>
    Inverter => Inverter>\\n\\t$0\\n</Inverter>
    RetryUntilSuccessful => RetryUntilSuccessful num_attempts="$1">\\n\\t$0\\n</RetryUntilSuccessful>
    no SubTree Main

tree  <Inverter><AlwaysSuccess ‸/></Inverter>
    name => name="$1"
    no ID

tree  <Walk ‸/>
    all ports => goal="$1" topic="$2" reached="${3:{reached\\}}"
    goal : in int32 => goal="$1"
    reached : out bool => reached="${1:{reached\\}}"
    name

tree  <Action ID="Walk" goal="1" ‸/>
    all ports : topic, reached
    topic
    no goal
    no ID

tree  <SubTree ID="Home" ‸/>
    where => where="${1:{where\\}}"
    there
    _autoremap

root  <‸
    BehaviorTree => BehaviorTree ID="$1">\\n\\t$0\\n</BehaviorTree>
    TreeNodesModel

state  <transition ‸ target="stop"/>
    event => event="${1|go,done|}"
    cond => cond="$1"
    no target

state  <transition e‸
    event

top  <ros_topic_publisher name="a" to‸
    topic => topic="${1|/plan,/level,/cmd_vel|}"
    no name

data  <data id="a" ‸type="int32"/>
    lower_bound_incl
    no id

state  <transition <!-- ‸ -->/>
    nothing

state  <!-- <‸ -->
    nothing

state  <transition event="go"‸ />
    nothing
"""

VALUES = r"""
state  <transition event="go" target="‸"/>
    start
    stop

state  <transition event="‸"/>
    go : from Other
    done : never sent

go  <send event="‸"/>
    go : to Node
    done : to Other

go  <send event="done"><param name="‸" expr="1"/></send>
    at : read by a receiver

state  <ros_topic_callback name="‸" target="start"/>
    plan : /plan : nav_msgs/Path
    no level

callback  <ros_topic_publish name='‸'/>
    level
    twist
    no plan

callback  <ros_topic_publish name=‸/>
    level => "level"

state  <ros_rate_callback name="‸"/>
    clockwork : 10 Hz

callback  <ros_topic_publish name="twist"><field name="‸" expr="1.0"/></ros_topic_publish>
    linear.x : float64
    angular.z : float64

callback  <ros_service_send_request name="trigger"><field name="da‸"/></ros_service_send_request>
    data : bool
    only

top  <ros_topic_subscriber name="x" topic="‸" type="std_msgs/Int32"/>
    /level : std_msgs/Int32 · Node, BT_plugin_1001_Walk, Other
    /plan

walk  <ros_topic_subscriber name="x"><topic>‸</topic></ros_topic_subscriber>
    /level
    bt_get_input

top  <ros_topic_subscriber name="x" topic="x" type="std_m‸"/>
    std_msgs/Int32
    std_msgs/Bool
    no std_srvs/SetBool

top  <ros_service_server name="x" service_name="‸" type="std_srvs/‸"/>
    /trigger : std_srvs/SetBool · Node

data  <data id="a" type="‸"/>
    Pose : struct
    Path
    bool
    int32
    float64

data  <data id="a" type="Path" expr="‸"/>
    {'poses': []} => {'poses': [$1]\}

data  <data id="a" type="bool" expr="‸"/>
    false
    true

data  <data id="‸" type="bool" expr="false"/>
    nothing

types  <struct id="B"><member id="m" type="‸"/></struct>
    Pose
    uint8

callback  <assign location="ready" expr="new_name"/><assign location="count" expr="1"/><!----><if cond="‸"/>
    ready : bool
    true

state  <transition><target id="start" prob="0.25"/><target id="‸" prob="‸"/></transition>
    start
    stop

walk  <bt_declare_port_in key="‸" type="int32"/>
    CHILDREN_COUNT

tick  <bt_return_status status="‸"/>
    SUCCESS
    FAILURE
    RUNNING
    only

tick  <bt_set_output key="‸" expr="true"/>
    reached : bool
    only

tick  <assign location="x"><expr><bt_get_input key="‸"/></expr></assign>
    goal : int32
    topic : string
    no reached

tree  <Walk goal="‸" topic="/level" reached="{there}"/>
    {there} : blackboard => {there\}
    {goal} : new blackboard variable => {goal\}

tree  <Walk goal="{‸}" topic="‸/level" reached="{there}"/>
    {there}

tree  <Walk topic="‸"/>
    /level : std_msgs/Int32 · Node, BT_plugin_1001_Walk, Other

tree  <SubTree ID="‸"/>
    Rest
    Home

tree  <SubTree ID="Home" where="‸"/>
    {=}
    {there}

tree  <SubTree ID="Home" _autoremap="‸"/>
    true
    false

tree  <Action ID="‸"/>
    Walk : in goal: int32, in topic: string, out reached: bool
    AlwaysSuccess

tree  <Delay delay_msec="‸"><AlwaysSuccess/></Delay>
    {there}
"""

EXPRESSIONS = """
callback  <assign location="count" expr="‸"/>
    count : int32
    _msg
    pose : Pose
    Math.floor => Math.floor(${1:x})
    no _event.data

callback  <assign location="count" expr="_msg.‸"/>
    header
    poses : geometry_msgs/PoseStamped[]
    only

callback  <assign location="count" expr="1 + _msg.poses[count].pose.po‸sition.x"/>
    position

callback  <assign location="count" expr="_msg.poses[path.poses[0].x].header.stamp.‸ + 1"/>
    sec : int32
    nanosec : uint32
    only

callback  <assign location="count" expr="_msg.poses.‸"/>
    length : int
    pose

go  <assign location="count" expr="_event.‸"/>
    data
    only

go  <assign location="count" expr="_event.data.‸"/>
    speed : float
    to : Pose
    only

go  <assign location="count" expr="(_event.data.to.‸"/>
    x : float64
    seen : bool
    only

go  <assign location="‸" expr="1"/>
    pose
    path
    count
    no true

go  <assign location="pose.‸" expr="1"/>
    x
    seen

state  <transition cond="count &lt; 3 &amp;&amp; pose.‸" target="start"/>
    x
    seen

state  <transition cond="count &lt; ‸" target="start"/>
    ready
    count

state  <transition cond="Math.‸" target="start"/>
    abs => abs(${1:x})
    log => log(${1:x})
    pow : (x, y) → float => pow(${1:x}, ${2:y})
    random => random()

state  <ros_topic_callback name="plan" cond="_msg.header.‸" target="start"/>
    stamp
    frame_id : string

state  <transition cond="'a ‸'" target="start"/>
    nothing

state  <transition cond="1.‸" target="start"/>
    nothing

entry  <assign location="count"><expr>cou‸</expr></assign>
    count
    ready
    no _msg
    no _event

entry  <assign location="count" expr="pose.x.‸"/>
    nothing

callback  <ros_topic_publish name="twist"><field name="linear.x" expr="‸"/></ros_topic_publish>
    count
    pose

entry  <assign location="ready" expr="‸"/>
    ready
    true
    pose
"""

PROPERTIES = r"""
property  ‸
    property: eventually
    property: always
    property: until
    property: never before
    only

property  {‸}
    name => "name": "$1"
    expression
    comment

property  {"name": "p", "expression": {"op": "‸"}}
    filter => "filter"
    F
    no "F"

property  {"name": "p", "expression": {"op": "F", ‸}}
    exp => "exp": $1
    step-bounds => "step-bounds": {$1\}
    comment

property  {"name": "p", "expression": {"op": "filter", "fun": "‸"}}
    min
    values

property  {"name": "p", "expression": {"op": "=", "left": "topic_l‸", "right": 1}}
    topic_level_msg.valid : bool => "topic_level_msg.valid"
    topic_level_msg__ros_fields__data : int32

property  {"name": "p", "expression": {"op": "=", "left": ‸}}
    go.valid
    {∧} => {"op": "∧", "left": $1, "right": $2\}
    {ite} => {"op": "ite", "if": $1, "then": $2, "else": $3\}

property  {"name": "p", "expression": {"op": "F", "exp": "go.valid", "step-bounds": {"‸"}}}
    lower
    upper

property  {"name": "p", ‸"expression": "a"}
    expression => "expression"
"""


REPORTED = ("tree-element-in-node", "thread-element-outside-thread")


@pytest.mark.parametrize("name", ["node.ascxml", "walk.ascxml"])
@pytest.mark.parametrize(
    "mark", ["data", "top", "entry", "go", "callback", "state", "walk", "tick", "thread", "in-thread"]
)
def test_no_element_is_offered_that_is_reported_at_once(name: str, mark: str) -> None:
    state = '<state id="w"><!--in-thread--></state>'
    thread = f'<ros_action_thread name="t" n_threads="1"><!--thread-->{state}</ros_action_thread>'
    files = {**FILES, name: FILES[name].replace("</ascxml>", f"{thread}</ascxml>")}
    if f"<!--{mark}-->" not in files[name]:
        return
    before, _, after = files[name].partition(f"<!--{mark}-->")

    def moment(text: str) -> Snapshot:
        workspace = Workspace((), Settings(), [path_of("main.xml")])
        for file, content in {**files, name: text}.items():
            workspace.open(path_of(file), content)
        return workspace.snapshot()

    completions = complete(moment(f"{before}<{after}"), path_of(name), len(before) + 1)
    assert completions is not None
    assert completions.items
    for item in completions.items:
        snapshot = moment(f"{before}<{plain(item.snippet)}{after}")
        codes = {diagnostic.code for diagnostic in snapshot.checker.diagnostics(path_of(name))}
        assert not codes.intersection(REPORTED), item.label


def test_elements_of_plugins_are_offered_to_plugins() -> None:
    labels = {item.label for completions in offered("<!--walk-->", "<‸") for item in completions.items}
    assert {"bt_declare_port_in", "bt_declare_port_out"} <= labels
    labels = {item.label for completions in offered("<!--top-->", "<‸") for item in completions.items}
    assert "ros_topic_publisher" in labels
    assert not any(label.startswith("bt_") for label in labels)


def case_list(written: str) -> list[str]:
    return [case.strip("\n") for case in re.split(r"\n\n+", written.strip())]


@pytest.mark.parametrize("case", case_list(ELEMENTS) + case_list(VALUES) + case_list(EXPRESSIONS))
def test_in_xml(case: str) -> None:
    mark, text, expected = parts(case)
    for completions in offered(f"<!--{mark}-->", text)[:1]:
        compare(completions, expected)


@pytest.mark.parametrize("case", case_list(PROPERTIES))
def test_in_properties(case: str) -> None:
    mark, text, expected = parts(case)
    compare(offered(f"//{mark}//", text)[0], expected)


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("new.ascxml", "‸", ["state machine", "behavior tree plugin"]),
        ("new.xml", "‸", ["system", "behavior tree", "struct declarations", "properties"]),
        ("new.xml", "<‸", ["system"]),
        ("new.xml", '<?xml version="1.0"?>‸', None),
        ("main.xml", '<roaml><node_models><input type="‸', ["node-ascxml"]),
        ("main.xml", '<roaml><node_models><input type="node-ascxml" src="‸"/>', ["node.ascxml", "other.ascxml"]),
        ("main.xml", '<roaml><behavior_tree><input type="bt.cpp-xml" src="‸"/>', ["tree.xml"]),
        ("main.xml", '<roaml><behavior_tree><input src="‸"/>', ["walk.ascxml", "tree.xml"]),
        ("main.xml", '<roaml><properties><input type="jani" src="‸"/>', ["properties.jani"]),
        ("main.xml", '<roaml><parameters><max_time value="1" unit="‸"/>', ["s", "ms", "us", "ns"]),
        ("main.xml", "<roaml><‸", ["parameters", "node_models", "properties"]),
        ("main.xml", "<roaml><parameters></‸", ["parameters"]),
        ("folder/tree.xml", '<root BTCPP_format="4"><include path="‸"/></root>', ["../tree.xml"]),
        ("walk2.ascxml", '<ascxml name="‸"/>', ["walk2"]),
        ("s.json", '{"type": "object", ‸}', ["title", "properties"]),
        ("s.json", '{"type": "object", "properties": {"a": {"type": "‸"}}}', ["boolean", "integer", "array"]),
        (
            "s.json",
            '{"type": "object", "properties": {"a": {"$ref": "‸"}}, "$defs": {"P": {"type": "object"}}}',
            ["#/$defs/P"],
        ),
        ("notes.txt", "‸", None),
    ],
)
def test_in_files(name: str, text: str, expected: list[str] | None) -> None:
    text, (caret,), _ = marked(text)
    completions = complete(snapshot({**FILES, name: text}), path_of(name), caret)
    labels = [item.label for item in completions.items] if completions else None
    assert (labels is None) == (expected is None)
    assert [label for label in labels or () if label in (expected or ())] == (expected or []), labels


def test_an_unknown_plugin_is_a_name_for_a_machine() -> None:
    tree = FILES["tree.xml"].replace("<!--tree-->", "<Fly/>")
    walk = FILES["walk.ascxml"].replace('name="Walk"', 'name=""')
    at = walk.index('name=""') + len('name="')
    completions = complete(snapshot({**FILES, "tree.xml": tree, "walk.ascxml": walk}), path_of("walk.ascxml"), at)
    assert completions is not None
    assert [item.label for item in completions.items] == ["Walk", "Fly", "walk"]


def test_names_that_are_used_and_not_defined() -> None:
    text = FILES["node.ascxml"].replace("<!--callback-->", '<assign location="extra" expr="other + 1"/>')
    text = text.replace('target="stop"', 'target="pause"')
    for mark, expected in (('<data id="‸"/>', ["extra", "other"]), ('<state id="‸">', ["pause"])):
        slot = "<!--data-->" if "data" in mark else '<state id="stop">'
        new, (caret,), _ = marked(text.replace(slot, mark))
        completions = complete(snapshot({**FILES, "node.ascxml": new}), path_of("node.ascxml"), caret)
        assert completions is not None
        assert sorted(item.label for item in completions.items) == expected


def test_a_blank_asks_for_attributes_only() -> None:
    for text, expected in (("<transition ‸/>", True), ('<transition event="‸"/>', False), ("‸", False)):
        new, (caret,), _ = marked(FILES["node.ascxml"].replace("<!--state-->", text))
        completions = complete(snapshot({**FILES, "node.ascxml": new}), path_of("node.ascxml"), caret, " ")
        assert (completions is not None) is expected, text


def test_what_is_replaced_lies_in_one_line() -> None:
    new, (caret,), _ = marked(FILES["node.ascxml"].replace("<!--state-->", '<transition event="a\nb‸c\nd"/>'))
    completions = complete(snapshot({**FILES, "node.ascxml": new}), path_of("node.ascxml"), caret)
    assert completions is not None
    assert new[completions.span.start : completions.span.end] == "bc"


def test_types_that_are_used_go_first() -> None:
    completions = offered("<!--top-->", '<ros_topic_publisher name="a" topic="a" type="‸"/>')[0]
    assert completions is not None
    labels = [item.label for item in completions.items]
    assert {"nav_msgs/Path", "std_msgs/Int32", "geometry_msgs/Twist"} == set(labels[:3])
    assert len(labels) > 100


def test_a_long_list_is_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roaml.ide.completion.MAX_ITEMS", 20)
    completions = offered("<!--top-->", '<ros_topic_publisher name="a" topic="a" type="gmpo‸"/>')[0]
    assert completions is not None
    assert completions.incomplete
    assert "geometry_msgs/Point" in [item.label for item in completions.items]
    assert "std_msgs/Int32" not in [item.label for item in completions.items]


def test_every_item_is_documented_or_simple() -> None:
    texts = snapshot(FILES)
    documented = set()
    for slot, text in (
        ("<!--state-->", "<‸"),
        ("<!--state-->", "<transition ‸/>"),
        ("<!--callback-->", '<assign location="count" expr="‸"/>'),
        ("<!--callback-->", '<assign location="count" expr="_msg.‸"/>'),
        ("<!--callback-->", '<ros_topic_publish name="‸"/>'),
        ("<!--tree-->", "<‸"),
        ("<!--tree-->", "<Walk ‸/>"),
        ("<!--tree-->", "<Delay ‸/>"),
        ("<!--data-->", '<data id="a" type="‸"/>'),
        ("<!--go-->", '<send event="‸"/>'),
    ):
        completions = offered(slot, text)[0]
        assert completions is not None
        for item in completions.items:
            if item.about is not None:
                documentation = document(texts.analysis, item.about)
                assert documentation, item
                documented.add(item.about.kind.value)
    assert documented >= {"element", "attribute", "variable", "field", "publisher", "machine", "tree", "port", "event"}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("‸", ("", None)),
        ("a‸b", ("ab", None)),
        ("a.‸", ("", "a")),
        ("a . b‸", ("b", "a")),
        ("x + a[b.c[0]].d.‸e", ("e", "a[b.c[0]].d")),
        ("f(a, b).‸", ("", "f(a, b)")),
        ("(a.‸", ("", "a")),
        ("a[b.‸", ("", "b")),
        ("!a.‸", ("", "a")),
        ("a ].‸", None),
        (".‸", None),
        ("1.‸", None),
        ("12‸", None),
        ("'it is ‸", None),
        ("a &‸", None),
        ("a &amp;&amp; b‸", ("b", None)),
    ],
)
def test_beginning(text: str, expected: tuple[str, str | None] | None) -> None:
    text, (caret,), _ = marked(text)
    actual_beginning = beginning(text, 0, caret)
    assert (
        actual_beginning and (text[actual_beginning.span.start : actual_beginning.span.end], actual_beginning.object)
    ) == expected


def test_plain() -> None:
    snippet = str(Snippet().text("a$}b ").stop(["x,y", "z"]).text("-").stop(["d}"]).text("-").stop().end())
    assert snippet == r"a\$\}b ${1|x\,y,z|}-${2:d\}}-$3$0"
    assert plain(snippet) == "a$}b x,y-d}-"


# ------------------------------------------------------------------------- helpers


def parts(case: str) -> tuple[str, str, list[str]]:
    first, *expected = case.split("\n")
    mark, text = first.split("  ", 1)
    return mark, text, [line.removeprefix("    ") for line in expected]


def snapshot(texts: dict[str, str]) -> Snapshot:
    workspace = Workspace((FOLDER,), Settings())
    for name, text in texts.items():
        workspace.open(path_of(name), text)
    return workspace.snapshot()


def offered(slot: str, text: str) -> list[Completions | None]:
    """The completions at each caret of a text that replaces a mark."""
    name = next(name for name, file_text in FILES.items() if slot in file_text)
    new, carets, _ = marked(FILES[name].replace(slot, text))
    moment = snapshot({**FILES, name: new})
    completion_lists = [complete(moment, path_of(name), caret) for caret in carets]
    for caret, completions in zip(carets, completion_lists, strict=True):
        assert completions is None or completions.span.start <= caret <= completions.span.end
    return completion_lists


def compare(completions: Completions | None, expected: list[str]) -> None:
    items = {item.label: item for item in completions.items} if completions else {}
    if expected == ["nothing"]:
        assert not items
        return
    expected_labels = [line for line in expected if not line.startswith("no ") and line != "only"]
    labels = [re.split(r" => | : ", line)[0] for line in expected_labels]
    order = [label for label in items if label in labels]
    assert order == labels, list(items)
    for line, label in zip(expected_labels, labels, strict=True):
        if expected_detail := re.search(r" : (.*?)(?: => |$)", line.split(" => ")[0]):
            assert items[label].detail.startswith(expected_detail[1]), items[label]
        if " => " in line:
            inserted = line.split(" => ")[1].replace("\\n", "\n").replace("\\t", "\t")
            if inserted.endswith("…"):
                assert items[label].snippet.startswith(inserted.removesuffix("…"))
            else:
                assert items[label].snippet == inserted
    for line in expected:
        if line.startswith("no "):
            assert line.removeprefix("no ") not in items
    if "only" in expected:
        assert len(items) == len(expected_labels), list(items)
