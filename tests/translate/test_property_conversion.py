# SPDX-License-Identifier: Apache-2.0
"""Properties of every pattern, scope and time that JANI can express are converted from XML to JANI and back, with the
same answers; the conversion of other properties is not offered."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Mapping
from xml.sax.saxutils import escape, quoteattr

import pytest
from test_translate_observers import COUNT, HEADS, PORTS, TAILS, hand_written, op, system
from translating import FOLDER, loaded

from mending import applied
from roaml import api
from roaml.ide.code_actions import actions
from roaml.ide.code_actions.action import REWRITE, CodeAction
from roaml.ide.code_actions.convert_property import TO_JANI, TO_XML
from roaml.observers.properties import CLOSE, LEFT, OPEN, RIGHT, Pattern, ScopeKind
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace
from roaml.smc.run import EstimationMethod, Options
from roaml.text import Span

PROPERTIES, TWINS = os.path.join(FOLDER, "properties.xml"), os.path.join(FOLDER, "twins.jani")
STATES = {LEFT: "count % 2 == 1", RIGHT: "count == 2", OPEN: "count == 1", CLOSE: "count >= 3"}
EVENTS = {LEFT: "heads && count == 2", RIGHT: "tails || whistle", OPEN: "whistle", CLOSE: "tails"}
TIMES = {"": "", "timed": '<time_interval within="2" time_unit="s" />'}
WINDOW = '<time_interval after="1" within="2500" time_unit="ms" />'
Key = tuple[str, Pattern, ScopeKind, str]
KEYS: tuple[Key, ...] = (*itertools.product(("states", "events"), Pattern, ScopeKind, TIMES),)


def is_convertible(key: Key) -> bool:
    kind, pattern, scope, time = key
    if pattern is Pattern.RECURRENCE:
        return False
    if time:
        bounded = {
            Pattern.RESPONSE: (ScopeKind.GLOBALLY, ScopeKind.AFTER),
            Pattern.UNIVERSALITY: (ScopeKind.AFTER,),
            Pattern.ABSENCE: (ScopeKind.AFTER,),
            Pattern.EXISTENCE: (ScopeKind.AFTER,),
        }
        return kind == "states" and scope in bounded.get(pattern, ())
    if scope.has_until:
        return kind == "states" and pattern in (Pattern.UNIVERSALITY, Pattern.ABSENCE, Pattern.RESPONSE)
    return kind == "states" or (scope is not ScopeKind.AFTER and pattern is not Pattern.RESPONSE)


def name_of(key: Key) -> str:
    kind, pattern, scope, time = key
    return "_".join(filter(None, (kind, pattern.value, scope.value.replace("-", "_"), time)))


def in_xml(key: Key) -> str:
    kind, pattern, scope, time = key
    conditions = dict(STATES if kind == "states" else EVENTS)
    if pattern is Pattern.UNIVERSALITY:
        conditions[LEFT] = f"!({conditions[RIGHT]})"
    events = "".join(f"<event>{escape(conditions[side])}</event>" for side in (LEFT, RIGHT)[: 1 + pattern.is_binary])
    attributes = f" event={quoteattr(conditions[OPEN])}" if scope.has_event else ""
    attributes += f" until={quoteattr(conditions[CLOSE])}" if scope.has_until else ""
    head = f'<property id="{name_of(key)}" pattern="{pattern.value}" expect="&gt;= 0.25">'
    body = f"<events>{events}</events>" if pattern.is_binary else events
    interval = WINDOW if time and pattern is not Pattern.RECURRENCE else TIMES[time]
    return f'{head}{body}<scope type="{scope.value}"{attributes} />{interval}</property>'


def opened(texts: Mapping[str, str]) -> Workspace:
    workspace = Workspace((FOLDER,), Settings())
    for name, text in texts.items():
        workspace.open(os.path.join(FOLDER, name), text)
    return workspace


def offered(snapshot: Snapshot, path: str, name: str) -> list[CodeAction]:
    source = snapshot.analysis.source(path)
    assert source is not None
    at = source.text.index(f'"{name}"')
    chosen = actions(snapshot, path, Span(at, at), lambda kind: kind == REWRITE)
    return [action for action in chosen if action.title in (TO_XML, TO_JANI)]


def answers(texts: Mapping[str, str]) -> dict[str, object]:
    results = api.verify(
        loaded(texts), None, Options(method=EstimationMethod.FIXED, max_traces=200, seed=11), only_uniform=True
    )
    answered = {}
    for result in results:
        if result.answer is not None and result.name != "stuck":
            tally = result.answer.tally
            answered[result.name] = (tally.traces, tally.successes, tally.undecided, result.answer.bounds)
    return answered


def converted_all(texts: Mapping[str, str], path: str, names: list[str]) -> dict[str, str]:
    """The files after the conversion of properties, one after the other."""
    workspace, result = opened(texts), dict(texts)
    for name in names:
        snapshot = workspace.snapshot()
        (action,) = offered(snapshot, path, name)
        for changed, text in applied(snapshot, action.make()).items():
            workspace.open(changed, text)
            result[os.path.basename(changed)] = text
    return result


def test_every_property_has_the_same_answer_in_both_formats() -> None:
    keys = [key for key in KEYS if is_convertible(key)]
    names = [name_of(key) for key in keys]
    texts = system("\n".join(map(in_xml, keys)), [])
    expected = answers(texts)
    assert set(expected) == set(names)
    jani = converted_all(texts, PROPERTIES, names)
    assert [p["name"] for p in json.loads(jani["twins.jani"])["properties"]] == names
    assert "<ros_topic" not in jani["properties.xml"]
    assert answers(jani) == expected
    xml = converted_all(jani, TWINS, names)
    assert json.loads(xml["twins.jani"]) == {"properties": []}
    assert xml["properties.xml"].count('expect="&gt;= 0.25"') == len(names)
    assert answers(xml) == expected
    successes = [value[1] for value in expected.values()]  # type: ignore[index]
    assert sum(0 < count < 200 for count in successes) > len(names) / 2


def test_other_properties_are_not_offered() -> None:
    keys = [key for key in KEYS if not is_convertible(key) and (key[1] is not Pattern.RECURRENCE or key[3])]
    snapshot = opened(system("\n".join(map(in_xml, keys)), [])).snapshot()
    assert [name for name in map(name_of, keys) if offered(snapshot, PROPERTIES, name)] == []


OTHER_FORMULAS = {
    "next": op("X", TAILS),
    "lasting": op("F", op("G", TAILS)),
    "steps": {**op("F", TAILS), "step-bounds": {"upper": 3}},
    "two events": op("F", op("∧", HEADS, TAILS)),
    "flag at each time": op("G", op("⇒", TAILS, op("F", op("=", COUNT, 2)))),
    "two properties": op("∧", op("G", op("¬", TAILS)), op("F", HEADS)),
    "once after each": op(
        "G",
        op(
            "⇒",
            op("∧", op("=", COUNT, 1), op("≠", COUNT, 3)),
            op("U", op("≠", COUNT, 3), op("∧", TAILS, op("≠", COUNT, 3))),
        ),
    ),
}


@pytest.mark.parametrize("name", OTHER_FORMULAS)
def test_other_formulas_are_not_offered(name: str) -> None:
    assert not offered(opened(system("", [hand_written(name, OTHER_FORMULAS[name])])).snapshot(), TWINS, name)


def test_a_maximum_is_not_offered() -> None:
    greatest = hand_written("p", op("F", TAILS))
    assert offered(opened(system("", [greatest])).snapshot(), TWINS, "p")
    text = json.dumps(greatest).replace("Pmin", "Pmax")
    assert not offered(opened(system("", [json.loads(text)])).snapshot(), TWINS, "p")


def test_files_are_created_and_listed() -> None:
    texts = {**system("", [hand_written("p", op("F", op("∧", TAILS, op("¬", HEADS))))])}
    main = texts["main.xml"].replace('<input type="xml" src="properties.xml" />', "")
    assert main != texts["main.xml"]
    texts = {**texts, "main.xml": main, "twins.jani": json.dumps({"properties": [hand_written("p", op("F", TAILS))]})}
    del texts["properties.xml"]
    changed = converted_all(texts, TWINS, ["p"])
    assert 'src="properties.xml"' in changed["main.xml"]
    assert (
        changed["properties.xml"]
        == """\
<properties>
    <ports>
        <ros_topic topic_name="/tails" type="std_msgs/Empty" event="publish">
            <event_var id="tails" />
        </ros_topic>
    </ports>
    <guarantees>
        <property id="p" pattern="existence">
            <event>tails</event>
            <scope type="globally" />
        </property>
    </guarantees>
</properties>
"""
    )
    assert answers(changed) == answers(texts) != {}


def test_assumptions_prevent_the_conversion() -> None:
    key = KEYS[0]
    assert is_convertible(key)
    texts = system(in_xml(key), [hand_written("p", op("F", TAILS))])
    assumed = in_xml(KEYS[2]).replace(' expect="&gt;= 0.25"', "")
    text = texts["properties.xml"].replace("<guarantees>", f"<assumes>{assumed}</assumes><guarantees>")
    assert text != texts["properties.xml"]
    texts = {**texts, "properties.xml": text}
    assert not offered(opened(texts).snapshot(), PROPERTIES, name_of(key))
    changed = converted_all(texts, TWINS, ["p"])
    assert "/tails" in changed["properties_2.xml"]
    assert PORTS in text
