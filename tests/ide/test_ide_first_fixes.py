# SPDX-License-Identifier: Apache-2.0
"""First fixes undo what is probably the mistake: a mistake is made in a sound system, and the first fix of a finding
restores the file."""

from __future__ import annotations

import pytest
from ide_case import path_of

from mending import applied, found
from roaml.diagnostics import Severity
from roaml.ide.code_actions import quick_fixes
from roaml.ide.code_actions.action import CodeAction
from roaml.ide.code_actions.harmless import _affected
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace

GATE = """\
<ascxml name="Gate" version="1.0" initial="closed">
    <datamodel>
        <data id="level" type="uint8" expr="200" />
        <data id="is_stuck" type="bool" expr="false" />
    </datamodel>
    <ros_service_server name="open" service_name="/open" type="std_srvs/SetBool" />
    <ros_service_server name="check" service_name="/check" type="std_srvs/Empty" />
    <state id="closed">
        <ros_service_handle_request name="open" target="moving" cond="_req.data">
            <assign location="level" expr="Math.max(level - 7, 0)" />
        </ros_service_handle_request>
        <ros_service_handle_request name="open" target="refusing" />
        <ros_service_handle_request name="check">
            <target id="closed" prob="loss">
                <ros_service_send_response name="check" />
            </target>
            <target id="checking" />
        </ros_service_handle_request>
    </state>
    <state id="checking">
        <transition target="closed">
            <ros_service_send_response name="check" />
        </transition>
    </state>
    <state id="refusing">
        <transition target="closed">
            <ros_service_send_response name="open">
                <field name="success" expr="false" />
                <field name="message" expr="'stuck'" />
            </ros_service_send_response>
        </transition>
    </state>
    <state id="moving">
        <transition target="closed">
            <ros_service_send_response name="open">
                <field name="success" expr="level &gt; 9 &amp;&amp; !is_stuck" />
                <field name="message" expr="'open'" />
            </ros_service_send_response>
        </transition>
    </state>
</ascxml>
"""

ROBOT = """\
<ascxml name="Robot" version="1.0" initial="waiting">
    <ros_service_client name="open" service_name="/open" type="std_srvs/SetBool" />
    <ros_service_client name="check" service_name="/check" type="std_srvs/Empty" />
    <ros_time_rate name="timer" rate_hz="1" />
    <datamodel>
        <data id="fast" type="bool" expr="true" />
    </datamodel>
    <state id="waiting">
        <ros_rate_callback name="timer" target="opening">
            <ros_service_send_request name="open">
                <field name="data" expr="fast" />
            </ros_service_send_request>
        </ros_rate_callback>
    </state>
    <state id="opening">
        <ros_service_handle_response name="open" target="checking">
            <assign location="fast" expr="!_res.success" />
            <ros_service_send_request name="check" />
        </ros_service_handle_response>
    </state>
    <state id="checking">
        <ros_service_handle_response name="check" target="waiting" />
    </state>
</ascxml>
"""

MAIN = """\
<roaml>
    <parameter_declarations>
        <parameter name="loss" type="float64" value="0.25" min="0" max="1" />
    </parameter_declarations>
    <parameters>
        <max_time value="9" unit="s" />
    </parameters>
    <node_models>
        <input type="node-ascxml" src="gate.ascxml" />
        <input type="node-ascxml" src="robot.ascxml" />
    </node_models>
    <properties><input type="jani" src="p.jani" /></properties>
</roaml>
"""
OPENED = GATE.partition('<state id="moving">\n        <transition target="closed">\n')[2]
RESPONSE = OPENED.partition("        </transition>")[0]

MISTAKES = [
    ('target="moving"', 'target="closed"', "unanswered-request", "Go to the state `moving`, which answers"),
    (RESPONSE, f'<if cond="there">\n{RESPONSE}</if>', "unanswered-request", "Answer without this condition"),
    (RESPONSE, f'<if cond="is_stuck">{RESPONSE}</if>', "unanswered-request", "Answer without this condition"),
    ("Math.max(level", "Math.min(level", "wrong-limit", "Change to `Math.max`"),
    ('response name="open"', 'response name="check"', "unknown-field", "Change to `open`"),
]


def snapshot_with(gate: str) -> Snapshot:
    workspace = Workspace((path_of(""),), Settings())
    texts = {"main.xml": MAIN, "gate.ascxml": gate, "robot.ascxml": ROBOT, "p.jani": '{"properties": []}'}
    for name, text in texts.items():
        workspace.open(path_of(name), text)
    return workspace.snapshot()


def fixes(snapshot: Snapshot, name: str, code: str) -> list[CodeAction]:
    path = path_of(name)
    finding = next(d for d in snapshot.checker.diagnostics(path) if d.code == code)
    return list(quick_fixes(snapshot, path, finding))


def test_the_system_is_sound() -> None:
    assert not [d for d in found(snapshot_with(GATE)) if d.severity >= Severity.WARNING]


@pytest.mark.parametrize(("old", "new", "code", "title"), MISTAKES)
def test_the_first_fix_undoes_the_mistake(old: str, new: str, code: str, title: str) -> None:
    assert old in GATE
    snapshot = snapshot_with(GATE.replace(old, new, 1))
    fix = fixes(snapshot, "gate.ascxml", code)[0]
    assert fix.title == title
    (text,) = applied(snapshot, fix.make()).values()
    assert "".join(text.split()) == "".join(GATE.split())


def test_a_needed_condition_stays() -> None:
    """It depends on what the machine receives, so both parts need an answer."""
    gate = GATE.replace(RESPONSE, f'<if cond="level &gt; 50">{RESPONSE}</if>', 1)
    assert fixes(snapshot_with(gate), "gate.ascxml", "unanswered-request")[0].title.endswith("if no condition holds")


def test_an_unused_parameter_stays_while_there_are_other_mistakes() -> None:
    unused = GATE.replace("loss", "0.5")
    assert [fix.title for fix in fixes(snapshot_with(unused), "main.xml", "unused-parameter")] == [
        "Remove the parameter `loss`"
    ]
    wrong = unused.replace('prob="0.5"', 'prob="7"')
    assert not fixes(snapshot_with(wrong), "main.xml", "unused-parameter")


def test_machines_without_common_data_are_not_checked_for_a_fix() -> None:
    lamp = '<ascxml name="Lamp" version="1.0" initial="on"><state id="on" /></ascxml>\n'
    workspace = Workspace((path_of(""),), Settings())
    main = MAIN.replace('src="gate.ascxml" />', 'src="gate.ascxml" /><input type="node-ascxml" src="lamp.ascxml" />')
    texts = {"main.xml": main, "gate.ascxml": GATE, "robot.ascxml": ROBOT, "lamp.ascxml": lamp, "p.jani": "{}"}
    for name, text in texts.items():
        workspace.open(path_of(name), text)
    snapshot = workspace.snapshot()
    paths = {path_of(name) for name in texts}
    assert set(_affected(snapshot, [path_of("gate.ascxml")])) == paths - {path_of("lamp.ascxml")}
    assert set(_affected(snapshot, [path_of("lamp.ascxml")])) == paths - {
        path_of(f"{n}.ascxml") for n in ("gate", "robot")
    }
    assert set(_affected(snapshot, [path_of("main.xml")])) == paths
