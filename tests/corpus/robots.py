# SPDX-License-Identifier: Apache-2.0
"""More parts of random systems: services that call services, actions that are canceled, messages with nested fields,
matrices, lists of texts, timers whose periods do not fit each other, and trees with subtrees, remapped ports,
thresholds, recoveries of Nav2, names with white space, included files, and the format of version 3."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import NamedTuple


class SystemPart(NamedTuple):
    """A part of a system.

    Attributes:
        machines: file name -> the machine.
        number: the number that the part publishes on its topic.
        structs: the struct declarations in XML.
        tree, plugins: the behavior tree, and the machines of its leaves.
        included: the files that the tree includes.
    """

    machines: dict[str, str]
    number: int
    structs: str = ""
    tree: str = ""
    plugins: tuple[tuple[str, str], ...] = ()
    included: tuple[tuple[str, str], ...] = ()


def machine(name: str, declared: str, states: str, initial: str = "start") -> str:
    return f"""<ascxml name="{name}" version="1.0" initial="{initial}">
{declared}
{states}
</ascxml>
"""


def announced(expr: str) -> str:
    """Publishes the number of a part."""
    return f'<ros_topic_publish name="end"><field name="data" expr="{expr}" /></ros_topic_publish>'


def announcer(number: int) -> str:
    """Declares the topic of a part."""
    return f'<ros_topic_publisher name="end" topic="/end_{number}" type="std_msgs/Int32" />'


# -------------------------------------------------------------------- machines


def _chain(random: Random, number: int) -> SystemPart:
    """A service whose server asks another service before it responds, over three nodes."""
    first, second, factors = random.randint(1, 9), random.randint(1, 9), [random.randint(2, 4) for _ in range(2)]

    def service(kind: str, place: int) -> str:
        where = f'service_name="/chain_{number}/at_{place}" type="example_interfaces/AddTwoInts" />'
        return f'<ros_service_{kind} name="at_{place}" {where}'

    client = machine(
        f"Head{number}",
        f"  {service('client', 0)}\n  {announcer(number)}",
        f"""  <state id="start">
    <transition target="wait">
      <ros_service_send_request name="at_0">
        <field name="a" expr="{first}" /><field name="b" expr="{second}" />
      </ros_service_send_request>
    </transition>
  </state>
  <state id="wait">
    <ros_service_handle_response name="at_0" target="done">{announced("_res.sum")}</ros_service_handle_response>
  </state>
  <state id="done" />""",
    )
    files = {f"head_{number}.ascxml": client}
    data = '<data id="a" type="int64" expr="0" /><data id="b" type="int64" expr="0" />'
    for place, factor in enumerate(factors):
        files[f"relay_{number}_{place}.ascxml"] = machine(
            f"Relay{number}_{place}",
            f"  <datamodel>{data}</datamodel>\n  {service('server', place)}\n  {service('client', place + 1)}",
            f"""  <state id="start">
    <ros_service_handle_request name="at_{place}" target="ask">
      <assign location="a" expr="_req.a" /><assign location="b" expr="_req.b" />
    </ros_service_handle_request>
  </state>
  <state id="ask">
    <onentry>
      <ros_service_send_request name="at_{place + 1}">
        <field name="b" expr="b" /><field name="a" expr="a" />
      </ros_service_send_request>
    </onentry>
    <ros_service_handle_response name="at_{place + 1}" target="start">
      <ros_service_send_response name="at_{place}">
        <field name="sum" expr="_res.sum * {factor}" />
      </ros_service_send_response>
    </ros_service_handle_response>
  </state>""",
        )
    last = len(factors)
    files[f"tail_{number}.ascxml"] = machine(
        f"Tail{number}",
        f"  {service('server', last)}",
        f"""  <state id="start">
    <ros_service_handle_request name="at_{last}" target="start">
      <ros_service_send_response name="at_{last}"><field name="sum" expr="_req.a + _req.b" />
      </ros_service_send_response>
    </ros_service_handle_request>
  </state>""",
    )
    return SystemPart(files, (first + second) * factors[0] * factors[1])


def _canceled(random: Random, number: int) -> SystemPart:
    """A goal that is canceled after some feedback, by a server that would never end it."""
    patience = random.randint(1, 3)
    declaration = f'action_name="/endless_{number}" type="example_interfaces/Fibonacci" />'
    client = machine(
        f"Impatient{number}",
        f"""  <datamodel><data id="heard" type="int32" expr="0" /></datamodel>
  <ros_action_client name="act" {declaration}
  {announcer(number)}""",
        f"""  <state id="start">
    <onentry><ros_action_send_goal name="act"><field name="order" expr="3" /></ros_action_send_goal></onentry>
    <ros_action_handle_goal_response name="act" accept="wait" reject="refused" />
  </state>
  <state id="refused" />
  <state id="wait">
    <ros_action_handle_feedback name="act" cond="heard + 1 &lt; {patience}" target="wait">
      <assign location="heard" expr="heard + 1" />
    </ros_action_handle_feedback>
    <ros_action_handle_feedback name="act" cond="heard + 1 &gt;= {patience}" target="canceling">
      <assign location="heard" expr="heard + 1" />
      <ros_action_cancel_goal name="act" />
    </ros_action_handle_feedback>
    <ros_action_handle_success_result name="act" target="refused" />
    <ros_action_handle_canceled_result name="act" target="refused" />
    <ros_action_handle_aborted_result name="act" target="refused" />
  </state>
  <state id="canceling">
    <ros_action_handle_feedback name="act" target="canceling" />
    <ros_action_handle_success_result name="act" target="refused" />
    <ros_action_handle_aborted_result name="act" target="refused" />
    <ros_action_handle_canceled_result name="act" target="done">{announced("heard + 5")}
    </ros_action_handle_canceled_result>
  </state>
  <state id="done" />""",
    )
    server = machine(
        f"Endless{number}",
        f"""  <datamodel>
    <data id="goal_id" type="int32" expr="0" /><data id="sequence" type="int32[]" expr="[1, 2]" />
  </datamodel>
  <ros_action_server name="act" {declaration}
  <ros_time_rate name="work" rate_hz="2" />""",
        """  <state id="start">
    <ros_action_handle_goal name="act" target="busy">
      <assign location="goal_id" expr="_action.goal_id" />
      <ros_action_accept_goal name="act" goal_id="goal_id" />
    </ros_action_handle_goal>
    <ros_rate_callback name="work" target="start" />
  </state>
  <state id="busy">
    <ros_rate_callback name="work" target="busy">
      <ros_action_feedback name="act" goal_id="goal_id"><field name="sequence" expr="sequence" /></ros_action_feedback>
    </ros_rate_callback>
    <ros_action_handle_cancel_goal name="act" target="start">
      <ros_action_canceled name="act" goal_id="goal_id" />
    </ros_action_handle_cancel_goal>
  </state>""",
    )
    return SystemPart({f"impatient_{number}.ascxml": client, f"endless_{number}.ascxml": server}, patience + 5)


def _pose(random: Random, number: int) -> SystemPart:
    """A message with nested fields and a text, compared in one long condition."""
    x, frame = random.randint(1, 30), random.choice(("map", "odom", "base link", "m"))
    declared = f'name="pose" topic="/pose_{number}" type="geometry_msgs/PoseStamped" />'
    zeros = "".join(f'<field name="{name}" expr="0" />' for name in ("header.stamp.sec", "header.stamp.nanosec"))
    zeros += "".join(f'<field name="pose.position.{name}" expr="0.0" />' for name in "yz")
    zeros += "".join(f'<field name="pose.orientation.{name}" expr="0.0" />' for name in "xyz")
    sender = machine(
        f"Locator{number}",
        f'  <ros_topic_publisher {declared}\n  <ros_time_rate name="wait" rate_hz="4" />',
        f"""  <state id="start">
    <ros_rate_callback name="wait" target="done">
      <ros_topic_publish name="pose">
        <field name="header.frame_id" expr="'{frame}'" />
        <field name="pose.position.x" expr="{x}.0" />
        <field name="pose.orientation.w" expr="0.5" />{zeros}
      </ros_topic_publish>
    </ros_rate_callback>
  </state>
  <state id="done" />""",
    )
    good = (
        f"_msg.header.frame_id == '{frame}' &amp;&amp; _msg.pose.position.x &gt; {x - 1} &amp;&amp; "
        "_msg.pose.orientation.w * 2 == 1 &amp;&amp; _msg.pose.position.y == 0"
    )
    receiver = machine(
        f"Planner{number}",
        f"""  <datamodel><data id="frame" type="string" expr="'none'" /></datamodel>
  <ros_topic_subscriber {declared}
  {announcer(number)}""",
        f"""  <state id="start">
    <ros_topic_callback name="pose" cond="{good}" target="look">
      <assign location="frame" expr="_msg.header.frame_id" />
    </ros_topic_callback>
    <ros_topic_callback name="pose" cond="!({good})" target="lost" />
  </state>
  <state id="look">
    <transition cond="frame != 'none'" target="done">{announced(str(x))}</transition>
    <transition cond="frame == 'none'" target="lost" />
  </state>
  <state id="lost" />
  <state id="done" />""",
    )
    return SystemPart({f"locator_{number}.ascxml": sender, f"pose_{number}.ascxml": receiver}, x)


def _matrix(random: Random, number: int) -> SystemPart:
    """A walk through a matrix, whose guards read neighbours by computed indices."""
    rows, columns = random.randint(2, 3), random.randint(2, 4)
    matrix = [[random.randint(0, 5) for _ in range(columns)] for _ in range(rows)]
    threshold = random.randint(1, 4)
    expected = sum(value for row in matrix for value in row if value > threshold)
    cell = f"grid[at / {columns}][at % {columns}]".replace(f"at / {columns}", f"Math.floor(at / {columns})")
    walker = machine(
        f"Walker{number}",
        f"""  <datamodel>
    <data id="grid" type="int32[{rows}][{columns}]" expr="{matrix}" />
    <data id="at" type="int32" expr="0" /><data id="sum" type="int32" expr="0" />
  </datamodel>
  {announcer(number)}""",
        f"""  <state id="start">
    <transition cond="at &lt; {rows * columns} &amp;&amp; {cell} &gt; {threshold}" target="start">
      <assign location="sum" expr="sum + {cell}" /><assign location="{cell}" expr="0" />
      <assign location="at" expr="at + 1" />
    </transition>
    <transition cond="at &lt; {rows * columns}" target="start"><assign location="at" expr="at + 1" /></transition>
    <transition target="done">{announced("sum")}</transition>
  </state>
  <state id="done" />""",
    )
    return SystemPart({f"walker_{number}.ascxml": walker}, expected)


def _texts(random: Random, number: int) -> SystemPart:
    """A list of texts, sent by a plain event, in which a text is searched."""
    words = random.sample(("red", "green", "blue", "re d", "Red", "r"), random.randint(3, 5))
    wanted = random.choice(words)
    listed = ", ".join(f"'{word}'" for word in words)
    sender = machine(
        f"Shelf{number}",
        f"""  <datamodel><data id="words" type="string[{len(words)}]" expr="[{listed}]" /></datamodel>
  <ros_time_rate name="wait" rate_hz="1" />""",
        f"""  <state id="start">
    <ros_rate_callback name="wait" target="done">
      <send event="listed_{number}"><param name="words" expr="words" /></send>
    </ros_rate_callback>
  </state>
  <state id="done" />""",
    )
    receiver = machine(
        f"Searcher{number}",
        f"""  <datamodel>
    <data id="words" type="string[{len(words)}]" expr="[{", ".join(["''"] * len(words))}]" />
    <data id="at" type="int32" expr="0" />
  </datamodel>
  {announcer(number)}""",
        f"""  <state id="start">
    <transition event="listed_{number}" target="search">
      <assign location="words" expr="_event.data.words" />
    </transition>
  </state>
  <state id="search">
    <transition cond="words[at] != '{wanted}'" target="search"><assign location="at" expr="at + 1" /></transition>
    <transition cond="words[at] == '{wanted}'" target="done">{announced("at + 1")}</transition>
  </state>
  <state id="done" />""",
    )
    files = {f"shelf_{number}.ascxml": sender, f"searcher_{number}.ascxml": receiver}
    return SystemPart(files, words.index(wanted) + 1)


def _drifting(random: Random, number: int) -> SystemPart:
    """Timers whose periods do not fit each other, of two machines."""
    rates, needed = random.sample((2.5, 5, 0.4, 1.25, 8), 3), random.randint(1, 4)
    ticks = "".join(
        f'<ros_rate_callback name="t{i}" target="start"><assign location="phase" expr="(phase + {i}) % 3" />'
        "</ros_rate_callback>"
        for i in (1, 2)
    )
    timers = "".join(f'<ros_time_rate name="t{i}" rate_hz="{rate}" />' for i, rate in enumerate(rates))
    clock = machine(
        f"Drift{number}",
        f"""  <datamodel><data id="count" type="int32" expr="0" /><data id="phase" type="uint8" expr="0" /></datamodel>
  {timers}
  {announcer(number)}""",
        f"""  <state id="start">
    <ros_rate_callback name="t0" cond="count + 1 &lt; {needed}" target="start">
      <assign location="count" expr="count + 1" />
    </ros_rate_callback>
    <ros_rate_callback name="t0" cond="count + 1 == {needed}" target="done">
      <assign location="count" expr="count + 1" />{announced("count")}
    </ros_rate_callback>
    {ticks}
  </state>
  <state id="done">
    {"".join(f'<ros_rate_callback name="t{i}" target="done" />' for i in range(3))}
  </state>""",
    )
    return SystemPart({f"drift_{number}.ascxml": clock}, needed)


# ----------------------------------------------------------------------- trees


def _leaf(name: str, number: int, body: str, ports: str = "", data: str = "", *, announces: bool = False) -> str:
    """A leaf that does `body` when it is ticked."""
    declared = f"  {ports}\n  <datamodel>{data}</datamodel>\n" if data else f"  {ports}\n"
    return machine(
        name,
        declared + (announcer(number) if announces else ""),
        f"""  <state id="start">
    <bt_tick target="start">{body}</bt_tick>
    <bt_halt target="start"><bt_return_halted /></bt_halt>
  </state>""",
    )


SUCCESS = '<bt_return_status status="SUCCESS" />'


def _subtrees(random: Random, number: int) -> SystemPart:
    """A subtree in another file, used twice with remapped ports; the second use reads what the first one writes."""
    amount, more = random.randint(1, 9), random.randint(1, 9)
    read = "".join(
        f'<assign location="{key}"><expr><bt_get_input key="{key}" /></expr></assign>' for key in ("left", "right")
    )
    add = _leaf(
        f"Add{number}",
        number,
        read + '<bt_set_output key="sum" expr="left + right" />' + SUCCESS,
        '<bt_declare_port_in key="left" type="int32" /><bt_declare_port_in key="right" type="int32" />'
        '<bt_declare_port_out key="sum" type="int32" />',
        '<data id="left" type="int32" expr="0" /><data id="right" type="int32" expr="0" />',
    )
    tell = _leaf(
        f"Tell{number}",
        number,
        '<assign location="value"><expr><bt_get_input key="value" /></expr></assign>' + announced("value") + SUCCESS,
        '<bt_declare_port_in key="value" type="int32" />',
        '<data id="value" type="int32" expr="0" />',
        announces=True,
    )
    inner = f"""<root BTCPP_format="4"><BehaviorTree ID="Inner{number}"><Sequence>
    <Action ID="Add{number}" name="add two" left="{{amount}}" right="{more}" sum="{{result}}" />
</Sequence></BehaviorTree></root>"""
    tree = f"""<root BTCPP_format="4" main_tree_to_execute="Main">
  <include path="trees/inner.xml" />
  <BehaviorTree ID="Main"><Sequence>
    <SetBlackboard value="{amount}" output_key="start" />
    <SubTree ID="Inner{number}" amount="{{start}}" result="{{middle}}" />
    <SubTree ID="Inner{number}" name="again" amount="{{middle}}" result="{{last}}" />
    <Action ID="Tell{number}" name="tell it" value="{{last}}" />
  </Sequence></BehaviorTree>
</root>"""
    plugins = ((f"add_{number}.ascxml", add), (f"tell_{number}.ascxml", tell))
    return SystemPart({}, amount + 2 * more, tree=tree, plugins=plugins, included=(("trees/inner.xml", inner),))


def _parallel(random: Random, number: int) -> SystemPart:
    """Leaves that need a different number of ticks, below a `Parallel` that needs some of them."""
    needed = [random.randint(1, 4) for _ in range(random.randint(2, 4))]
    threshold = random.randint(1, len(needed))
    leaves = "".join(
        f'<Action ID="Busy{number}" name="busy with {i}" needed="{ticks}" />' for i, ticks in enumerate(needed)
    )
    is_old = random.random() < 0.5
    head = '<root main_tree_to_execute="Main">' if is_old else '<root BTCPP_format="4">'
    words = ("success_threshold", "failure_threshold") if is_old else ("success_count", "failure_count")
    sequence = "SequenceStar" if is_old else "SequenceWithMemory"
    tree = f"""{head}<BehaviorTree ID="Main"><{sequence}>
    <Parallel {words[0]}="{threshold}" {words[1]}="{len(needed)}">{leaves}</Parallel>
    <Action ID="Finish{number}" name="finish" />
</{sequence}></BehaviorTree>
<TreeNodesModel>
  <Action ID="Busy{number}"><input_port name="needed" type="int" default="1">number of ticks</input_port></Action>
  <Action ID="Finish{number}" />
</TreeNodesModel></root>"""
    busy = machine(
        f"Busy{number}",
        """  <bt_declare_port_in key="needed" type="int8" />
  <datamodel>
    <data id="ticks" type="int32" expr="0" />
    <data id="needed" type="int8"><expr><bt_get_input key="needed" /></expr></data>
  </datamodel>""",
        """  <state id="start">
    <bt_tick target="start">
      <assign location="ticks" expr="ticks + 1" />
      <if cond="ticks &lt; needed"><bt_return_status status="RUNNING" />
      <else /><assign location="ticks" expr="0" /><bt_return_status status="SUCCESS" />
      </if>
    </bt_tick>
    <bt_halt target="start"><assign location="ticks" expr="0" /><bt_return_halted /></bt_halt>
  </state>""",
    )
    finish = _leaf(f"Finish{number}", number, announced(str(threshold)) + SUCCESS, announces=True)
    plugins = ((f"busy_{number}.ascxml", busy), (f"finish_{number}.ascxml", finish))
    return SystemPart({}, threshold, tree=tree, plugins=plugins)


def _recovery(random: Random, number: int) -> SystemPart:
    """A tree like those of Nav2: a route that fails some times, recoveries in turn, and another attempt."""
    failures = random.randint(0, 2)
    plan = _leaf(
        f"Plan{number}",
        number,
        f"""<assign location="tried" expr="tried + 1" />
      <if cond="tried &lt;= {failures}"><bt_return_status status="FAILURE" />
      <else />{announced("tried")}<bt_return_status status="SUCCESS" /></if>""",
        "",
        '<data id="tried" type="int32" expr="0" />',
        announces=True,
    )
    recover = _leaf(f"Recover{number}", number, SUCCESS)
    tree = f"""<root BTCPP_format="4" main_tree_to_execute="NavigateWithRecovery">
  <BehaviorTree ID="NavigateWithRecovery">
    <RecoveryNode number_of_retries="3" name="NavigateRecovery">
      <PipelineSequence name="Navigate">
        <Action ID="Plan{number}" name="ComputeRoute" />
        <AlwaysSuccess name="FollowRoute" />
      </PipelineSequence>
      <ReactiveFallback name="RecoveryFallback">
        <Inverter><AlwaysSuccess name="NoGoalUpdated" /></Inverter>
        <RoundRobin name="RecoveryActions">
          <Action ID="Recover{number}" name="Clear" />
          <Action ID="Recover{number}" name="Spin" />
        </RoundRobin>
      </ReactiveFallback>
    </RecoveryNode>
  </BehaviorTree>
</root>"""
    plugins = ((f"plan_{number}.ascxml", plan), (f"recover_{number}.ascxml", recover))
    return SystemPart({}, failures + 1, tree=tree, plugins=plugins)


Make = Callable[[Random, int], SystemPart]
MACHINES: tuple[Make, ...] = (_chain, _canceled, _pose, _matrix, _texts, _drifting)
TREES: tuple[Make, ...] = (_subtrees, _parallel, _recovery)
