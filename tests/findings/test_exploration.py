# SPDX-License-Identifier: Apache-2.0
"""How many states a check explores, and what it says about the systems whose states it does not explore."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fixture import write_files
from roaml import api
from roaml.comparison import read_comparison
from roaml.diagnostics import Diagnostic, Severity
from roaml.explicit import space
from roaml.project import exploration, explored_findings
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from rule_files import examples

CODE = "never-ticked"
INSTANT = ' reaction_time="instant"'


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The number of states of each search that has ended."""
    numbers: list[int] = []
    explore = space.explore

    def counted(*arguments: Any, **options: Any) -> Any:
        try:
            found = explore(*arguments, **options)
        except space.LimitError as error:
            numbers.append(error.states)
            raise
        numbers.append(found.states)
        return found

    monkeypatch.setattr(space, "explore", counted)
    return numbers


def check(folder: Path, heading: str) -> tuple[api.CheckResult, list[str]]:
    """The result of a check of an example of the rule without a reaction time, and the messages of the rule."""
    write_files(folder, examples(CODE, heading)[0].text.replace(INSTANT, ""))
    result = api.check([str(folder / "main.xml")])
    return result, [d.message for d in result.diagnostics if d.code == CODE]


def test_a_right_system_is_explored_once_with_machines_that_react_at_once(tmp_path: Path, searches: list[int]) -> None:
    assert check(tmp_path, "Good")[1] == []
    assert len(searches) == 1


def test_a_finding_is_confirmed_for_all_reactions(tmp_path: Path, searches: list[int]) -> None:
    [message] = check(tmp_path, "Bad")[1]
    assert "react at once" not in message
    instant, all_reactions = searches
    assert instant < all_reactions


def test_a_finding_that_is_not_confirmed_says_what_it_assumes(
    tmp_path: Path, searches: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    check(tmp_path, "Bad")
    monkeypatch.setattr(exploration, "MAX_STATES", searches[0])
    [message] = check(tmp_path, "Bad")[1]
    assert "if all machines react at once" in message


@pytest.mark.parametrize(("heading", "number"), [("Bad", 1), ("Good", 0)])
def test_a_system_with_too_many_states_is_simulated(
    tmp_path: Path, searches: list[int], monkeypatch: pytest.MonkeyPatch, heading: str, number: int
) -> None:
    monkeypatch.setattr(exploration, "MAX_STATES", 1)
    result, messages = check(tmp_path, heading)
    assert len(messages) == number
    assert all("none of 25 simulated runs" in message for message in messages)
    assert len(searches) == 1
    assert not result.snapshot.checker.has_too_many_states(str(tmp_path / "main.xml"))


def test_a_system_that_is_too_large_is_known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    main = str(tmp_path / "main.xml")
    assert not check(tmp_path, "Bad")[0].snapshot.checker.has_too_many_states(main)
    monkeypatch.setattr(explored_findings, "MAX_PARTS", 1)
    result, messages = check(tmp_path, "Bad")
    assert messages == []
    assert result.snapshot.checker.has_too_many_states(main)


@pytest.mark.parametrize(("is_failing", "severity"), [(True, Severity.WARNING), (False, Severity.INFORMATION)])
def test_a_condition_that_is_checked_too_early_matters_if_an_action_fails(
    tmp_path: Path, is_failing: bool, severity: Severity
) -> None:
    text = examples(CODE, "Bad")[1].text
    if not is_failing:
        low = '<bt_tick target="ready" cond="level &lt; 10"><bt_return_status status="FAILURE" /></bt_tick>'
        assert low in text
        text = text.replace(low, low.replace("FAILURE", "RUNNING"))
    write_files(tmp_path, text)
    [found] = [d for d in api.check([str(tmp_path / "main.xml")]).diagnostics if d.code == CODE]
    assert found.severity is severity
    assert is_failing or "`ReactiveSequence`" in found.message


def test_findings_in_unchanged_files_remain_until_the_next_exploration(tmp_path: Path) -> None:
    write_files(tmp_path, examples(CODE, "Bad")[0].text)
    workspace = Workspace((str(tmp_path),), Settings())
    tree, battery = str(tmp_path / "tree.xml"), str(tmp_path / "battery.ascxml")

    def of(path: str, *, explores: bool = False) -> list[str]:
        found = workspace.snapshot().checker.diagnostics(path, explores=explores)
        return [d.message for d in found if d.code == CODE]

    def change(path: str, old: str, new: str) -> None:
        workspace.open(path, Path(path).read_text(encoding="utf-8").replace(old, new))

    assert of(tree) == []
    before = of(tree, explores=True)
    assert len(before) == 1
    change(battery, "level - 10", "level - 1")
    assert of(tree) == before
    change(battery, "level - 10", "level - no_such_variable")
    assert of(tree, explores=True) == before
    change(battery, "level - 10", "level - 90")
    assert of(tree) == before
    assert of(tree, explores=True) == []
    workspace.close(battery)
    assert of(tree, explores=True) == before
    change(tree, "<Recharge />", "<Recharge /> ")
    assert of(tree) == []


def test_related_places_in_changed_files_are_left_out(tmp_path: Path) -> None:
    write_files(tmp_path, examples("never-taken", "Bad")[0].text)
    workspace = Workspace((str(tmp_path),), Settings())
    dispenser, order = str(tmp_path / "dispenser.ascxml"), str(tmp_path / "order.ascxml")

    def related(*, explores: bool = False) -> set[str]:
        found = workspace.snapshot().checker.diagnostics(dispenser, explores=explores)
        [finding] = [d for d in found if d.code == "never-taken"]
        return {Path(place.location.path).name for place in finding.related}

    assert related(explores=True) == {"dispenser.ascxml", "order.ascxml", "tree.xml"}
    workspace.open(order, "\n" + Path(order).read_text(encoding="utf-8"))
    assert related() == {"dispenser.ascxml", "tree.xml"}
    assert related(explores=True) == {"dispenser.ascxml", "order.ascxml", "tree.xml"}


LIFT = """
-- main.xml --
<roaml>
    <parameters>
        <max_time value="30" unit="s" reaction_time="instant" />
        <bt_tick_rate value="1" />
    </parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="go.ascxml" />
    </behavior_tree>
    <node_models>
        <input type="node-ascxml" src="lift.ascxml" />
    </node_models>
    <properties>
        <input type="jani" src="properties.jani" />
    </properties>
</roaml>
-- tree.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <Sequence>
            <Go name="up" floor="3" />
            <Go name="down" floor="1" />
        </Sequence>
    </BehaviorTree>
</root>
-- go.ascxml --
<ascxml name="Go" version="1.0" initial="ready">
    <bt_declare_port_in key="floor" type="int8" />
    <datamodel><data id="floor" type="int8"><expr><bt_get_input key="floor" /></expr></data></datamodel>
    <ros_service_client name="lift" service_name="/lift" type="lift_interfaces/Go" />
    <state id="ready">
        <bt_tick target="moving">
            <ros_service_send_request name="lift"><field name="floor" expr="floor" /></ros_service_send_request>
            <bt_return_status status="RUNNING" />
        </bt_tick>
        <bt_halt target="ready"><bt_return_halted /></bt_halt>
    </state>
    <state id="moving">
        <ros_service_handle_response name="lift" target="there" />
        <bt_tick target="moving"><bt_return_status status="RUNNING" /></bt_tick>
        <bt_halt target="moving"><bt_return_halted /></bt_halt>
    </state>
    <state id="there">
        <bt_tick target="ready"><bt_return_status status="SUCCESS" /></bt_tick>
        <bt_halt target="ready"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
-- lift.ascxml --
<ascxml name="Lift" version="1.0" initial="still">
    <datamodel>
        <data id="floor" type="int16" expr="2" />
        <data id="wanted" type="int16" expr="2" />
    </datamodel>
    <ros_service_server name="lift" service_name="/lift" type="lift_interfaces/Go" />
    <ros_time_rate rate_hz="1" name="motor" />
    <state id="still">
        <ros_service_handle_request name="lift" target="moving">
            <assign location="wanted" expr="_req.floor" />
        </ros_service_handle_request>
    </state>
    <state id="moving">
        <ros_rate_callback name="motor" cond="floor &lt; wanted" target="moving">
            <assign location="floor" expr="floor + 1" />
        </ros_rate_callback>
        <ros_rate_callback name="motor" cond="floor &gt; wanted" target="moving">
            <assign location="floor" expr="floor - 1" />
        </ros_rate_callback>
        <ros_rate_callback name="motor" target="still"><ros_service_send_response name="lift" /></ros_rate_callback>
    </state>
</ascxml>
-- properties.jani --
{"properties": []}
-- as2fm.toml --
ros-path = ["interfaces"]
-- interfaces/lift_interfaces/package.xml --
<package><name>lift_interfaces</name></package>
-- interfaces/lift_interfaces/srv/Go.srv --
int8 floor
---
"""
"""A lift that goes up for one node and down for another one."""


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("floor - 1", "floor + 1", "floor &gt; wanted"),
        ("floor + 1", "floor - 1", "floor &lt; wanted"),
        ("floor &lt; wanted", "floor &lt;= wanted", "floor &lt;= wanted"),
        ("floor &gt; wanted", "floor &gt;= wanted", "floor &gt;= wanted"),
        ("", "", None),
    ],
)
@pytest.mark.parametrize("is_simulated", [True, False])
def test_a_count_that_goes_the_wrong_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, old: str, new: str, place: str | None, is_simulated: bool
) -> None:
    if is_simulated:
        monkeypatch.setattr(exploration, "MAX_STATES", 1)
    write_files(tmp_path, LIFT.replace(old, new) if old else LIFT)
    found = api.check([str(tmp_path)]).diagnostics
    assert not [d.message for d in found if d.severity is Severity.ERROR]
    blamed = [d for d in found if d.code == "never-taken"]
    assert [d.source.text[d.span.start : d.span.end] for d in blamed if d.source] == ([] if place is None else [place])
    assert all(len([r for r in d.related if "at all other times" in r.message]) == ("=" in new) for d in blamed)


def test_a_message_names_the_values_that_occur(tmp_path: Path) -> None:
    counted = LIFT.replace("floor - 1", "floor - 2").replace("floor + 1", "floor + 2")
    write_files(tmp_path, counted.replace('name="up" floor="3"', 'name="up" floor="1"'))
    [message] = [d.message for d in api.check([str(tmp_path)]).diagnostics if d.code == "never-taken"]
    assert "`floor` is between 0 and 2, `wanted` is 1 here" in message


COUNTER = """
-- main.xml --
<roaml>
    <parameters>
        <max_time value="10" unit="s" />
    </parameters>
    <node_models>
        <input type="node-ascxml" src="counter.ascxml" />
    </node_models>
    <properties>
        <input type="jani" src="properties.jani" />
    </properties>
</roaml>
-- counter.ascxml --
<ascxml name="Counter" version="1.0" initial="counting">
    <ros_topic_publisher name="weight" topic="/weight" type="std_msgs/Int32" />
    <ros_time_rate name="timer" rate_hz="1" />
    <datamodel>
        <data id="weights" type="int32[3]" expr="[5, 7, 9]" />
        <data id="next" type="int32" expr="0" />
    </datamodel>
    <state id="counting">
        <ros_rate_callback name="timer" target="counting" cond="next &lt; LIMIT">
            <ros_topic_publish name="weight"><field name="data" expr="VALUE" /></ros_topic_publish>
            <assign location="next" expr="next + 1" />
        </ros_rate_callback>
    </state>
</ascxml>
-- properties.jani --
{"properties": [{"name": "heavy", "expression": {"op": "filter", "fun": "values", "states": {"op": "initial"}, "values":
    {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "=", "left": "topic_weight_msg__ros_fields__data", "right": 7}}}}}]}
"""


def counter(folder: Path, limit: int, value: str) -> list[Diagnostic]:
    """The findings about undefined operations in a machine that counts up to a limit."""
    write_files(folder, COUNTER.replace("LIMIT", str(limit)).replace("VALUE", value))
    codes = ("index-out-of-bounds", "division-by-zero")
    return [d for d in api.check([str(folder / "main.xml")]).diagnostics if d.code in codes]


@pytest.mark.parametrize(("value", "part"), [("weights[next]", "next"), ("6 % (3 - next)", "3 - next")])
@pytest.mark.parametrize("is_simulated", [True, False])
def test_an_undefined_operation_that_a_run_executes_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, value: str, part: str, is_simulated: bool
) -> None:
    if is_simulated:
        monkeypatch.setattr(exploration, "_searched", lambda model: None)
    assert counter(tmp_path, 3, value) == []
    [found] = counter(tmp_path, 8, value)
    text = (tmp_path / "counter.ascxml").read_text(encoding="utf-8")
    assert found.severity is Severity.ERROR
    assert text[found.span.start : found.span.end] == part
    assert any("next: 2 → 3" in place.message for place in found.related)


def test_an_array_that_only_the_translation_limits_is_information(tmp_path: Path) -> None:
    text = COUNTER.replace('type="int32[3]" expr="[5, 7, 9]"', 'type="int32[]" expr="[]"').replace("LIMIT", "100")
    text = text.replace(
        '<max_time value="10" unit="s" />', '<max_time value="10" unit="s" /><max_array_size value="4" />'
    )
    assign = '<assign location="weights[weights.length]" expr="next" /><assign location="next"'
    write_files(tmp_path, text.replace('<assign location="next"', assign).replace("VALUE", "next"))
    found = [d for d in api.check([str(tmp_path / "main.xml")]).diagnostics if "undefined operation" in d.message]
    assert [d.severity for d in found] == [Severity.INFORMATION]


@pytest.mark.parametrize(("expected", "is_met"), [("= 0", False), ("> 0.5", True)])
def test_an_expectation_of_the_settings_that_no_value_meets(tmp_path: Path, expected: str, is_met: bool) -> None:
    write_files(tmp_path, COUNTER.replace("LIMIT", "3").replace("VALUE", "weights[next]"))
    comparison = read_comparison(expected)
    assert comparison is not None
    found = api.check([str(tmp_path / "main.xml")], settings=Settings(expectations={"heavy": comparison}))
    assert ("unmet-expectation" in [d.code for d in found.diagnostics]) is not is_met


def test_only_a_check_explores(tmp_path: Path, searches: list[int]) -> None:
    write_files(tmp_path, examples(CODE, "Bad")[0].text)
    main = str(tmp_path / "main.xml")
    api.load(main)
    api.draw(main)
    api.migrate([main])
    assert searches == []
    api.check([main])
    assert searches


ASKING = """\
-- FILE.ascxml --
<ascxml name="NAME" version="1.0" initial="idle">
    <ros_service_client name="asked" service_name="/SERVICE" type="std_srvs/Empty" />
    <state id="idle">
        <bt_tick target="waits"><ros_service_send_request name="asked" /></bt_tick>
        <bt_halt target="idle"><bt_return_halted /></bt_halt>
    </state>
    <state id="waits">
        <ros_service_handle_response name="asked" target="idle">
            <bt_return_status status="SUCCESS" />
        </ros_service_handle_response>
    </state>
</ascxml>
"""
"""A plugin that asks a service at each tick."""


def asking(file: str, name: str, service: str) -> str:
    return ASKING.replace("FILE", file).replace("NAME", name).replace("SERVICE", service)


WASHER = f"""\
{asking("start", "Start", "start")}{asking("unload", "Unload", "open")}\
-- main.xml --
<roaml>
    <parameters>
        <max_time value="10" unit="s" reaction_time="instant" />
        <bt_tick_rate value="1" />
    </parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="start.ascxml" />
        <input type="bt-plugin-ascxml" src="unload.ascxml" />
    </behavior_tree>
    <node_models><input type="node-ascxml" src="washer.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- tree.xml --
<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence>NODES</Sequence></BehaviorTree></root>
-- washer.ascxml --
<ascxml name="Washer" version="1.0" initial="empty">
    <ros_service_server name="start" service_name="/start" type="std_srvs/Empty" />
    <ros_service_server name="open" service_name="/open" type="std_srvs/Empty" />
    <state id="empty">
        <ros_service_handle_request name="start" target="full">
            <ros_service_send_response name="start" />
        </ros_service_handle_request>
        <ros_service_handle_request name="open" target="empty">
            <ros_service_send_response name="open" />
        </ros_service_handle_request>
    </state>
    <state id="full">
        <ros_service_handle_request name="open" target="empty">
            <ros_service_send_response name="open" />
        </ros_service_handle_request>
    </state>
</ascxml>
-- properties.jani --
{{"properties": []}}
"""


@pytest.mark.parametrize(
    ("nodes", "severity", "says_so"),
    [
        ("<Start /><Start /><Unload />", Severity.WARNING, False),
        ("<Start /><Unload />" * 2, Severity.INFORMATION, True),
    ],
)
def test_a_wait_that_depends_on_an_order_is_information_if_the_order_never_occurs(
    tmp_path: Path, nodes: str, severity: Severity, says_so: bool
) -> None:
    write_files(tmp_path, WASHER.replace("NODES", nodes))
    [found] = [d for d in api.check([str(tmp_path / "main.xml")]).diagnostics if d.code == "answer-needs-time"]
    assert found.severity is severity
    assert ("in none of 25 simulated runs" in found.message) == says_so
