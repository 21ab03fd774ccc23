# SPDX-License-Identifier: Apache-2.0
"""Random systems that consist of independent parts, as strangers would write them: services, actions with several
threads, nested structs, arrays whose index is an element of an array, strings, several timers, and a behavior tree.
Some are written in the older dialect.

Each part announces one number at its end, which follows from its construction. So each property `p_…` has the value 1.
"""

from __future__ import annotations

import json
from random import Random

from corpus.generated import Generated, _and, _equals, _eventually, _property
from corpus.robots import MACHINES, TREES, Make, SystemPart, announced, announcer, machine


def compose(seed: int, only: Make | None = None) -> Generated:
    """A system of two to five parts, or of one part."""
    random = Random(seed)
    chosen = [only] if only else random.sample(PARTS, random.randint(2, 5))
    chosen = [make for make in chosen if make not in ALL_TREES] + [make for make in chosen if make in ALL_TREES][:1]
    older = random.random() < OLDER and chosen[-1] not in ALL_TREES
    parts = [make(random, number) for number, make in enumerate(chosen)]
    files: dict[str, str] = {}
    for part in parts:
        files |= part.machines
    plugins = dict(plugin for part in parts for plugin in part.plugins)
    structs = "".join(part.structs for part in parts)
    tree = "".join(part.tree for part in parts)
    inputs = [("node_models", "node-ascxml", name) for name in files]
    inputs += [("behavior_tree", "bt.cpp-xml", "tree.xml")] if tree else []
    inputs += [("behavior_tree", "bt-plugin-ascxml", name) for name in plugins]
    inputs += [("data_declarations", "xml", "types.xml")] if structs else []
    inputs += [("properties", "jani", "properties.jani")]
    files |= plugins
    files |= dict(file for part in parts for file in part.included)
    files |= {"types.xml": f"<types>{structs}</types>"} if structs else {}
    files |= {"tree.xml": tree} if tree else {}
    names = [f"p_{make.__name__.strip('_')}_{number}" for number, make in enumerate(chosen)]
    properties = [
        _property(
            name,
            _eventually(
                _and(f"topic_end_{number}_msg.valid", _equals(f"topic_end_{number}_msg__ros_fields__data", part.number))
            ),
        )
        for number, (name, part) in enumerate(zip(names, parts, strict=True))
    ]
    files["properties.jani"] = json.dumps({"properties": properties})
    files["main.xml"] = _main(inputs, random)
    if older:
        files = _older(files)
    return Generated(files, dict.fromkeys(names, 1.0))


def _main(inputs: list[tuple[str, str, str]], random: Random) -> str:
    sections: dict[str, str] = {}
    for section, type_, src in inputs:
        prefix = random.choice(("", "./"))
        sections[section] = sections.get(section, "") + f'    <input type="{type_}" src="{prefix}{src}" />\n'
    body = "".join(f"  <{name}>\n{text}  </{name}>\n" for name, text in sections.items())
    time, unit = random.choice(((64, "s"), (64_000, "ms")))
    # Otherwise, the clock stops when the tree has ended.
    ticks = '<bt_tick_if_not_running value="true" />' if "behavior_tree" in sections else ""
    parameters = f'{ticks}<max_time value="{time}" unit="{unit}" /><max_array_size value="12" />'
    return f"<roaml>\n  <parameters>{parameters}</parameters>\n{body}</roaml>\n"


def _older(files: dict[str, str]) -> dict[str, str]:
    """The same system in the older dialect."""
    changes = (
        ("roaml>", "convince_mc_tc>"),
        ("parameters>", "mc_parameters>"),
        ('"node-ascxml"', '"ros-scxml"'),
        (".ascxml", ".scxml"),
        ("<ascxml ", '<scxml xmlns="http://www.w3.org/2005/07/scxml" '),
        ("</ascxml>", "</scxml>"),
    )
    result: dict[str, str] = {}
    for name, text in files.items():
        for old, new in changes:
            text = text.replace(old, new)  # noqa: PLW2901
        result[name.replace(".ascxml", ".scxml")] = text
    return result


def _service(random: Random, number: int) -> SystemPart:
    """A client that adds the numbers of a list by a service, in an order that another array states."""
    values = [random.randint(-9, 9) for _ in range(random.randint(2, 5))]
    order = random.sample(range(len(values)), len(values))
    service = f"/calc_{number}/add"
    client = machine(
        f"Client{number}",
        f"""  <datamodel>
    <data id="values" type="int32[{len(values)}]" expr="{values}" />
    <data id="order" type="uint8[{len(order)}]" expr="{order}" />
    <data id="at" type="int32" expr="0" />
    <data id="sum" type="int64" expr="0" />
  </datamodel>
  <ros_service_client name="add" service_name="{service}" type="example_interfaces/AddTwoInts" />
  <ros_topic_publisher name="end" topic="/end_{number}" type="std_msgs/Int64" />""",
        f"""  <state id="start">
    <onentry>
      <ros_service_send_request name="add">
        <field name="a" expr="sum" /><field name="b" expr="values[order[at]]" />
      </ros_service_send_request>
    </onentry>
    <ros_service_handle_response name="add" target="next">
      <assign location="sum" expr="_res.sum" />
      <assign location="at" expr="at + 1" />
    </ros_service_handle_response>
  </state>
  <state id="next">
    <transition cond="at &lt; {len(values)}" target="start" />
    <transition target="done">{announced("sum")}</transition>
  </state>
  <state id="done" />""",
    )
    server = machine(
        f"Adder{number}",
        f"""  <datamodel>
    <data id="a" type="int64" expr="0" /><data id="b" type="int64" expr="0" />
  </datamodel>
  <ros_service_server name="add" service_name="{service}" type="example_interfaces/AddTwoInts" />""",
        """  <state id="start">
    <ros_service_handle_request name="add" target="answer">
      <assign location="a" expr="_req.a" /><assign location="b" expr="_req.b" />
    </ros_service_handle_request>
  </state>
  <state id="answer">
    <transition target="start">
      <ros_service_send_response name="add"><field name="sum" expr="a + b" /></ros_service_send_response>
    </transition>
  </state>""",
    )
    return SystemPart({f"client_{number}.ascxml": client, f"adder_{number}.ascxml": server}, sum(values))


def _action(random: Random, number: int) -> SystemPart:
    """A client of an action whose server has several threads."""
    order, threads = random.randint(2, 5), random.randint(1, 3)
    sequence = [0, 1]
    while len(sequence) <= order:
        sequence.append(sequence[-1] + sequence[-2])
    declaration = f'action_name="/fibonacci_{number}" type="example_interfaces/Fibonacci" />'
    client = machine(
        f"Asker{number}",
        f"""  <datamodel>
    <data id="result" type="int32[]" expr="[]" /><data id="heard" type="int32" expr="0" />
  </datamodel>
  <ros_action_client name="act" {declaration}
  {announcer(number)}""",
        f"""  <state id="start">
    <onentry>
      <ros_action_send_goal name="act"><field name="order" expr="{order}" /></ros_action_send_goal>
    </onentry>
    <ros_action_handle_goal_response name="act" accept="wait" reject="start" />
  </state>
  <state id="wait">
    <ros_action_handle_feedback name="act" target="wait">
      <assign location="heard" expr="_feedback.sequence.length" />
    </ros_action_handle_feedback>
    <ros_action_handle_success_result name="act" target="done">
      <assign location="result" expr="_wrapped_result.result.sequence" />
      {announced(f"result[{order}]")}
    </ros_action_handle_success_result>
  </state>
  <state id="done" />""",
    )
    busy = ", ".join(["true"] * threads)
    choice = "".join(
        f'<{"if" if thread == 0 else "elseif"} cond="!busy[{thread}]"{">" if thread == 0 else " />"}'
        f'<assign location="busy[{thread}]" expr="true" /><assign location="thread" expr="{thread}" />'
        for thread in range(threads)
    )
    server = machine(
        f"Actor{number}",
        f"""  <ros_action_server name="act" {declaration}
  <ros_action_thread name="act" n_threads="{threads}" initial="idle">
    <datamodel>
      <data id="goal_id" type="int32" expr="-1" /><data id="order" type="int32" expr="0" />
      <data id="sequence" type="int32[]" expr="[]" />
    </datamodel>
    <state id="idle">
      <onentry>
        <assign location="sequence.length" expr="0" />
        <ros_action_thread_free name="act" />
      </onentry>
      <ros_action_handle_thread_start name="act" target="execute">
        <assign location="goal_id" expr="_action.goal_id" /><assign location="order" expr="_goal.order" />
      </ros_action_handle_thread_start>
    </state>
    <state id="execute">
      <onentry>
        <if cond="sequence.length &lt; 2"><assign location="sequence[sequence.length]" expr="sequence.length" />
        <else />
          <assign location="sequence[sequence.length]"
                  expr="sequence[sequence.length - 1] + sequence[sequence.length - 2]" />
        </if>
      </onentry>
      <transition cond="sequence.length == order + 1" target="idle">
        <ros_action_succeed name="act" goal_id="goal_id">
          <field name="sequence" expr="sequence" />
        </ros_action_succeed>
      </transition>
      <transition target="execute">
        <ros_action_feedback name="act" goal_id="goal_id">
          <field name="sequence" expr="sequence" />
        </ros_action_feedback>
      </transition>
    </state>
  </ros_action_thread>
  <datamodel>
    <data id="goal_id" type="int32" expr="0" /><data id="order" type="int32" expr="0" />
    <data id="busy" type="bool[{threads}]" expr="[{busy}]" /><data id="thread" type="int32" expr="-1" />
  </datamodel>""",
        f"""  <state id="start">
    <ros_action_handle_goal name="act" target="choose">
      <assign location="goal_id" expr="_action.goal_id" /><assign location="order" expr="_goal.order" />
    </ros_action_handle_goal>
    <ros_action_handle_thread_free name="act" target="start">
      <assign location="thread" expr="_event.data.thread_id" />
      <assign location="busy[thread]" expr="false" />
    </ros_action_handle_thread_free>
  </state>
  <state id="choose">
    <onentry><assign location="thread" expr="-1" />{choice}</if></onentry>
    <transition cond="thread &gt;= 0" target="start">
      <ros_action_accept_goal name="act" goal_id="goal_id" />
      <ros_action_start_thread name="act" thread_id="thread" goal_id="goal_id">
        <field name="order" expr="order" />
      </ros_action_start_thread>
    </transition>
    <transition target="start"><ros_action_reject_goal name="act" goal_id="goal_id" /></transition>
  </state>""",
    )
    return SystemPart({f"asker_{number}.ascxml": client, f"actor_{number}.ascxml": server}, sequence[order])


def _structs(random: Random, number: int) -> SystemPart:
    """Nested structs with arrays and strings, sent by a plain event and compared in one long condition."""
    x, frame = random.randint(1, 50), random.choice(("map", "odom", "base_link", "m"))
    point, path = f"Point{number}", f"Path{number}"
    declared = f"""<struct id="{path}">
      <member id="points" type="{point}[3]" /><member id="name" type="string" />
    </struct>
    <struct id="{point}"><member id="x" type="int32" /><member id="frame" type="string" /></struct>"""
    points = ", ".join(f"{{'x': {x + n}, 'frame': '{frame}'}}" for n in range(3))
    sender = machine(
        f"Planner{number}",
        f"""  <datamodel>
    <data id="path" type="{path}" expr="{{'points': [{points}], 'name': 'home'}}" />
  </datamodel>
  <ros_time_rate name="wait" rate_hz="2" />""",
        f"""  <state id="start">
    <ros_rate_callback name="wait" target="done">
      <assign location="path.points[1].x" expr="path.points[0].x * 2" />
      <send event="planned_{number}"><param name="path" expr="path" /></send>
    </ros_rate_callback>
  </state>
  <state id="done" />""",
    )
    good = f"got.points[0].x == {x} &amp;&amp; got.points[1].frame == '{frame}' &amp;&amp; got.name != 'away'"
    receiver = machine(
        f"Driver{number}",
        f"""  <datamodel>
    <data id="got" type="{path}" expr="{{'points': [{points}], 'name': 'away'}}" />
  </datamodel>
  {announcer(number)}""",
        f"""  <state id="start">
    <transition event="planned_{number}" target="look"><assign location="got" expr="_event.data.path" /></transition>
  </state>
  <state id="look">
    <transition cond="{good}" target="done">{announced("got.points[1].x")}</transition>
    <transition cond="!({good})" target="done" />
  </state>
  <state id="done" />""",
    )
    return SystemPart({f"planner_{number}.ascxml": sender, f"driver_{number}.ascxml": receiver}, 2 * x, declared)


def _words(random: Random, number: int) -> SystemPart:
    """A text that is compared with many constants, in one state and by `<elseif>`."""
    words = random.sample(("north", "n", "south", "east", "west", "stop", "go", "it's", "a&b"), random.randint(4, 7))
    sent = random.choice(words)
    chain = "".join(
        f"<{'if' if n == 0 else 'elseif'} cond=\"word == '{_text(word)}'\"{'>' if n == 0 else ' />'}"
        f'<assign location="code" expr="{n + 1}" />'
        for n, word in enumerate(words)
    )
    either = " || ".join(f"_msg.data == '{_text(word)}'" for word in words)
    speaker = machine(
        f"Speaker{number}",
        f"""  <ros_topic_publisher name="say" topic="/say_{number}" type="std_msgs/String" />
  <ros_time_rate name="wait" rate_hz="1" />""",
        f"""  <state id="start">
    <ros_rate_callback name="wait" target="done">
      <ros_topic_publish name="say"><field name="data" expr="'{_text(sent)}'" /></ros_topic_publish>
    </ros_rate_callback>
  </state>
  <state id="done" />""",
    )
    listener = machine(
        f"Listener{number}",
        f"""  <datamodel>
    <data id="word" type="string" expr="''" /><data id="code" type="int32" expr="0" />
  </datamodel>
  <ros_topic_subscriber name="say" topic="/say_{number}" type="std_msgs/String" />
  {announcer(number)}""",
        f"""  <state id="start">
    <ros_topic_callback name="say" cond="{either}" target="done">
      <assign location="word" expr="_msg.data" />
      {chain}<else /><assign location="code" expr="-1" /></if>
      {announced("code")}
    </ros_topic_callback>
  </state>
  <state id="done" />""",
    )
    files = {f"speaker_{number}.ascxml": speaker, f"listener_{number}.ascxml": listener}
    return SystemPart(files, words.index(sent) + 1)


def _text(word: str) -> str:
    return word.replace("'", "\\'").replace("&", "&amp;")


def _timers(random: Random, number: int) -> SystemPart:
    """A machine with several timers, one of which stops it."""
    fast, ticks = random.choice((2, 4, 5, 10)), random.randint(2, 9)
    clock = machine(
        f"Clock{number}",
        f"""  <datamodel>
    <data id="fast" type="uint8" expr="0" /><data id="slow" type="float64" expr="0.0" />
    <data id="stopped" type="bool" expr="false" />
  </datamodel>
  <ros_time_rate name="fast" rate_hz="{fast}" />
  <ros_time_rate name="slow" rate_hz="0.5" />
  {announcer(number)}""",
        f"""  <state id="start">
    <onentry><assign location="slow" expr="Math.pow(2.0, 3.0) / 2" /></onentry>
    <onexit><assign location="stopped" expr="fast &gt;= {ticks}" /></onexit>
    <ros_rate_callback name="fast" cond="fast + 1 &lt; {ticks}" target="start">
      <assign location="fast" expr="fast + 1" />
    </ros_rate_callback>
    <ros_rate_callback name="fast" target="done"><assign location="fast" expr="fast + 1" /></ros_rate_callback>
    <ros_rate_callback name="slow" target="start"><assign location="slow" expr="slow * 0.5" /></ros_rate_callback>
  </state>
  <state id="done">
    <onentry>{announced("fast")}</onentry>
    <ros_rate_callback name="fast" target="done" />
    <ros_rate_callback name="slow" target="done" />
  </state>""",
    )
    return SystemPart({f"clock_{number}.ascxml": clock}, ticks)


def _tree(random: Random, number: int) -> SystemPart:
    """A tree whose last leaf, which succeeds after some ticks, announces how often it was ticked."""
    needed = random.randint(1, 4)
    node = f'<Action ID="Work{number}" name="work" needed="{needed}" />'
    for _ in range(random.randint(1, 4)):
        node = random.choice(WRAPPERS).format(node)
    leaf = machine(
        f"Work{number}",
        f"""  <bt_declare_port_in key="needed" type="int8" />
  <datamodel>
    <data id="ticks" type="int32" expr="0" />
    <data id="needed" type="int8"><expr><bt_get_input key="needed" /></expr></data>
  </datamodel>
  {announcer(number)}""",
        f"""  <state id="start">
    <bt_tick target="start">
      <assign location="ticks" expr="ticks + 1" />
      <if cond="ticks &lt; needed"><bt_return_status status="RUNNING" />
      <else />{announced("ticks")}<bt_return_status status="SUCCESS" />
      </if>
    </bt_tick>
    <bt_halt target="start"><bt_return_halted /></bt_halt>
  </state>""",
    )
    tree = f'<root BTCPP_format="4"><BehaviorTree ID="Main">{node}</BehaviorTree></root>'
    return SystemPart({}, needed, tree=tree, plugins=((f"work_{number}.ascxml", leaf),))


WRAPPERS = (
    "<Sequence><AlwaysSuccess />{}</Sequence>",
    "<Fallback><AlwaysFailure />{}</Fallback>",
    "<Inverter><Inverter>{}</Inverter></Inverter>",
    "<SequenceWithMemory>{}<AlwaysSuccess /></SequenceWithMemory>",
    "<ReactiveSequence><AlwaysSuccess />{}</ReactiveSequence>",
    "<ReactiveFallback><AlwaysFailure />{}</ReactiveFallback>",
    '<RetryUntilSuccessful num_attempts="2">{}</RetryUntilSuccessful>',
    '<Repeat num_cycles="1">{}</Repeat>',
    '<Parallel success_count="2" failure_count="1"><AlwaysSuccess />{}</Parallel>',
    "<ForceSuccess>{}</ForceSuccess>",
    '<Timeout msec="20000">{}</Timeout>',
    "<IfThenElse><AlwaysSuccess />{}<AlwaysFailure /></IfThenElse>",
    "<WhileDoElse><AlwaysSuccess />{}<AlwaysFailure /></WhileDoElse>",
)

ALL_TREES = (_tree, *TREES)
PARTS: tuple[Make, ...] = (_service, _action, _structs, _words, _timers, *MACHINES, *ALL_TREES)
OLDER = 0.2
"""The share of the systems without a tree that are written in the older dialect."""
