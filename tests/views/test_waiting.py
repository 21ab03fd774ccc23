# SPDX-License-Identifier: Apache-2.0
"""Who waits for whom in a system that is stuck."""

from __future__ import annotations

from pathlib import Path

import pytest

from as2fm_lsp.verification import stuck_report
from roaml import api
from roaml.rules import BY_CODE
from roaml.scxml.events import Role
from roaml.smc.run import Options
from roaml.verification import stuck
from roaml.views.event_words import event_phrase
from roaml.views.waiting import NEEDS_TIME
from stuck_models import CROSSED, hospital, system

HALTED = '<bt_halt target="{0}"><bt_return_halted /></bt_halt>'


def told(folder: Path, files: dict[str, str]) -> str:
    """What is said of the shortest trace that gets stuck, each line with its place; "" if none does."""
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    subject = api.as_target(api.load(str(folder / "main.xml")))
    result = stuck.check_stuck(subject, api.checker(subject.model), Options(), stuck.StuckLevel.WARNING)

    def place_of(origin: object) -> str:
        path, line, _ = subject.place(origin) or ("", 0, 0)  # type: ignore[arg-type]
        return f"{Path(path).name}:{line}"

    lines = stuck_report.as_text(result, place_of).splitlines()[2:]
    # The rule stands on a line of its own here, which would be too long otherwise.
    return "".join(f"{line.strip()}\n" for line in lines).replace(" [", "\n[")


def test_a_plugin_waits_for_a_service_that_waits_for_time(tmp_path: Path) -> None:
    assert (
        told(tmp_path, hospital())
        == """\
the clock waits at 2 s for the tree to take its next tick (tree.xml:3)
the tree waits for Fetch to return a status (tree.xml:5)
Fetch waits in `asked` for the response of the service `/ward/prepare` (fetch.ascxml:12)
Pharmacy waits in `busy` for its timer `dispense`, which ticks when the clock advances (pharmacy.ascxml:8)
help: a tick must end before the next one is due; let Fetch return RUNNING, and the result at a later tick
[answer-needs-time]
"""
    )


def test_no_text_for_a_system_that_continues(tmp_path: Path) -> None:
    assert told(tmp_path, hospital(mended=True)) == ""


MOVE = f"""ready
<ros_action_client name="m" action_name="/arm/move" type="example_interfaces/Fibonacci" />
<state id="ready">
<bt_tick target="sent"><ros_action_send_goal name="m"><field name="order" expr="3" /></ros_action_send_goal></bt_tick>
{HALTED.format("ready")}
</state>
<state id="sent"><ros_action_handle_goal_response name="m" accept="going" reject="refused" /></state>
<state id="refused"><transition target="ready"><bt_return_status status="FAILURE" /></transition></state>
<state id="going">
<ros_action_handle_success_result name="m" target="ready"><bt_return_status status="SUCCESS" />
</ros_action_handle_success_result>
</state>
"""
ARM = """free
<datamodel><data id="g" type="int16" expr="0" /></datamodel>
<ros_action_server name="m" action_name="/arm/move" type="example_interfaces/Fibonacci" />
<ros_time_rate name="step" rate_hz="0.5" />
<state id="free">
<ros_action_handle_goal name="m" target="busy">
<assign location="g" expr="_action.goal_id" /><ros_action_accept_goal name="m" goal_id="g" />
</ros_action_handle_goal>
</state>
<state id="busy">
<ros_rate_callback name="step" target="free">
<ros_action_succeed name="m" goal_id="g"><field name="sequence" expr="[1]" /></ros_action_succeed>
</ros_rate_callback>
</state>
"""


def test_a_plugin_waits_for_the_result_of_an_action(tmp_path: Path) -> None:
    text = told(tmp_path, system({"Move": MOVE, "Arm": ARM}, "<Inverter><Move /></Inverter>"))
    assert (
        text
        == """\
the clock waits at 2 s for the tree to take its next tick (tree.xml:3)
the tree waits for Move to return a status (tree.xml:3)
Move waits in `going` for the result of the action `/arm/move` (Move.ascxml:10)
Arm waits in `busy` for its timer `step`, which ticks when the clock advances (Arm.ascxml:11)
help: a tick must end before the next one is due; let Move return RUNNING, and the result at a later tick
[answer-needs-time]
"""
    )


ASK = f"""ready
<ros_service_client name="s" service_name="/s" type="std_srvs/Empty" />
<state id="ready">
<bt_tick target="asked"><ros_service_send_request name="s" /></bt_tick>{HALTED.format("ready")}</state>
<state id="asked">
<ros_service_handle_response name="s" target="ready"><bt_return_status status="SUCCESS" /></ros_service_handle_response>
</state>
"""
SERVER = """free
<ros_service_server name="s" service_name="/s" type="std_srvs/Empty" />
<ros_topic_subscriber name="go" topic="/go" type="std_msgs/Bool" />
<state id="free"><ros_service_handle_request name="s" target="busy" /></state>
<state id="busy">
<ros_topic_callback name="go" target="free" cond="_msg.data"><ros_service_send_response name="s" /></ros_topic_callback>
</state>
"""
PUBLISHER = """s
<ros_topic_publisher name="go" topic="/go" type="std_msgs/Bool" />
<ros_time_rate name="t" rate_hz="0.5" />
<state id="s">
<ros_rate_callback name="t" target="s">
<ros_topic_publish name="go"><field name="data" expr="true" /></ros_topic_publish>
</ros_rate_callback>
</state>
"""


def test_a_service_waits_for_a_message_of_a_machine_with_a_timer(tmp_path: Path) -> None:
    machines = {"Ask": ASK, "Server": SERVER, "Publisher": PUBLISHER}
    text = told(tmp_path, system(machines, "<Sequence><AlwaysSuccess /><Ask /></Sequence>"))
    assert (
        text
        == """\
the clock waits at 2 s for the tree to take its next tick (tree.xml:3)
the tree waits for Ask to return a status (tree.xml:3)
Ask waits in `asked` for the response of the service `/s` (Ask.ascxml:6)
Server waits in `busy` for a message on the topic `/go` from Publisher (Server.ascxml:6)
Publisher waits in `s` for its timer `t`, which ticks when the clock advances (Publisher.ascxml:5)
help: a tick must end before the next one is due; let Ask return RUNNING, and the result at a later tick
[answer-needs-time]
"""
    )


def test_a_server_that_never_responds(tmp_path: Path) -> None:
    deaf = """free
<ros_service_server name="s" service_name="/s" type="std_srvs/Empty" />
<state id="free"><ros_service_handle_request name="s" target="done" /></state>
<state id="done"><transition cond="false" target="free"><ros_service_send_response name="s" /></transition></state>
"""
    lines = told(tmp_path, system({"Ask": ASK, "Deaf": deaf}, "<Ask />")).splitlines()
    assert lines[2:4] == [
        "Ask waits in `asked` for the response of the service `/s` (Ask.ascxml:6)",
        "Deaf waits for a condition that can never become true (Deaf.ascxml:4)",
    ]
    assert len(lines) == 5


def test_a_server_that_cannot_come_to_respond(tmp_path: Path) -> None:
    deaf = """free
<ros_service_server name="s" service_name="/s" type="std_srvs/Empty" />
<ros_time_rate name="t" rate_hz="0.5" />
<datamodel><data id="n" type="int16" expr="0" /></datamodel>
<state id="free"><ros_service_handle_request name="s" target="done">
<if cond="n &gt; 0"><ros_service_send_response name="s" /></if><assign location="n" expr="n + 0" />
</ros_service_handle_request></state>
<state id="done"><ros_rate_callback name="t" target="done" /></state>
"""
    lines = told(tmp_path, system({"Ask": ASK, "Deaf": deaf}, "<Ask />")).splitlines()
    assert lines[3] == "Deaf stays in `done` and never sends the response of the service `/s` (Deaf.ascxml:8)"


def test_a_halt_that_is_not_answered_in_time(tmp_path: Path) -> None:
    slow = """ready
<ros_service_client name="s" service_name="/s" type="std_srvs/Empty" />
<state id="ready">
<bt_tick target="ready"><bt_return_status status="RUNNING" /></bt_tick>
<bt_halt target="stopping"><ros_service_send_request name="s" /></bt_halt>
</state>
<state id="stopping">
<ros_service_handle_response name="s" target="ready"><bt_return_halted /></ros_service_handle_response>
</state>
"""
    gate = f"""open
<datamodel><data id="n" type="int16" expr="0" /></datamodel>
<state id="open">
<bt_tick target="open" cond="n &lt; 1"><assign location="n" expr="1" /><bt_return_status status="SUCCESS" /></bt_tick>
<bt_tick target="open"><bt_return_status status="FAILURE" /></bt_tick>
{HALTED.format("open")}
</state>
"""
    server = """free
<ros_service_server name="s" service_name="/s" type="std_srvs/Empty" />
<ros_time_rate name="t" rate_hz="0.25" />
<state id="free"><ros_service_handle_request name="s" target="busy" /></state>
<state id="busy"><ros_rate_callback name="t" target="free"><ros_service_send_response name="s" />
</ros_rate_callback></state>
"""
    machines = {"Slow": slow, "Gate": gate, "Server": server}
    lines = told(tmp_path, system(machines, "<ReactiveSequence><Gate /><Slow /></ReactiveSequence>")).splitlines()
    assert lines[1:] == [
        "the tree waits for Slow to halt (tree.xml:3)",
        "Slow waits in `stopping` for the response of the service `/s` (Slow.ascxml:8)",
        "Server waits in `busy` for its timer `t`, which ticks when the clock advances (Server.ascxml:5)",
        "help: a halt must end before the next tick is due; let Slow confirm it at once",
        "[answer-needs-time]",
    ]


def test_two_that_ask_each_other_without_a_clock(tmp_path: Path) -> None:
    text = told(tmp_path, CROSSED)
    assert set(text.splitlines()) == {
        "A waits in `wait` for the response of the service `/b` (A.ascxml:5)",
        "B waits in `wait` for the response of the service `/a` (B.ascxml:5)",
    }


@pytest.mark.parametrize(
    ("event", "words"),
    [
        ("topic_arm__state_msg", "a message on the topic `/arm/state`"),
        ("srv_ward__prepare_response_client_Fetch", "the response of the service `/ward/prepare`"),
        ("srv_x_req_client_Fetch", "a request to the service `/x`"),
        ("srv_x_request", "a request to the service `/x`"),
        ("action_m_goal_req_client_Fetch", "a goal of the action `/m`"),
        ("action_m_result_handle_client_Fetch", "the result of the action `/m`"),
        ("cancel_action_arm__move", "a request to cancel a goal of the action `/arm/move`"),
        ("action_m_thread_start", "the start of a thread of the action `/m`"),
        ("ros_time_rate.second", "its timer `second`"),
        ("ros_time_rate.second__Fetch", "its timer `second`"),
        ("bt_1002_halt", "its halt"),
        ("bt_blackboard_req", "the blackboard"),
        ("my_event", "the event `my_event`"),
    ],
)
def test_events_in_words(event: str, words: str) -> None:
    assert event_phrase(event, {"Fetch"}) == words


def test_the_tick_of_a_timer_in_words() -> None:
    """The role decides, not the name of the automaton."""
    assert event_phrase("ros_time_rate.second", {"Fetch"}, taken=True) == "the tick of its timer `second`"
    assert event_phrase("ros_time_rate.second", {"Fetch"}, Role.TREE_ROOT, taken=True) == "its next tick"


def test_the_rule_that_is_named_exists() -> None:
    assert NEEDS_TIME in BY_CODE


NODES = """\
<Sequence>
<Fallback>
<AlwaysFailure />
<Fetch
/>
</Fallback>
<Inverter><Fetch /></Inverter>
</Sequence>"""


def test_the_tree_waits_at_the_line_of_the_node_that_is_ticked(tmp_path: Path) -> None:
    """Behind inner nodes, and not that of another node of the same name."""
    lines = told(tmp_path, system({"Fetch": ASK, "Server": SERVER, "Publisher": PUBLISHER}, NODES)).splitlines()
    assert lines[:2] == [
        "the clock waits at 2 s for the tree to take its next tick (tree.xml:3)",
        "the tree waits for Fetch (bt_1003) to return a status (tree.xml:6)",
    ]


def test_no_rule_is_named_where_none_finds_it(tmp_path: Path) -> None:
    """The server never responds, whatever the time is."""
    deaf = """free
<ros_service_server name="s" service_name="/s" type="std_srvs/Empty" />
<state id="free"><ros_service_handle_request name="s" target="done" /></state>
<state id="done"><transition cond="false" target="free"><ros_service_send_response name="s" /></transition></state>
"""
    last = told(tmp_path, system({"Ask": ASK, "Deaf": deaf}, "<Ask />")).splitlines()[-1]
    assert last.startswith("help: ")
    assert last.endswith("at a later tick")
