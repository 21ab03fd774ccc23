# SPDX-License-Identifier: Apache-2.0
"""Code actions: the caret `‸` in a text, the title of an action, and the files after it. No action adds an error."""

from __future__ import annotations

from collections import Counter

import pytest
from ide_case import marked, path_of
from ide_models import system_file

from fixture import split_files
from mending import applied, found
from roaml.diagnostics import Severity
from roaml.ide.code_actions import actions
from roaml.ide.code_actions.action import FIX_ALL, QUICK_FIX, CodeAction
from roaml.ide.code_actions.harmless import _HIDING
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace
from roaml.rules import RULES
from roaml.text import Span


def opened(written: str) -> tuple[Snapshot, str, Span]:
    """A moment with some files, the one with the caret, and the caret or selection."""
    workspace = Workspace((path_of(""),), Settings())
    where = ("", Span(0, 0))
    for name, text in split_files(written).items():
        clean, carets, _ = marked(text)
        if carets:
            where = (path_of(name), Span(carets[0], carets[-1]))
        workspace.open(path_of(name), clean)
    return workspace.snapshot(), *where


def offered(written: str, kind: str = "") -> list[CodeAction]:
    snapshot, path, place = opened(written)
    return list(actions(snapshot, path, place, lambda text: text.startswith(kind)))


def done(written: str, title: str) -> dict[str, str]:
    """The files that an action changes, with their new texts."""
    snapshot, path, place = opened(written)
    chosen = [action for action in actions(snapshot, path, place, lambda _: True) if action.title == title]
    assert len(chosen) == 1, [action.title for action in actions(snapshot, path, place, lambda _: True)]
    texts = applied(snapshot, chosen[0].make())
    before, after = (
        Counter(d.code for d in found(current) if d.severity is Severity.ERROR)
        for current in (snapshot, snapshot.with_texts(texts))
    )
    assert not after - before
    folder = path_of("")
    return {path.removeprefix(folder).replace("\\", "/").lstrip("/"): text for path, text in texts.items()}


def new_warnings(snapshot: Snapshot, texts: dict[str, str]) -> set[str]:
    """The codes of new findings of any severity except hints."""
    before, after = (
        Counter(d.code for d in found(current) if d.severity >= Severity.INFORMATION)
        for current in (snapshot, snapshot.with_texts(texts))
    )
    return set(after - before)


def titles(written: str, kind: str = "refactor") -> list[str]:
    return [action.title for action in offered(written, kind)]


# ------------------------------------------------------------------ machines

PLUGIN = """\
<ascxml name="Walk" version="1.0" initial="ready">
  <state id="ready">
    <bt_tick target="ready">‸<bt_return_status status="SUCCESS" /></bt_tick>
  </state>
  <state id="busy">
    <bt_tick target="ready"><bt_return_status status="SUCCESS" /></bt_tick>
  </state>
</ascxml>
"""
HALT = """
    <bt_halt target="ready">
      <bt_return_halted />
    </bt_halt>"""


def test_halt_in_one_state() -> None:
    first = PLUGIN.replace("‸", "").replace("</bt_tick>", "</bt_tick>" + HALT, 1)
    assert done(PLUGIN, "Add `<bt_halt>` to this state") == {"machine.ascxml": first}


def test_halt_in_all_states() -> None:
    title = "Add `<bt_halt>` to every state with `<bt_tick>`"
    every = PLUGIN.replace("‸", "").replace("</bt_tick>", "</bt_tick>" + HALT)
    assert done(PLUGIN, title) == {"machine.ascxml": every}
    assert titles(every.replace("<bt_tick", "‸<bt_tick", 1)) == []


CLIENT = """\
<ascxml name="Client" version="1.0" initial="wait">
\t<ros_action_client name="fib" action_name="fib" type="example_interfaces/Fibonacci" />
\t<state id="wait">‸
\t\t<onentry><ros_action_send_goal name="fib"><field name="order" expr="3" /></ros_action_send_goal></onentry>
\t</state>
</ascxml>
"""


def test_all_results() -> None:
    results = "".join(
        f'\n\t\t<ros_action_handle_{result}_result name="fib" target="wait" />'
        for result in ("success", "canceled", "aborted")
    )
    after = CLIENT.replace("‸", "").replace("</onentry>", "</onentry>" + results)
    assert done(CLIENT, "Handle all results of `fib` in this state") == {"machine.ascxml": after}


def test_the_other_results() -> None:
    handled = '\n\t\t<ros_action_handle_success_result name="fib" target="wait" />'
    before = CLIENT.replace("</onentry>", f"</onentry>{handled}")
    after = done(before, "Handle the other results of `fib` in this state")["machine.ascxml"]
    assert after.count("_result ") == 3
    assert titles(after.replace("<onentry>", "‸<onentry>")) == []


@pytest.mark.parametrize(
    ("use", "type_"),
    [
        ('<assign location="n" expr="m‸ + 1" />', "int16"),
        ('<assign location="m‸" expr="2.5" />', "float64"),
        ('<assign location="m‸" expr="n" />', "int16"),
        ('<if cond="m‸"><send event="e" /></if>', "bool"),
        ('<if cond="!m‸ || n == 1"><send event="e" /></if>', "bool"),
        ('<if cond="n &lt; m‸"><send event="e" /></if>', "int16"),
        ("""<if cond="m‸ == 'a'"><send event="e" /></if>""", "string"),
    ],
)
def test_declare_with_the_inferred_type(use: str, type_: str) -> None:
    value = {"int16": "0", "float64": "0.0", "bool": "false", "string": "''"}[type_]
    text = f"""\
<ascxml name="A" version="1.0" initial="a">
    <datamodel>
        <data id="n" type="int16" expr="0" />
    </datamodel>
    <state id="a">
        <transition event="e" target="a">
            {use}
        </transition>
    </state>
</ascxml>
"""
    new = f'<data id="m" type="{type_}" expr="{value}" />'
    after = text.replace("‸", "").replace('expr="0" />', f'expr="0" />\n        {new}', 1)
    assert done(text, f"Declare `m` as {type_}") == {"machine.ascxml": after}


# --------------------------------------------------------------------- trees

TREE = "<root BTCPP_format='4'>\n <BehaviorTree ID='T'>\n  {}\n </BehaviorTree>\n</root>\n"


@pytest.mark.parametrize(
    ("explicit", "compact"),
    [
        ('<Action ID="Walk" speed="1"/>', '<Walk speed="1"/>'),
        (
            '<Control ID="Sequence"><AlwaysSuccess/><AlwaysFailure/></Control>',
            "<Sequence><AlwaysSuccess/><AlwaysFailure/></Sequence>",
        ),
        (
            '<Decorator ID="Inverter" name="x"><AlwaysSuccess/></Decorator>',
            '<Inverter name="x"><AlwaysSuccess/></Inverter>',
        ),
    ],
)
def test_explicit_and_compact_form(explicit: str, compact: str) -> None:
    shorter = done(TREE.format("‸" + explicit), "Write the node in its compact form")
    assert shorter == {"tree.xml": TREE.format(compact)}
    longer = done(TREE.format("‸" + compact), "Write the node in its explicit form")
    assert longer == {"tree.xml": TREE.format(explicit)}


def test_all_nodes() -> None:
    text = TREE.format('<Sequence><Action ID="Walk"/><SubTree ID="T2"/><Walk/></Sequence>').replace("<root", "‸<root")
    compact = done(text, "Write all nodes in their compact form")["tree.xml"]
    assert compact == TREE.format('<Sequence><Walk/><SubTree ID="T2"/><Walk/></Sequence>')
    explicit = done(text, "Write all nodes in their explicit form")["tree.xml"]
    assert '<Control ID="Sequence"><Action ID="Walk"/><SubTree ID="T2"/><Action ID="Walk"/></Control>' in explicit


def test_the_model_of_a_node_says_what_kind_it_is() -> None:
    text = TREE.format("‸<See/>").replace(
        "</root>", ' <TreeNodesModel>\n  <Condition ID="See"/>\n </TreeNodesModel>\n</root>'
    )
    assert '<Condition ID="See"/>\n </Behavior' in done(text, "Write the node in its explicit form")["tree.xml"]


SYSTEM = (
    "-- main.xml --\n"
    + system_file("behavior_tree bt.cpp-xml tree.xml", "behavior_tree bt-plugin-ascxml plugins/count_up.ascxml")
    + """
-- tree.xml --
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <CountUp sum="{sum}" />
      <‸GoHome from="{sum}" speed="0.5" loud="true" to="kitchen" />
    </Sequence>
  </BehaviorTree>
</root>
-- plugins/count_up.ascxml --
<ascxml name="CountUp" version="1.0" initial="a">
  <bt_declare_port_out key="sum" type="int16" />
  <state id="a">
    <bt_tick target="a"><bt_set_output key="sum" expr="1" /><bt_return_status status="SUCCESS" /></bt_tick>
    <bt_halt target="a"><bt_return_halted /></bt_halt>
  </state>
</ascxml>
"""
)


def test_a_new_plugin() -> None:
    """The plugin has the ports that the node sets, is in the folder of the other plugins, and is listed."""
    snapshot, path, place = opened(SYSTEM)
    title = "Create the plugin `GoHome` in `go_home.ascxml`"
    kinds = [action.kind for action in actions(snapshot, path, place, lambda _: True) if action.title == title]
    assert sorted(kinds) == ["quickfix", "refactor.extract"]
    chosen = next(action for action in offered(SYSTEM, "refactor.extract") if action.title == title)
    texts = applied(snapshot, chosen.make())
    plugin, system = texts[path_of("plugins/go_home.ascxml")], texts[path_of("main.xml")]
    for port in (
        '<bt_declare_port_in key="from" type="int16" />',
        '<bt_declare_port_in key="speed" type="float64" />',
        '<bt_declare_port_in key="loud" type="bool" />',
        '<bt_declare_port_in key="to" type="string" />',
    ):
        assert port in plugin
    assert '<input type="bt-plugin-ascxml" src="plugins/go_home.ascxml" />' in system
    assert not new_warnings(snapshot, texts)


def test_ports_of_different_types() -> None:
    """Either port can get the type of the other one, in the file of its machine."""
    plugin = """
<ascxml name="{name}" version="1.0" initial="ready">
    <bt_declare_port_in key="{port}" type="{type}" />
    <state id="ready">
        <bt_tick target="ready"><bt_return_status status="SUCCESS" /></bt_tick>
        <bt_halt target="ready"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
"""
    one = plugin.format(name="One", port="a", type="int8")
    two = plugin.format(name="Two", port="b", type="int16")
    inputs = "".join(f'<input type="bt-plugin-ascxml" src="{name}.ascxml" />' for name in ("one", "two"))
    files = f"""-- main.xml --
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <behavior_tree><input type="bt.cpp-xml" src="tree.xml" />{inputs}</behavior_tree>
</roaml>
-- tree.xml --
<root BTCPP_format="4"><BehaviorTree ID="Main">
    <Sequence><SetBlackboard value="3" output_key="x" /><One a="{{x}}" /><Two b="{{‸x}}" /></Sequence>
</BehaviorTree></root>
-- one.ascxml --{one}-- two.ascxml --{two}"""
    first, second = done(files, "Declare `b` of `Two` as int8"), done(files, "Declare `a` of `One` as int16")
    assert [text.strip() for text in first.values()] == [two.replace("int16", "int8").strip()]
    assert [text.strip() for text in second.values()] == [one.replace("int8", "int16").strip()]


def test_mocks_for_leaves() -> None:
    """For the leaf at the caret, for all leaves of a system, and a new system for a tree without one."""
    two = SYSTEM.replace("<CountUp", '<Turn angle="{sum}" /><CountUp')
    assert set(done(two, "Create a mock of `GoHome`")) == {"main.xml", "mock_go_home.ascxml"}
    after = done(two, "Create mocks for 2 leaves")
    assert set(after) == {"main.xml", "mock_turn.ascxml", "mock_go_home.ascxml"}
    assert '<bt_declare_port_in key="angle" type="int16" />' in after["mock_turn.ascxml"]
    lone = """-- tree.xml --
<root BTCPP_format="4"><Behavior‸Tree ID="Main"><Sequence name="all">
<ComputePathToPose goal="{goal}" path="{path}"/><Mine path="{path}" speed="2"/><Mine name="again"/>
</Sequence></BehaviorTree></root>
"""
    after = done(lone, "Create a system with mocks for the leaves")
    mocks = {"mock_compute_path_to_pose.ascxml", "mock_mine.ascxml"}
    assert set(after) == {"tree.xml", "tree_system.xml", "tree_properties.xml"} | mocks
    assert '<Action ID="Mine"><input_port name="path"' in after["tree.xml"]
    for name in ("tree_succeeds", "reaches_ComputePathToPose_1001", "reaches_Mine_1003"):
        assert f'id="{name}"' in after["tree_properties.xml"]


def test_a_new_decorator_does_as_its_child_does() -> None:
    written = SYSTEM.replace(
        'GoHome from="{sum}" speed="0.5" loud="true" to="kitchen" />', 'Guard sum="{sum}"><AlwaysSuccess/></Guard>'
    )
    snapshot, path, place = opened(written)
    chosen = next(action for action in actions(snapshot, path, place, lambda _: True) if "`Guard`" in action.title)
    assert not new_warnings(snapshot, applied(snapshot, chosen.make()))


def test_the_file_of_a_plugin_that_is_not_listed() -> None:
    known = SYSTEM + PLUGIN.replace("Walk", "GoHome").replace("‸", "").join(("-- other/home.ascxml --\n", ""))
    known = known.replace(' from="{sum}" speed="0.5" loud="true" to="kitchen"', "")
    after = done(known.replace("</bt_tick>\n", f"</bt_tick>{HALT}\n"), "List `home.ascxml` in `main.xml`")
    assert list(after) == ["main.xml"]
    assert '<input type="bt-plugin-ascxml" src="other/home.ascxml" />' in after["main.xml"]


CALLS = """\
-- main.xml --
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <node_models>
        <input type="node-ascxml" src="robot.ascxml" />
        <input type="node-ascxml" src="timer.ascxml" />
    </node_models>
    <properties><input type="jani" src="p.jani" /></properties>
</roaml>
-- robot.ascxml --
<ascxml name="Robot" version="1.0" initial="a">
    <ros_service_client name="speak" service_name="/Narrator/‸Narrate" type="std_srvs/Empty" />
    <state id="a"><onentry><ros_service_send_request name="speak" /></onentry>
        <ros_service_handle_response name="speak" target="b" />
    </state>
    <state id="b" />
</ascxml>
-- timer.ascxml --
<ascxml name="Timer" version="1.0" initial="a">
    <ros_service_server name="stop" service_name="/Navigator/Start" type="std_srvs/Empty" />
    <state id="a">
        <ros_service_handle_request name="stop" target="a"><ros_service_send_response name="stop" />
        </ros_service_handle_request>
    </state>
</ascxml>
-- p.jani --
{"properties": []}
"""
NARRATOR = """\
-- nodes/narrator.ascxml --
<ascxml name="Narrator" version="1.0" initial="a">
    <ros_service_server name="speak" service_name="/Narrator/Narrate" type="std_srvs/Empty" />
    <state id="a">
        <ros_service_handle_request name="speak" target="a"><ros_service_send_response name="speak" />
        </ros_service_handle_request>
    </state>
</ascxml>
"""


def test_the_file_of_a_server_that_is_not_listed() -> None:
    assert not offered(CALLS, QUICK_FIX), "a server whose name is not similar"
    after = done(CALLS + NARRATOR, "List `narrator.ascxml` in `main.xml`")
    assert list(after) == ["main.xml"]
    assert '<input type="node-ascxml" src="nodes/narrator.ascxml" />' in after["main.xml"]


def test_a_fix_that_adds_a_finding_is_not_offered() -> None:
    """Two of three machines agree on a type. Only a change of the third one adds no finding."""
    machine = '<ascxml name="{0}" version="1.0" initial="a"><ros_topic_{1} name="p" topic="/p" type="std_msgs/{2}" />'
    machine += '<state id="a" /></ascxml>\n'
    inputs = system_file(*(f"node_models node-ascxml {name}.ascxml" for name in "abc"))

    def written(caret: str) -> str:
        nodes = {"a": ("publisher", "Int32"), "b": ("subscriber", "Int32"), "c": ("subscriber", "Int16")}
        files = {name: machine.format(name, *node) for name, node in nodes.items()}
        files[caret] = files[caret].replace("std_msgs", "‸std_msgs")
        return f"-- main.xml --\n{inputs}\n" + "".join(f"-- {n}.ascxml --\n{text}" for n, text in files.items())

    assert [action.title for action in offered(written("c"), QUICK_FIX)] == ["Change to `std_msgs/Int32`"]
    assert not offered(written("a"), QUICK_FIX)


def test_rules_about_unreadable_parts_exist() -> None:
    assert {rule.code for rule in RULES} >= _HIDING


# ------------------------------------------------------------------ whole files

OLDER = """\
-- main.xml --
<convince_mc_tc>
    <mc_parameters><max_time value="1" unit="s" /></mc_parameters>
    <node_models><input type="ros-‸scxml" src="a.scxml" /></node_models>
</convince_mc_tc>
-- a.scxml --
<scxml name="A" version="1.0" model_src="" initial="s">
    <ros_topic_publisher topic="t" type="std_msgs/Int32" />
    <state id="s">
        <transition event="e" target="s">
            <ros_topic_publish topic="t" />
        </transition>
    </state>
</scxml>
"""


def test_the_older_dialect() -> None:
    after = done(
        OLDER.replace("‸", "").replace("<convince", "<‸convince", 1), "Convert the system to the current dialect"
    )
    assert after["main.xml"].startswith("<roaml>")
    assert 'src="a.ascxml"' in after["main.xml"]
    assert after["a.ascxml"].startswith('<ascxml name="A"')
    assert '<field name="data" expr="0" />' in after["a.ascxml"]
    chosen = next(action for action in offered(OLDER) if action.title == "Convert the system to the current dialect")
    assert chosen.resources == ("rename",)
    assert chosen.make().renamed == {path_of("a.scxml"): path_of("a.ascxml")}


LOGS = """\
<ascxml name="A" version="1.0" initial="a">
    <state id="a">
        <transition event="e" target="a">
            <‸log expr="1" />
            <log expr="2" />
            <asign location="n" expr="1" />
        </transition>
    </state>
</ascxml>
"""
WITHOUT_LOGS = "".join(line for line in LOGS.splitlines(keepends=True) if "log" not in line)


@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_all_of_a_rule(line_end: str) -> None:
    after = done(LOGS.replace("\n", line_end), "Fix all `ignored-element` in this file")
    assert after == {"machine.ascxml": WITHOUT_LOGS.replace("\n", line_end)}


def test_all_safe_fixes() -> None:
    """Fixes that guess are not applied."""
    text = LOGS.replace('event="e"', 'event="e" tpye="external"')
    after = done(text, "Apply all safe fixes in this file")
    assert after == {"machine.ascxml": WITHOUT_LOGS.replace('event="e"', 'event="e" tpye="external"')}
    assert not list(offered(WITHOUT_LOGS.replace("<asign", "‸<asign"), FIX_ALL))


def test_only_the_requested_kinds() -> None:
    assert {action.kind for action in offered(LOGS, QUICK_FIX)} == {QUICK_FIX}
    assert {action.kind for action in offered(LOGS, FIX_ALL)} == {FIX_ALL}
    assert offered(LOGS, "refactor") == []


def test_quick_fixes_are_tied_to_their_diagnostics() -> None:
    fixes = offered(LOGS, QUICK_FIX)
    assert [(fix.title, fix.preferred) for fix in fixes] == [
        ("Remove `<log>`", True),
        ("Fix all `ignored-element` in this file", False),
    ]
    assert all(fix.diagnostic is not None and fix.diagnostic.code == "ignored-element" for fix in fixes)


def test_files_that_are_missing() -> None:
    written = (
        "-- main.xml --\n"
        + system_file("node_models node-ascxml ‸nods/a_node.ascxml")
        + """
-- nodes/a_node.ascxml --
<ascxml name="A" version="1.0" initial="a"><state id="a" /></ascxml>
"""
    )
    mended = done(written, "Change to `nodes/a_node.ascxml`")
    assert mended == {"main.xml": system_file("node_models node-ascxml nodes/a_node.ascxml") + "\n"}
    created = done(written, "Create `a_node.ascxml`")
    assert list(created) == ["nods/a_node.ascxml"]
    assert '<ascxml name="ANode"' in created["nods/a_node.ascxml"]


def test_a_port_is_removed_everywhere() -> None:
    written = SYSTEM.replace("‸", "").replace(
        '<bt_declare_port_out key="sum" type="int16" />',
        '<bt_declare_port_out key="sum" type="int16" />\n  <bt_declare_port_in key="‸idle" type="int16" />',
    )
    written = written.replace('<CountUp sum="{sum}" />', '<CountUp sum="{sum}" idle="3" />')
    after = done(written, "Remove the port `idle` here and in the tree")
    assert sorted(after) == ["plugins/count_up.ascxml", "tree.xml"]
    assert "idle" not in "".join(after.values())


CLOCKS = """
-- main.xml --
<roaml>
  <parameters><‸max_time value="60" unit="s" /></parameters>
  <node_models>
    <input type="node-ascxml" src="lidar.ascxml" />
    <input type="node-ascxml" src="drive.ascxml" />
  </node_models>
  <properties><input type="jani" src="p.jani" /></properties>
</roaml>
-- lidar.ascxml --
<ascxml name="Lidar" version="1.0" initial="s">
  <ros_time_rate name="scan" rate_hz="31.25" />
  <state id="s"><ros_rate_callback name="scan" target="s" /></state>
</ascxml>
-- drive.ascxml --
<ascxml name="Drive" version="1.0" initial="s">
  <ros_time_rate name="control" rate_hz="40" />
  <state id="s"><ros_rate_callback name="control" target="s" /></state>
</ascxml>
-- p.jani --
{"properties": []}
"""


def test_a_rate_with_a_larger_clock_step() -> None:
    after = done(CLOCKS, "Change the rate of `scan` to 26.666 Hz")
    assert list(after) == ["lidar.ascxml"]
    snapshot = opened(CLOCKS)[0]
    assert "small-clock-step" in {d.code for d in found(snapshot)}
    changed = snapshot.with_texts({path_of("lidar.ascxml"): after["lidar.ascxml"]})
    assert "small-clock-step" not in {d.code for d in found(changed)}


@pytest.mark.parametrize(
    ("rates", "rate"),
    [
        (("31.25", "40"), "`scan` to 26.666 Hz"),
        (("80", "31.25"), "`control` to 26.666 Hz"),
        (("13", "17"), "`control` to 19.5 Hz"),
    ],
)
def test_the_nearest_rate_with_the_largest_steps(rates: tuple[str, str], rate: str) -> None:
    """Large steps come first: 37.5 ms is not the nearest to 32 ms, but 1.5 times 25 ms."""
    written = CLOCKS.replace('rate_hz="31.25"', f'rate_hz="{rates[0]}"')
    written = written.replace('rate_hz="40"', f'rate_hz="{rates[1]}"')
    assert f"Change the rate of {rate}" in titles(written, "quickfix")


@pytest.mark.parametrize(
    ("rates", "rate"), [(("30", "10"), "20"), (("60", "10"), "50"), (("3", "1"), "2"), (("7", "10"), "5")]
)
def test_the_next_lower_rate_that_stays_in_step(rates: tuple[str, str], rate: str) -> None:
    """The period of 30 Hz is not a whole number of microseconds, so the timer drifts away from one with 10 Hz."""
    written = CLOCKS.replace("‸", "").replace('rate_hz="40"', f'rate_hz="{rates[1]}"')
    written = written.replace('rate_hz="31.25"', f'rate_hz="‸{rates[0]}"')
    after = done(written, f"Change to {rate} Hz")
    assert list(after) == ["lidar.ascxml"]
    assert f'rate_hz="{rate}"' in after["lidar.ascxml"]


def test_half_typed() -> None:
    """Code actions work for every prefix of a system's files, with the caret at its end."""
    for text in (PLUGIN, CLIENT, split_files(OLDER)["main.xml"], split_files(SYSTEM)["tree.xml"], LOGS):
        clean = text.replace("‸", "")
        for end in range(0, len(clean), 5):
            for action in offered(f"-- a.ascxml --\n{clean[:end]}‸"):
                action.make()
