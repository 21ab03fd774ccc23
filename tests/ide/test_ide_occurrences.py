# SPDX-License-Identifier: Apache-2.0
"""What each name in a file denotes, in a system and alone."""

from __future__ import annotations

from pathlib import Path

import pytest
from ide_models import found, load, load_marked, system_file

from fixture import split_files
from roaml.ide.names.frames import Trees
from roaml.ide.names.in_properties import names
from roaml.ide.names.occurrences import occurrences, trees_of
from roaml.project.analysis import Analysis

ALONE = {
    "states and variables": """
<ascxml name="M" version="1.0" initial="a">
              ^ defines machine M
                                        ^ names state a
  <datamodel>
    <data id="n" type="int32" expr="0"/>
              ^ defines variable n
    <data id="v" type="float64[4]" expr="[]"/>
              ^ defines variable v
  </datamodel>
  <state id="a">
             ^ defines state a
    <transition event="go" cond="n &lt; v[n] &amp;&amp; _event.data.k == 1" target="a">
                       ^^ reads event go
                                 ^ reads variable n
                                        ^ reads variable v
                                          ^ reads variable n
                                                                    ^ reads parameter k in go
                                                                                    ^ names state a
      <assign location="v[n]" expr="Math.abs(n)"/>
                        ^ writes variable v
                          ^ reads variable n
                                             ^ reads variable n
      <send event="go"><param name="k" expr="n"/></send>
                   ^^ defines event go
                                    ^ defines parameter k in go
                                             ^ reads variable n
    </transition>
  </state>
</ascxml>
""",
    "handles": """
<ascxml name="M" version="1.0" initial="a">
              ^ defines machine M
                                        ^ names state a
  <ros_topic_publisher name="out" topic="/x/y" type="std_msgs/msg/Int32"/>
                             ^^^ defines publisher out
                                          ^^^ defines topic x__y
                                                     ^^^^^^^^^^^^^^^^^^ names ros-type std_msgs/Int32 in msg
  <ros_topic_subscriber topic="/x/z" type="std_msgs/Int32"/>
                                ^^^ names topic x__z
                                           ^^^^^^^^^^^^^^ names ros-type std_msgs/Int32 in msg
  <ros_time_rate name="clock" rate_hz="1"/>
                       ^^^^^ defines timer clock
  <state id="a">
             ^ defines state a
    <ros_rate_callback name="clock" target="a">
                             ^^^^^ reads timer clock
                                            ^ names state a
      <ros_topic_publish name="out"><field name="data" expr="1"/></ros_topic_publish>
                               ^^^ writes publisher out
                                                 ^^^^ writes field data in std_msgs/Int32
    </ros_rate_callback>
    <ros_topic_callback name="/x/z" cond="_msg.data == 1" target="a"/>
                               ^^^ reads topic x__z
                                               ^^^^ reads field data in std_msgs/Int32
                                                                  ^ names state a
  </state>
</ascxml>
""",
    "a type in a comment": """
<ascxml name="M" version="1.0" initial="a">
              ^ defines machine M
                                        ^ names state a
  <datamodel>
    <!-- TYPE level:Pose[] -->
              ^^^^^ names variable level
                    ^^^^ names struct Pose
    <data id="level" expr="[]"/>
              ^^^^^ defines variable level
  </datamodel>
  <state id="a"/>
             ^ defines state a
</ascxml>
""",
    "threads and protocol of the tree": """
<ascxml name="M" version="1.0" initial="a">
              ^ defines machine M
                                        ^ names state a
  <datamodel><data id="i" type="int8" expr="0"/></datamodel>
                       ^ defines variable i
  <ros_action_server name="fib" action_name="/fib"
                           ^^^ defines action-server fib
                                             ^^^^ defines action /fib
                     type="example_interfaces/Fibonacci"/>
                           ^^^^^^^^^^^^^^^^^^^^^^^^^^^^ names ros-type example_interfaces/Fibonacci in action
  <state id="a">
             ^ defines state a
    <bt_tick target="a"><bt_tick_child id="i"/><bt_tick_child id="0"/></bt_tick>
                     ^ names state a
                                           ^ reads variable i
    <bt_child_status id="i" cond="_bt.status == SUCCESS" target="a"><bt_return_status status="i"/></bt_child_status>
                         ^ reads variable i
                                                                 ^ names state a
                                                                                              ^ reads variable i
  </state>
  <ros_action_thread name="fib" n_threads="2" initial="a">
                           ^^^ names action-server fib
                                                       ^ names state a in thread 0
    <datamodel><data id="i" type="int32" expr="0"/></datamodel>
                         ^ defines variable i in thread 0
    <state id="a">
               ^ defines state a in thread 0
      <ros_action_handle_thread_start name="fib" target="a">
                                            ^^^ reads action-server fib
                                                         ^ names state a in thread 0
        <assign location="i" expr="_goal.order"/>
                          ^ writes variable i in thread 0
                                         ^^^^^ reads field order in example_interfaces/Fibonacci goal
      </ros_action_handle_thread_start>
    </state>
  </ros_action_thread>
</ascxml>
""",
    "half-typed": """
<ascxml name="M" initial="a">
              ^ defines machine M
                          ^ names state a
  <state id="a">
             ^ defines state a
    <transition event="" target="b" cond="_event.data.
                                 ^ names state b
""",
    "a tree": """
<root BTCPP_format="4" main_tree_to_execute="Main">
                                             ^^^^ names tree Main
  <BehaviorTree ID="Main">
                    ^^^^ defines tree Main
    <Walk goal="{ there }" speed="1">
     ^^^^ names plugin Walk
                  ^^^^^ names blackboard there in Main
      <SubTree ID="Sub" p="{there}" q="{=}"/>
                   ^^^ names tree Sub
                        ^ names blackboard p in Sub
                            ^^^^^ names blackboard there in Main
                                    ^ names blackboard q in Main
    </Walk>
      ^^^^ names plugin Walk
  </BehaviorTree>
  <BehaviorTree ID="Sub"><Walk goal="{p}" name="w" other="{q}" main="{@there}"/></BehaviorTree>
                    ^^^ defines tree Sub
                          ^^^^ names plugin Walk
                                      ^ names blackboard p in Sub
                                                ^ defines tree-node w in Sub:0
                                                           ^ names blackboard q in Main
                                                                       ^^^^^ names blackboard there in Main
</root>
""",
    "structs": """
<types>
  <struct id="Pose"><member id="x" type="float64"/><member id="to" type="Pose[2]"/></struct>
              ^^^^ defines struct Pose
                                ^ defines member x in Pose
                                                               ^^ defines member to in Pose
                                                                         ^^^^ names struct Pose
</types>
""",
}


@pytest.mark.parametrize("written", ALONE.values(), ids=ALONE)
def test_alone(written: str, tmp_path: Path) -> None:
    analysis, cases = load_marked(tmp_path, written)
    for name, case in cases.items():
        assert found(occurrences(analysis, str(tmp_path / name))) == case.found


MAIN = system_file(
    "data_declarations xml types.xml",
    "data_declarations json shape.json",
    "behavior_tree bt.cpp-xml tree.xml",
    "behavior_tree bt-plugin-ascxml plugin.ascxml",
    "node_models node-ascxml a.ascxml",
    "properties jani properties.jani",
)
SYSTEM = (
    f"-- main.xml --\n{MAIN}\n"
    """
-- types.xml --
<types><struct id="Pose"><member id="x" type="float64"/></struct></types>
                   ^^^^ defines struct Pose
                                     ^ defines member x in Pose
-- shape.json --
{"type": "object", "title": "Shape", "properties": {"at": {"type": "object", "properties": {"y": {"type": "number"}}},
                             ^^^^^ defines struct Shape
                                                     ^^ defines member at in Shape
                                                     ^^ defines struct at
                                                                                             ^ defines member y in at
  "of": {"$ref": "#/$defs/Deep"}}, "$defs": {"Deep": {"type": "object", "properties": {"z": {"type": "number"}}}}}
   ^^ defines member of in Shape
                          ^^^^ defines struct Deep
                                              ^^^^ defines struct Deep
                                                                                        ^ defines member z in Deep
-- a.ascxml --
<ascxml name="A" version="1.0" initial="s">
              ^ defines machine A
                                        ^ names state s
  <datamodel><data id="p" type="Pose" expr="{'x': 1.0}"/></datamodel>
                       ^ defines variable p
                                ^^^^ names struct Pose
                                              ^ writes member x in Pose
  <state id="s">
             ^ defines state s
    <onentry><send event="go"><param name="to" expr="p"/></send></onentry>
                          ^^ defines event go
                                           ^^ defines parameter to in go
                                                     ^ reads variable p
    <transition event="go" target="s"><assign location="p.x" expr="_event.data.to.x"/></transition>
                       ^^ reads event go
                                   ^ names state s
                                                        ^ writes variable p
                                                          ^ writes member x in Pose
                                                                               ^^ reads parameter to in go
                                                                                  ^ reads member x in Pose
  </state>
</ascxml>
-- plugin.ascxml --
<ascxml name="Walk" version="1.0" initial="s">
              ^^^^ defines machine Walk
                                           ^ names state s
  <bt_declare_port_in key="goal" type="int32"/>
                           ^^^^ defines port goal
  <bt_declare_port_in key="topic" type="string"/>
                           ^^^^^ defines port topic
  <bt_declare_port_out key="out" type="int32"/>
                            ^^^ defines port out
  <datamodel><data id="n" type="int32" expr="0"/></datamodel>
                       ^ defines variable n
  <ros_topic_publisher name="pub" type="std_msgs/Int32"><topic><bt_get_input key="topic"/></topic></ros_topic_publisher>
                             ^^^ defines publisher pub
                                        ^^^^^^^^^^^^^^ names ros-type std_msgs/Int32 in msg
                                                                                  ^^^^^ reads port topic
  <state id="s">
             ^ defines state s
    <bt_tick target="s">
                     ^ names state s
      <assign location="n"><expr><bt_get_input key="goal"/></expr></assign>
                        ^ writes variable n
                                                    ^^^^ reads port goal
      <bt_set_output key="out" expr="n"/>
                          ^^^ writes port out
                                     ^ reads variable n
      <ros_topic_publish name="pub"><field name="data" expr="n"/></ros_topic_publish>
                               ^^^ writes publisher pub
                                                 ^^^^ writes field data in std_msgs/Int32
                                                             ^ reads variable n
      <bt_return_status status="SUCCESS"/>
    </bt_tick>
    <bt_halt target="s"><bt_return_halted/></bt_halt>
                     ^ names state s
  </state>
</ascxml>
-- tree.xml --
<root BTCPP_format="4" main_tree_to_execute="Main">
                                             ^^^^ names tree Main
  <BehaviorTree ID="Main">
                    ^^^^ defines tree Main
    <Sequence>
     ^^^^^^^^ names plugin Sequence
      <Walk goal="{g}" out="{g}" topic=" /a/b "/>
       ^^^^ names machine Walk
            ^^^^ names port goal
                   ^ reads blackboard g in Main
                       ^^^ names port out
                             ^ defines blackboard g in Main
                                 ^^^^^ names port topic
                                          ^^^ names topic a__b
      <SubTree ID="Sub" t="/c" g="{g}" _autoremap="true"/>
                   ^^^ names tree Sub
                        ^ names blackboard t in Sub
                            ^ names topic c
                               ^ names blackboard g in Sub
                                   ^ names blackboard g in Main
    </Sequence>
      ^^^^^^^^ names plugin Sequence
  </BehaviorTree>
  <BehaviorTree ID="Sub"><Action ID="Walk" name="w" goal="{g}" out="{own}" topic="{t}"/></BehaviorTree>
                    ^^^ defines tree Sub
                                     ^^^^ names machine Walk
                                                 ^ defines tree-node w in Sub:0
                                                    ^^^^ names port goal
                                                           ^ reads blackboard g in Sub
                                                               ^^^ names port out
                                                                     ^^^ defines blackboard own in Sub
                                                                           ^^^^^ names port topic
                                                                                   ^ reads blackboard t in Sub
  <TreeNodesModel><Action ID="Walk"><input_port name="goal"/></Action></TreeNodesModel>
                              ^^^^ names machine Walk
                                                      ^^^^ names port goal
</root>
-- properties.jani --
{"properties": [{"name": "p", "expression": {"op": "∧", "left": "go.valid", "right":
                                                                 ^^ reads event go
  {"op": "<", "left": "go__to__x", "right":
                       ^^ reads event go
                           ^^ reads parameter to in go
                               ^ reads member x in Pose
  {"op": "+", "left": "topic_a__b_msg__ros_fields__data", "right":
                             ^^^^ reads topic a__b
                                                   ^^^^ reads field data in std_msgs/Int32
  {"op": "+", "left": "bt_blackboard_get__Sub__own", "right": "bt_blackboard_set_g__value"}}}}}]}
                                          ^^^ reads tree Sub
                                               ^^^ reads blackboard own in Sub
                                                                                 ^ reads blackboard g in Main
"""
)


def test_in_a_system(tmp_path: Path) -> None:
    analysis, cases = load_marked(tmp_path, SYSTEM)
    main = str(tmp_path / "main.xml")
    for name, case in cases.items():
        assert found(occurrences(analysis, str(tmp_path / name), main)) == case.found, name


def test_each_global_variable_is_the_sum_of_its_parts(tmp_path: Path) -> None:
    analysis, _ = load_marked(tmp_path, SYSTEM)
    main = str(tmp_path / "main.xml")
    system = analysis.system(main)
    assert system is not None
    find = analysis.environment(main).interface
    table = names(system, analysis.globals(main), trees_of(analysis, main, main), find)
    assert {name: "".join(piece[0] for piece in pieces) for name, pieces in table.items()} == {
        name: name for name in analysis.globals(main)
    }


def test_trees_are_walked_as_they_are_expanded(tmp_path: Path) -> None:
    analysis, _ = load_marked(tmp_path, SYSTEM)
    main = str(tmp_path / "main.xml")
    system = analysis.system(main)
    assert system is not None
    walked: Trees = trees_of(analysis, main, main)
    assert [(number, node.plugin.value if node.plugin else "") for number, (_, node) in walked.nodes.items()] == [
        (instance.number, instance.plugin) for instance in system.instances
    ]
    assert set(walked.full_names) >= set(system.blackboard)


PLUGIN = """-- walk.ascxml --
<ascxml name="Walk" version="1.0" initial="s">
    <bt_declare_port_in key="goal" type="int32" />
    <bt_declare_port_out key="end" type="int32" />
    <state id="s"><bt_tick target="s"><bt_return_status status="SUCCESS" /></bt_tick></state>
</ascxml>
"""


def system_of_trees(tmp_path: Path, trees: str) -> Analysis:
    main = system_file("behavior_tree bt.cpp-xml tree.xml", "behavior_tree bt-plugin-ascxml walk.ascxml")
    return load(tmp_path, split_files(f"{PLUGIN}-- main.xml --\n{main}\n{trees}"))


def test_variables_are_those_of_the_translation(tmp_path: Path) -> None:
    """`{=}` is `{x}`: `A` uses the variable, so automatic remapping leads there as well."""
    analysis = system_of_trees(
        tmp_path,
        """-- tree.xml --
<root BTCPP_format="4" main_tree_to_execute="Main">
    <BehaviorTree ID="Main"><SubTree ID="A" /></BehaviorTree>
    <BehaviorTree ID="A">
        <Sequence><SubTree ID="B" x="{=}" /><SubTree ID="C" _autoremap="true" /></Sequence>
    </BehaviorTree>
    <BehaviorTree ID="B"><Walk end="{x}" goal="1" /></BehaviorTree>
    <BehaviorTree ID="C"><Walk end="{x}" goal="{x}" /></BehaviorTree>
</root>
""",
    )
    main = str(tmp_path / "main.xml")
    system = analysis.system(main)
    assert system is not None
    assert set(system.blackboard) == {"A__x"}
    assert set(trees_of(analysis, main, main).full_names) >= set(system.blackboard)


def test_trees_of_a_project_are_not_executed(tmp_path: Path) -> None:
    """A project lists subtrees. An unused tree in it does not make the executed tree ambiguous."""
    analysis = system_of_trees(
        tmp_path,
        """-- tree.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Main"><SubTree ID="Sub" /></BehaviorTree>
</root>
-- robot.btproj --
<root BTCPP_format="4" project_name="robot"><include path="tree.xml" /><include path="other.xml" /></root>
-- other.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Sub"><Walk end="{x}" goal="1" /></BehaviorTree>
    <BehaviorTree ID="Unused"><Walk end="{x}" goal="1" /></BehaviorTree>
</root>
""",
    )
    main = str(tmp_path / "main.xml")
    system = analysis.system(main)
    assert system is not None
    assert set(system.blackboard) == {"Sub__x"}
    assert set(trees_of(analysis, main, main).full_names) == {"Sub__x"}


def test_damaged_documents(tmp_path: Path) -> None:
    """Each prefix of each file: no exception, and no place outside of the text."""
    _, cases = load_marked(tmp_path, SYSTEM)
    for name, case in cases.items():
        for end in range(0, len(case.text), 37):
            analysis = load(tmp_path, {**{n: c.text for n, c in cases.items()}, name: case.text[:end]})
            for path in analysis.files_of(str(tmp_path / "main.xml")):
                for occurrence in occurrences(analysis, path, str(tmp_path / "main.xml")):
                    source = analysis.source(path)
                    assert source is not None
                    assert 0 <= occurrence.span.start <= occurrence.span.end <= len(source.text)
