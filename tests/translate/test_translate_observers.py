# SPDX-License-Identifier: Apache-2.0
"""Properties in XML beside hand-written properties in JANI that ask the same, in one model: Storm computes the same
probabilities, and the same traces satisfy both."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping

import pytest
from storm import exact
from translating import errors, loaded

from as2fm_lsp.verification.report import one_as_text, row, warning
from roaml import api
from roaml.explicit.space import StateLimits
from roaml.jani.model import Model
from roaml.jani.operators import BinaryOperator
from roaml.jani.writer import write
from roaml.record import replace
from roaml.scxml.names import TIME_OVER_ACTION
from roaml.smc.goal import Threshold
from roaml.smc.run import EstimationMethod, Options
from roaml.verification.expectations import Expectation, Verdict

COIN = """<ascxml name="Coin" version="1.0" initial="toss">
    <datamodel><data id="count" type="int32" expr="0" /></datamodel>
    <ros_time_rate name="second" rate_hz="1" />
    <ros_topic_publisher name="heads" topic="/heads" type="std_msgs/Int32" />
    <ros_topic_publisher name="tails" topic="/tails" type="std_msgs/Empty" />
    <state id="toss">
        <ros_rate_callback name="second">
            <target id="toss" prob="0.3">
                <assign location="count" expr="count + 1" />
                <ros_topic_publish name="heads"><field name="data" expr="count" /></ros_topic_publish>
            </target>
            <target id="toss" prob="0.2"><ros_topic_publish name="tails" /></target>
            <target id="toss" />
        </ros_rate_callback>
    </state>
</ascxml>"""
REFEREE = """<ascxml name="Judge" version="1.0" initial="wait">
    <ros_topic_subscriber name="heads" topic="/heads" type="std_msgs/Int32" />
    <ros_topic_publisher name="whistle" topic="/whistle" type="std_msgs/Bool" />
    <state id="wait">
        <ros_topic_callback name="heads">
            <target id="wait" prob="0.4">
                <ros_topic_publish name="whistle"><field name="data" expr="true" /></ros_topic_publish>
            </target>
            <target id="wait" />
        </ros_topic_callback>
    </state>
</ascxml>"""
PORTS = """<ports>
    <ros_topic topic_name="/heads" type="std_msgs/Int32" event="publish">
        <event_var id="heads" /><state_var id="count" type="int32" field="data" expr="7" />
    </ros_topic>
    <ros_topic topic_name="/tails" type="std_msgs/Empty" event="publish"><event_var id="tails" /></ros_topic>
    <ros_topic topic_name="/whistle" type="std_msgs/Bool" event="publish"><event_var id="whistle" /></ros_topic>
</ports>"""

HEADS, TAILS, WHISTLE = "topic_heads_msg.valid", "topic_tails_msg.valid", "topic_whistle_msg.valid"
COUNT = "topic_heads_msg__ros_fields__data"


def op(name: str, *parts: object) -> dict[str, object]:
    keys = ("exp",) if len(parts) == 1 else ("left", "right")
    return {"op": name, **dict(zip(keys, parts, strict=True))}


def at_least(count: int) -> dict[str, object]:
    return op("≥", COUNT, count)


def weak_until(left: object, right: object) -> dict[str, object]:
    """Storm does not read W."""
    return op("∨", op("G", left), op("U", left, right))


EQUIVALENTS: Mapping[str, tuple[str, object]] = {
    "existence": (
        '<property id="{}" pattern="existence"><event>whistle</event><scope type="globally" /></property>',
        op("F", WHISTLE),
    ),
    "absence": (
        '<property id="{}" pattern="absence"><event>whistle || tails</event><scope type="globally" /></property>',
        op("G", op("∧", op("¬", WHISTLE), op("¬", TAILS))),
    ),
    "universality": (
        '<property id="{}" pattern="universality"><event>count != 2</event><scope type="globally" /></property>',
        op("G", op("≠", COUNT, 2)),
    ),
    "precedence": (
        '<property id="{}" pattern="precedence"><events><event>whistle</event><event>tails</event></events>'
        '<scope type="globally" /></property>',
        weak_until(op("¬", TAILS), WHISTLE),
    ),
    "existence_before": (
        '<property id="{}" pattern="existence"><event>whistle</event><scope type="before" event="tails" /></property>',
        op("∨", op("G", op("¬", TAILS)), op("U", op("¬", TAILS), WHISTLE)),
    ),
    "existence_until": (
        '<property id="{}" pattern="existence"><event>heads</event><scope type="until" event="tails" /></property>',
        op("U", op("¬", TAILS), HEADS),
    ),
    "absence_before": (
        '<property id="{}" pattern="absence"><event>whistle</event>'
        '<scope type="before" event="heads &amp;&amp; count == 3" /></property>',
        op("∨", op("G", op("<", COUNT, 3)), weak_until(op("¬", WHISTLE), at_least(3))),
    ),
    "absence_until": (
        '<property id="{}" pattern="absence"><event>whistle</event><scope type="until" event="tails" /></property>',
        weak_until(op("¬", WHISTLE), TAILS),
    ),
    "response_once": (
        '<property id="{}" pattern="response"><events><event>heads &amp;&amp; count == 1</event>'
        "<event>heads &amp;&amp; count == 3</event></events>"
        '<scope type="globally" /></property>',
        op("⇒", op("F", at_least(1)), op("F", at_least(3))),
    ),
    "formula": (
        '<property id="{}" logic="pmtl" expr="{{ tails }} -&gt; O {{ heads }}" />',
        weak_until(op("¬", TAILS), HEADS),
    ),
}


def system(guarantees: str, written_formulas: object = (), seconds: int = 6) -> dict[str, str]:
    inputs = '<input type="node-ascxml" src="coin.ascxml" /><input type="node-ascxml" src="judge.ascxml" />'
    return {
        "main.xml": f"""<roaml>
    <parameters><max_time value="{seconds}" unit="s" /></parameters>
    <node_models>{inputs}</node_models>
    <properties>
        <input type="xml" src="properties.xml" /><input type="jani" src="twins.jani" />
    </properties>
</roaml>""",
        "coin.ascxml": COIN,
        "judge.ascxml": REFEREE,
        "properties.xml": f"<properties>{PORTS}<guarantees>{guarantees}</guarantees></properties>",
        "twins.jani": json.dumps({"properties": list(written_formulas)}),  # type: ignore[call-overload]
    }


def hand_written(name: str, path: object) -> dict[str, object]:
    probability = {"op": "Pmin", "exp": path}
    values = {"op": "filter", "fun": "values", "values": probability, "states": {"op": "initial"}}
    return {"name": name, "expression": values}


def translated(name: str) -> Model:
    written, path = EQUIVALENTS[name]
    return api.to_jani(loaded(system(written.format(name), [hand_written("twin", path)])))


@pytest.mark.parametrize("name", EQUIVALENTS)
def test_storm_gives_the_same(name: str) -> None:
    model = translated(name)
    observed, by_hand = exact(model, name), exact(model, "twin")
    assert observed.least == pytest.approx(by_hand.least, abs=1e-6)
    assert observed.greatest == pytest.approx(by_hand.greatest, abs=1e-6)
    assert 0 < observed.least < 1


@pytest.mark.parametrize("name", EQUIVALENTS)
def test_the_same_traces_satisfy_both(name: str) -> None:
    options = Options(method=EstimationMethod.FIXED, max_traces=300, seed=11)
    one, other = api.verify(translated(name), [name, "twin"], options, only_uniform=True)
    assert one.answer is not None
    assert other.answer is not None
    verdicts = [
        {verdict: [seen.trace for seen in seens] for verdict, seens in answer.tally.examples.items()}
        for answer in (one.answer, other.answer)
    ]
    assert verdicts[0] == verdicts[1]
    counts = [(tally.traces, tally.successes, tally.undecided) for tally in (one.answer.tally, other.answer.tally)]
    assert counts[0] == counts[1]
    assert (one.answer.value, one.answer.bounds) == (other.answer.value, other.answer.bounds)
    assert 0 < one.answer.tally.successes < 300


def test_other_properties_keep_their_answers() -> None:
    """The model with an observer does what the model without it does."""
    with_observer = translated("existence")
    alone = api.to_jani(loaded(system("", [hand_written("twin", EQUIVALENTS["existence"][1])])))
    assert exact(alone, "twin").least == pytest.approx(exact(with_observer, "twin").least, abs=1e-9)
    assert not any(action.name == TIME_OVER_ACTION for action in alone.actions)


def test_an_observer_joins_existing_synchronisations() -> None:
    plain = api.to_jani(loaded(system("")))
    model = translated("existence_until")
    observer = model.automata[-1]
    assert observer.name == "existence_until__observer"
    assert [location.name for location in observer.locations] == ["observing"]
    assert all(edge.guard is None and len(edge.destinations) == 1 for edge in observer.edges)
    results = {sync.result for sync in plain.system.syncs}
    assert {sync.result for sync in model.system.syncs} == results


TIMED = """
<property id="soon" pattern="existence"><event>whistle</event><scope type="globally" />
    <time_interval time="20" time_unit="s" /></property>
<property id="answered" pattern="response"><events><event>heads</event><event>whistle</event></events>
    <scope type="globally" /><time_interval time="2500" time_unit="ms" /></property>
"""


def test_what_is_open_at_the_end_of_time_is_undecided() -> None:
    model = api.to_jani(loaded(system(TIMED)))
    options = Options(method=EstimationMethod.FIXED, max_traces=200, seed=3)
    soon, answered = api.verify(model, ["soon", "answered"], options, only_uniform=True)
    assert soon.answer is not None
    assert answered.answer is not None
    assert soon.answer.failures == 0
    assert soon.answer.tally.undecided > 0
    assert answered.answer.failures > 0
    assert answered.answer.tally.undecided > 0
    assert soon.answer.bounds.upper == 1
    # Other tools count what is open as satisfied.
    assert exact(model, "soon").least == pytest.approx(1)


def test_names_that_clash_are_changed() -> None:
    clash = EQUIVALENTS["existence"][0].format("topic_heads_msg")
    model = api.to_jani(loaded(system(clash)))
    names = [automaton.name for automaton in model.automata]
    assert names[-1] == "topic_heads_msg___observer"
    assert len(set(names)) == len(names)
    assert model.properties[-1].name == "topic_heads_msg"


def test_properties_are_chosen_by_name() -> None:
    source = loaded(system(TIMED, [hand_written("twin", op("F", HEADS))]))
    assert [p.name for p in api.to_jani(source).properties] == ["twin", "soon", "answered"]
    assert [p.name for p in api.to_jani(source, ["answered"]).properties] == ["answered"]


def with_assumptions(assumed: str, guarantees: str) -> dict[str, str]:
    files = system("")
    sections = f"<assumes>{assumed}</assumes><guarantees>{guarantees}</guarantees>"
    return {**files, "properties.xml": f"<properties>{PORTS}{sections}</properties>"}


EXISTS = '<property id="{}" pattern="existence"><event>{}</event><scope type="globally" /></property>'
ANSWERED = """<property id="{}" pattern="response"><events><event>{}</event><event>{}</event></events>
    <scope type="{}" /></property>"""
ASSUMED = {
    "existence given existence": (EXISTS.format("some", "heads"), EXISTS.format("g", "whistle")),
    "absence given two": (
        EXISTS.format("some", "heads") + EXISTS.format("other", "tails"),
        '<property id="g" pattern="absence"><event>count == 3</event><scope type="globally" /></property>',
    ),
    "existence given a response": (
        ANSWERED.format("answered", "tails", "heads", "globally"),
        EXISTS.format("g", "whistle"),
    ),
}


@pytest.mark.parametrize("name", ASSUMED)
def test_the_value_given_assumptions_is_the_ratio_that_storm_computes(name: str) -> None:
    source = loaded(with_assumptions(*ASSUMED[name]))
    model = api.to_jani(source)
    assert [property_.name for property_ in model.properties] == ["g", "g__assumptions"]
    both, assumed = exact(model, "g"), exact(model, "g__assumptions")
    assert both.least == pytest.approx(both.greatest)
    assert assumed.least == pytest.approx(assumed.greatest)
    assert 0 < both.least < assumed.least < 1
    options = Options(method=EstimationMethod.FIXED, max_traces=4000, seed=2, confidence=0.999)
    (result,) = api.verify(source, options=options)
    assert result.answer is not None
    assert result.answer.tally.simulated == 4000
    assert result.answer.tally.traces / 4000 == pytest.approx(assumed.least, abs=0.03)
    bounds = result.answer.bounds
    assert bounds.lower <= both.least / assumed.least <= bounds.upper
    assert bounds.half_width < 0.04
    verifier = api.verifier(source)
    undecided = verifier.exhaustive(verifier.question("g"), StateLimits(100_000)).outcome
    assert isinstance(undecided, api.Undecided)
    assert "given assumptions" in undecided.reason


def test_assumptions_that_no_trace_satisfies_leave_no_value() -> None:
    source = loaded(with_assumptions(EXISTS.format("never", "count == 70"), EXISTS.format("g", "whistle")))
    (result,) = api.verify(
        source, options=Options(method=EstimationMethod.FIXED, max_traces=150), expectations=["g >= 0.1"]
    )
    assert result.answer is not None
    assert (result.answer.tally.traces, result.answer.tally.rejected) == (0, 150)
    assert not result.is_met
    why = "no trace satisfies the assumptions of the property, so there is no value: 150 traces violate them"
    assert one_as_text(result, str).startswith(f"g: {why}, ")
    assert row(result)["assumptions"] == {"satisfied": 0, "violated": 150}
    assert warning(result) == why


def test_a_trace_that_leaves_an_assumption_open_is_undecided() -> None:
    late = EXISTS.format("late", "whistle").replace(
        "</property>", '<time_interval after="3" within="50" time_unit="s" /></property>'
    )
    source = loaded(with_assumptions(late, EXISTS.format("g", "heads")))
    (result,) = api.verify(source, options=Options(method=EstimationMethod.FIXED, max_traces=150))
    assert result.answer is not None
    tally = result.answer.tally
    assert tally.rejected == 0
    assert 0 < tally.undecided < tally.traces == 150


def test_an_expectation_beside_the_property() -> None:
    expected = EXISTS.format("some", "heads").replace("<property", '<property expect="&gt;= 0.95"')
    source = loaded(system(expected + EXISTS.format("other", "tails")))
    some, other = api.verify(source, options=Options(method=EstimationMethod.FIXED, max_traces=300), only_uniform=True)
    assert [verdict.expectation.text for verdict in some.verdicts] == ["≥ 0.95"]
    assert not some.is_met
    assert other.has_no_expectation
    # It does not change what other tools compute: the sentence in the comment contains it, the expression does not.
    translated = json.loads("".join(write(api.to_jani(source))))["properties"][0]
    assert "0.95" in translated["comment"]
    assert "0.95" not in json.dumps(translated["expression"])


@pytest.mark.parametrize("written", ["often", "&gt;= 1.2", "0.9", "&gt;= nan"])
def test_an_expectation_that_compares_with_no_probability(written: str) -> None:
    wrong = EXISTS.format("some", "heads").replace("<property", f'<property expect="{written}"')
    assert [error.code for error in errors(system(wrong))] == ["property-form"]


def test_nothing_is_expected_of_an_assumption() -> None:
    assumed = EXISTS.format("some", "heads").replace("<property", '<property expect="&gt;= 0.5"')
    diagnostics = errors(with_assumptions(assumed, EXISTS.format("g", "whistle")))
    assert [(error.code, error.message) for error in diagnostics] == [
        ("property-form", "an assumption has no probability; remove `expect`")
    ]


VACUOUS = f"""
{ANSWERED.format("scoped", "tails", "whistle", "after").replace("<scope", '<scope event="count == 2"')}
{ANSWERED.format("answered", "tails", "whistle", "globally")}
{ANSWERED.format("dead", "count == 70", "whistle", "globally")}
<property id="unopened" pattern="absence"><event>tails</event><scope type="after" event="count == 70" /></property>
<property id="opened" pattern="absence"><event>tails</event><scope type="after" event="count == 1" /></property>
"""


def test_vacuous_traces_and_those_that_fail_at_the_end_of_time_are_counted() -> None:
    options = Options(method=EstimationMethod.FIXED, max_traces=300, seed=1)
    answered = api.verify(loaded(system(VACUOUS)), options=options, only_uniform=True)
    results = {result.name: result for result in answered}
    rows = {name: row(result) for name, result in results.items()}
    assert rows["scoped"]["vacuous"]["scope_not_judged"] > 0
    assert rows["scoped"]["vacuous"]["not_triggered"] > 0
    assert sum(rows["scoped"]["vacuous"].values()) < 300
    assert rows["answered"]["vacuous"]["scope_not_judged"] == 0
    assert 0 < rows["answered"]["vacuous"]["not_triggered"] < 300
    # Half of the ticks are neither heads nor tails.
    assert rows["answered"]["vacuous"]["not_triggered"] / 300 == pytest.approx(0.8**6, abs=0.1)
    # Nothing but the end of time violates an untimed response of this system.
    assert rows["answered"]["failed_at_end_of_time"] == rows["answered"]["failed"] > 0
    assert rows["dead"]["vacuous"] == {"scope_not_judged": 0, "not_triggered": 300}
    untested = "nothing has tested the property, so this value does not show that the system is right (vacuous): "
    remedy = "check whether it can happen at all, or allow more time (max_time)"
    trigger = r"what must happen before the property requires anything, did not happen"
    assert warning(results["dead"]) == f"{untested}`count == 70`, {trigger} in any trace; {remedy}"
    verdict = Verdict(Expectation("dead", Threshold(BinaryOperator.GREATER_EQUAL, 0.9)), True, True)
    text = one_as_text(replace(results["dead"], verdicts=(verdict,)), str)
    assert "  expected ≥ 0.9: met, but nothing has tested the property" in text
    assert rows["unopened"]["vacuous"] == {"scope_not_judged": 300, "not_triggered": 0}
    scope = "the event that begins or ends the scope of the property, did not happen"
    assert re.fullmatch(
        f"{re.escape(untested)}`.+`, {scope} in any trace; {re.escape(remedy)}", warning(results["unopened"])
    )
    assert rows["opened"]["vacuous"]["scope_not_judged"] / 300 == pytest.approx(0.7**6, abs=0.1)
    assert rows["opened"]["vacuous"]["not_triggered"] == 0
    assert rows["opened"]["failed"] > 0
    text = one_as_text(results["scoped"], str)
    assert re.search(rf"\n  `.+`, {scope} in [0-9]+ of 300 traces \(", text)
    assert re.search(rf"\n  `.+`, {trigger} in [0-9]+ of 300 traces \(", text)
    assert "failed traces fail because the time ends (max_time)" in text


BEFORE = """
<property id="existence" pattern="existence"><event>heads</event><scope type="before" event="whistle" /></property>
<property id="absence" pattern="absence"><event>whistle</event><scope type="before" event="heads" /></property>
<property id="response" pattern="response"><events><event>heads</event><event>heads</event></events>
    <scope type="before" event="whistle" /></property>
<property id="never" pattern="absence"><event>heads</event><scope type="before" event="tails" /></property>
"""


def test_a_property_is_not_vacuous_if_its_scope_closes_in_each_trace() -> None:
    """Each trace has heads, then a whistle, and no tails."""
    written = system(BEFORE)
    coin = written["coin.ascxml"].replace('prob="0.3"', 'prob="1"').replace('<target id="toss" />', "")
    written["coin.ascxml"] = re.sub(r'<target id="toss" prob="0.2">.*</target>', "", coin)
    judge = written["judge.ascxml"].replace(' prob="0.4"', "")
    written["judge.ascxml"] = judge.replace('<target id="wait" />', "")
    options = Options(method=EstimationMethod.FIXED, max_traces=10)
    results = {result.name: result for result in api.verify(loaded(written), options=options, only_uniform=True)}
    for name in ("existence", "absence", "response"):
        assert row(results[name])["probability"] == 1
        assert row(results[name])["vacuous"] == {"scope_not_judged": 0, "not_triggered": 0}
        assert not warning(results[name])
    scope = "`tails`, the event that begins or ends the scope of the property, did not happen"
    assert f"(vacuous): {scope}" in warning(results["never"])


def test_what_observers_say_of_their_activity_changes_no_answer() -> None:
    source = loaded(system(VACUOUS))
    options = Options(method=EstimationMethod.FIXED, max_traces=200)
    plain, full = (
        [(result.name, result.answer and result.answer.value) for result in api.verify(subject, options=options)]
        for subject in (api.to_jani(source), source)
    )
    assert plain == full
    names = {variable.name for variable in api.to_jani(source).variables}
    assert not any(name.endswith(("__asked", "__opened")) for name in names)


NOTES = '<ros_topic_publisher name="notes" topic="/notes" type="std_msgs/Empty" />'
SERVER = f"""<ascxml name="Server" version="1.0" initial="wait">
    <ros_action_server name="count" action_name="/count" type="example_interfaces/Fibonacci" />
    {NOTES}
    <ros_action_thread name="count" n_threads="2" initial="wait">
        <datamodel />
        <state id="wait">
            <ros_action_handle_thread_start name="count" target="wait">
                <ros_topic_publish name="notes" />
                <ros_action_succeed name="count" goal_id="0"><field name="sequence" expr="[]" /></ros_action_succeed>
            </ros_action_handle_thread_start>
        </state>
    </ros_action_thread>
    <state id="wait">
        <ros_action_handle_goal name="count" target="wait">
            <ros_action_accept_goal name="count" goal_id="0" />
            <ros_action_start_thread name="count" thread_id="1" goal_id="0"><field name="order" expr="2" />
            </ros_action_start_thread>
        </ros_action_handle_goal>
    </state>
</ascxml>"""
CLIENT = f"""<ascxml name="Client" version="1.0" initial="ask">
    <ros_action_client name="count" action_name="/count" type="example_interfaces/Fibonacci" />
    {NOTES}
    <state id="ask">
        <onentry><ros_topic_publish name="notes" /></onentry>
        <transition target="wait">
            <ros_action_send_goal name="count"><field name="order" expr="2" /></ros_action_send_goal>
        </transition>
    </state>
    <state id="wait">
        <ros_action_handle_goal_response name="count" accept="wait" reject="wait" />
        <ros_action_handle_success_result name="count" target="wait" />
    </state>
</ascxml>"""
PROBE = f"""<ascxml name="Look" version="1.0" initial="wait">
    {NOTES}
    <state id="wait">
        <bt_tick target="wait"><ros_topic_publish name="notes" /><bt_return_status status="SUCCESS" /></bt_tick>
        <bt_halt target="wait"><bt_return_halted /></bt_halt>
    </state>
</ascxml>"""
TREE = """<root BTCPP_format="4" main_tree_to_execute="T"><BehaviorTree ID="T">
    <Sequence><Look name="left_thread_x" /><Look name="right_thread_x" /></Sequence>
</BehaviorTree></root>"""


def observed_senders(origin: str) -> list[str]:
    """The automata whose notes are observed if the port names this `origin`."""
    port = f'<ros_topic topic_name="/notes" type="std_msgs/Empty" event="publish" origin="{origin}">'
    existence = '<property id="noted" pattern="existence"><event>noted</event><scope type="globally" /></property>'
    model = api.to_jani(
        loaded(
            {
                "main.xml": """<roaml>
    <parameters><max_time value="1" unit="s" /><bt_tick_rate value="1" /></parameters>
    <node_models>
        <input type="node-ascxml" src="server.ascxml" /><input type="node-ascxml" src="client.ascxml" />
    </node_models>
    <behavior_tree><input type="bt.cpp-xml" src="tree.xml" /><input type="bt-plugin-ascxml" src="look.ascxml" />
    </behavior_tree>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>""",
                "server.ascxml": SERVER,
                "client.ascxml": CLIENT,
                "look.ascxml": PROBE,
                "tree.xml": TREE,
                "properties.xml": f'<properties><ports>{port}<event_var id="noted" /></ros_topic></ports>'
                f"<guarantees>{existence}</guarantees></properties>",
            }
        )
    )
    sending = [sync for sync in model.system.syncs if sync.result == "topic_notes_msg_on_send"]
    buffer, observer = "topic_notes_msg", "noted__observer"
    names = [[model.automata[index].name for index, _ in sync.participants] for sync in sending]
    return [name for group in names if observer in group for name in group if name not in (buffer, observer)]


@pytest.mark.parametrize(
    ("origin", "automata"),
    [
        ("Server", ["count_thread_0", "count_thread_1"]),
        ("Client", ["Client"]),
        ("left_thread_x", ["BT_plugin_1001_left_thread_x"]),
        ("Look", ["BT_plugin_1001_left_thread_x", "BT_plugin_1002_right_thread_x"]),
    ],
)
def test_an_origin_includes_the_threads_of_its_machine_and_no_other_automata(origin: str, automata: list[str]) -> None:
    assert observed_senders(origin) == automata
