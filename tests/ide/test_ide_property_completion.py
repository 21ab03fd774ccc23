# SPDX-License-Identifier: Apache-2.0
"""Completion in property files in XML."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from ide_models import load

from fixture import split_files
from property_robot import PROPERTIES, ROBOT
from roaml import api
from roaml.ide.completion import Completions, complete, document, plain
from roaml.project.explored_findings import CODES
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot

TEXTS = split_files(ROBOT)

UNEXPLORED = Settings(ignore=CODES)
"""What is inserted is complete, but the system need not do what it requires."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robot")
    load(folder, TEXTS)
    return folder


def snapshot(folder: Path, text: str) -> Snapshot:
    texts = {str(folder / "properties.xml"): text}
    return api.check([str(folder / "main.xml")], settings=Settings(), texts=texts).snapshot


def offered(folder: Path, old: str, new: str) -> tuple[Completions, str, Snapshot]:
    """The completions at `|` in `new`, which replaces `old` in the property file."""
    assert PROPERTIES.count(old) == 1, old
    before, after = PROPERTIES.split(old)
    offset = len(before) + new.index("|")
    text = before + new.replace("|", "", 1) + after
    current = snapshot(folder, text)
    completions = complete(current, str(folder / "properties.xml"), offset)
    assert completions is not None
    return completions, text, current


LEVEL = '<ros_topic topic_name="/battery/level" type="std_msgs/Int32" event="publish">'
COUNT = '<ros_action action_name="/count" type="example_interfaces/Fibonacci" event="result">'
CHARGES = '<property id="charges" pattern="response">'


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (LEVEL, '<ros_topic topic_name="|">', ["/battery/level", "/pose"]),
        (LEVEL, '<ros_topic topic_name="/battery/level" type="|">', ["std_msgs/Int32"]),
        (LEVEL, '<ros_topic topic_name="/battery/level" type="std_msgs/Int32" event="|">', ["publish"]),
        (COUNT, '<ros_action action_name="|">', ["/count"]),
        (
            COUNT,
            COUNT.replace('"result"', '"|"'),
            ["goal_request", "goal_response", "feedback", "result", "cancel_request"],
        ),
        (COUNT, COUNT.replace(">", ' target="|">'), ["pick", "pick", "right_pick", "Arm"]),
        ('node="Left/pick"', 'node="|"', ["KeepRunningUntilFailure", "Left/steps", "Left/pick"]),
        (
            'node="Left/pick"',
            'node="|"',
            ["Other/Sequence", "again/steps", "again/pick", "right_pick", "Main/KeepRunningUntilFailure/Sequence"],
        ),
        ('event="full"', 'event="|"', ["full", "topic_battery__level_msg", "bt_1003_response"]),
        ('param="amount"', 'param="|"', ["amount"]),
        ('field="stamp.sec"', 'field="|"', ["stamp.sec", "stamp.nanosec", "frame_id"]),
        ('field="status"', 'field="|"', ["status"]),
        ('type="int32" field="stamp.sec"', 'type="|" field="stamp.sec"', ["int32", "bool"]),
        ('field="stamp.sec" expr="0"', 'field="stamp.sec" expr="|"', ["0"]),
        ('<accepted id="taken" expr="false"/>', '<accepted id="taken" expr="|"/>', ["false", "true"]),
        (CHARGES, '<property id="charges" pattern="|">', ["universality", "response", "recurrence"]),
        ('type="globally"', 'type="|"', ["globally", "after", "before", "until", "between", "after-until"]),
        ('time_unit="s"', 'time_unit="|"', ["s", "ms", "us", "ns"]),
        ("<event>level &lt; 30</event>", "<event>|</event>", ["measured", "asked", "success", "level", "code"]),
        ('event="filled || amount', 'event="|', ["filled"]),
        ("status == 1", "status == |", ["1", "2", "3"]),
        ("code == 4", "code == |", ["4", "5", "6"]),
        ("{ measured }", "{ | }", ["measured", "level"]),
        ('expr="H ({', 'expr="|({', ["{ }", "H", "O", "S", "->"]),
        ("<guarantees>", "<guarantees>|", ["property response", "property absence", "property"]),
        ("<guarantees>", "<guarantees><|", ["property recurrence"]),
        ("<ports>", "<ports>|", ["ros_topic /pose publish", "ros_service /charge request", "bt_node Left/pick"]),
        ('<scope type="after"', "|<scope", ["time_interval within"]),
        ('event_var id="measured"', "event_var |", ["id"]),
        ('event_var id="measured"', 'event_var id="|"', ["measured", "battery_level"]),
    ],
)
def test_offered(folder: Path, old: str, new: str, expected: list[str]) -> None:
    labels = [item.label for item in offered(folder, old, new)[0].items]
    assert [label for label in expected if label not in labels] == [], labels


def test_what_does_not_fit_is_not_offered(folder: Path) -> None:
    def labels(old: str, new: str) -> set[str]:
        return {item.label for item in offered(folder, old, new)[0].items}

    assert "/charge" not in labels(LEVEL, '<ros_topic topic_name="|">')
    assert "param" not in labels('field="stamp.sec"', "|")
    assert "field" not in labels('param="amount"', "|")
    assert "time_interval within" not in labels('<scope type="globally"/>', '<scope type="globally"/>|')


def details(folder: Path, old: str, new: str) -> dict[str, str]:
    return {item.label: item.detail for item in offered(folder, old, new)[0].items}


def test_details(folder: Path) -> None:
    assert details(folder, "status == 1", "status == |")["1"] == "SUCCESS"
    assert details(folder, "code == 4", "code == |")["6"] == "STATUS_ABORTED"
    assert details(folder, 'node="Left/pick"', 'node="|"')["Left/pick"] == 'Left/Pick "pick"'
    assert details(folder, "<event>level &lt; 30</event>", "<event>|</event>")["level"] == "int32"


@pytest.mark.parametrize("pattern", ["universality", "absence", "existence", "response", "precedence", "recurrence"])
def test_the_skeleton_of_a_property_is_complete(folder: Path, pattern: str) -> None:
    completions, text, _ = offered(folder, "<guarantees>", "<guarantees>|")
    item = next(item for item in completions.items if item.label == f"property {pattern}")
    inserted = plain(item.snippet).replace("<event></event>", "<event>measured</event>")
    start, end = completions.span
    changed = f"{text[:start]}{inserted}{text[end:]}"
    path = str(folder / "properties.xml")
    result = api.check([str(folder / "main.xml")], settings=UNEXPLORED, texts={path: changed})
    codes = {d.code for d in result.diagnostics if d.path == path}
    assert codes <= {"port-of-several-clients", "event-false-at-start", "repeated-operand"}  # one event for both


def test_patterns_are_offered_as_sentences_in_each_scope(folder: Path) -> None:
    """The inserted text has the meaning of the sentence, and only the conditions are missing."""
    for typed in ("<guarantees>|", "<guarantees>when|"):
        completions, text, _ = offered(folder, "<guarantees>", typed)
        sentences = {item.label: item for item in completions.items if "…" in item.label}
        assert len(sentences) == 6 * 11
        assert "Whenever …, … within …" in sentences
    path, main = str(folder / "properties.xml"), str(folder / "main.xml")
    inserted = []
    for number, item in enumerate(sentences.values()):
        whole = plain(item.snippet).replace("<event></event>", "<event>measured</event>")
        inserted.append(re.sub(r'(event|until)=""', r'\1="asked"', whole).replace('id="name"', f'id="new_{number}"'))
    start, end = completions.span
    changed = f"{text[:start]}{''.join(inserted)}{text[end:]}"
    result = api.check([main], settings=UNEXPLORED, texts={path: changed})
    codes = {d.code for d in result.diagnostics if d.path == path}
    assert codes <= {"port-of-several-clients", "event-false-at-start", "repeated-operand"}  # one event for both
    linked = result.snapshot.analysis.linked_properties(path, main)
    assert linked is not None
    said = {property_.name: property_.sentence.lower() for property_ in linked.properties}
    for number, label in enumerate(sentences):
        assert [word for word in re.findall(r"[a-z]{3,}", label.lower()) if word not in said[f"new_{number}"]] == []


def test_the_skeleton_of_a_port_is_complete(folder: Path) -> None:
    completions, text, _ = offered(folder, "<ports>", "<ports>|")
    path = str(folder / "properties.xml")
    for item in completions.items:
        if " " in item.label:
            inserted = plain(item.snippet).replace('id="name"', 'id="name_of_none"')
            changed = f"{text[: completions.span.start]}{inserted}{text[completions.span.end :]}"
            result = api.check([str(folder / "main.xml")], settings=UNEXPLORED, texts={path: changed})
            codes = {d.code for d in result.diagnostics if d.path == path}
            assert codes <= {"port-of-several-clients", "unused-port-variable", "unsent-port", "equal-ports"}, (
                item.label
            )


def test_documentation(folder: Path) -> None:
    completions, _, current = offered(folder, "<event>level &lt; 30</event>", "<event>|</event>")
    about = next(item.about for item in completions.items if item.label == "level")
    assert about is not None
    assert document(current.analysis, about) == (
        "```\nlevel : int32\n```\n\n"
        "The value of `data` at the last time that a message is published on `/battery/level`; `100` before"
    )
