# SPDX-License-Identifier: Apache-2.0
"""Channels: they lose, delay and drop messages as defined; the expanded files mean the same."""

from __future__ import annotations

import json
import math
import re
import shlex
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.diagnostics import Severity
from roaml.ide.completion import complete
from roaml.ide.rename import Renaming, rename
from roaml.jani.writer import write
from roaml.text import apply_edits

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "spec" / "channels.md").read_text(encoding="utf-8")
EXPERIMENTS = (DOCS / "experiments.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"^\*\*`(\S+)`\*\*\n\n```xml\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL))
"""The files of the example in the definition."""
CHANNEL = '<channel topic="level" loss="loss" delay="200 ms" step="100 ms" />'


@pytest.fixture
def main(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / "main.xml"


def with_channel(main: Path, channel: str) -> Path:
    text = main.read_text()
    assert CHANNEL in text
    main.write_text(text.replace(CHANNEL, channel))
    return main


def value(main: Path, name: str, **parameters: float) -> float:
    system = api.load(str(main), parameters=parameters)
    options = api.Options(max_traces=100)
    (result,) = api.verify(system, [name], options, exact_if_small=True)
    assert result.exact is not None
    assert result.exact.minimum.lower == pytest.approx(result.exact.maximum.upper, abs=1e-9)
    return result.exact.minimum.lower


def jani(main: Path) -> str:
    return "".join(write(api.to_jani(api.load(str(main)))))


def messages(main: Path) -> list[str]:
    found = api.check([str(main)]).diagnostics
    return [d.message for d in found if d.code == "invalid-channel"]


@pytest.mark.parametrize("loss", [0, 0.1, 0.5, 1])
def test_loss(main: Path, loss: float) -> None:
    """Of three messages, one must arrive."""
    assert value(main, "notices", loss=loss) == pytest.approx(1 - loss**3, abs=1e-12)
    assert value(main, "in_time", loss=loss) == pytest.approx(1 - loss, abs=1e-12)


def phi(x: float) -> float:
    return math.erfc(-x / math.sqrt(2)) / 2


@pytest.mark.parametrize(
    ("delay", "in_time"),
    [
        ("300 ms", 0.0),
        ("200 ms", 1.0),
        ("150 ms", 1.0),  # rounded up to 200 ms
        ("categorical(100 ms, 0.25, 300 ms, 0.75)", 0.25),
        ("uniform(0 ms, 500 ms)", 0.4),
        ("normal(200 ms, 50 ms)", phi(0)),
        ("normal(150 ms, 50 ms)", phi(1)),
        ("exponential(100 ms)", -math.expm1(-2)),
        ("bernoulli(0.3) * 300 ms", 0.7),
        ("binomial(3, 0.5) * 100 ms", 7 / 8),
        ("geometric(1 - loss) * 100 ms", 0.9 + 0.1 * 0.9),
        ("poisson(1.5) * 100 ms", 3.625 * math.exp(-1.5)),
        ("uniform_int(1, 5) * 100 ms", 0.4),
        ("uniform_int(1, 5) * 1000 * loss ms", 0.4),
    ],
)
def test_delay(main: Path, delay: str, in_time: float) -> None:
    with_channel(main, f'<channel topic="level" delay="{delay}" step="100 ms" />')
    # With a probability of exp(-12), an exponential delay is above 1.2 s, so that the next message waits.
    assert value(main, "in_time") == pytest.approx(in_time, abs=1e-5)
    options = api.Options(method=api.EstimationMethod.FIXED, max_traces=1000, confidence=0.99999)
    (sampled,) = api.verify(api.load(str(main)), ["in_time"], options, only_uniform=True)
    assert sampled.answer is not None
    assert sampled.answer.bounds.lower - 1e-9 <= in_time <= sampled.answer.bounds.upper + 1e-9


@pytest.mark.parametrize(("unit", "step"), [("ms", ""), ("s", ' step="100 ms"')])
def test_a_delay_is_drawn_from_data(main: Path, unit: str, step: str) -> None:
    """One of four messages takes 100 ms, three take 250 ms, which end after 300 ms."""
    rows = {"ms": "delay,count\n100,1\n250,3\n", "s": "0.1\n0.25\n0.25\n0.25\n"}[unit]
    (main.parent / "late.csv").write_text(rows, encoding="utf-8")
    delay = f"histogram('late.csv', {unit})"
    with_channel(main, f'<channel topic="level" delay="{delay}"{step} />')
    assert messages(main) == []
    assert value(main, "in_time") == pytest.approx(0.25, abs=1e-12)
    # The data are read again when they change.
    (main.parent / "late.csv").write_text(rows.replace("0.25", "0.1").replace("250", "150"), encoding="utf-8")
    assert value(main, "in_time") == pytest.approx(1, abs=1e-12)


def test_loss_and_delay_are_independent(main: Path) -> None:
    with_channel(main, '<channel topic="level" loss="loss" delay="categorical(100 ms, 0.25, 300 ms, 0.75)" />')
    assert value(main, "in_time", loss=0.2) == pytest.approx(0.8 * 0.25, abs=1e-12)


def test_messages_arrive_in_their_order(main: Path) -> None:
    """The level 2 is sent 1 s after the level 3, whose delay it waits for."""
    with_channel(main, '<channel topic="level" delay="categorical(0 s, 0.5, 1500 ms, 0.5)" step="100 ms" />')
    # In time if neither it nor the message before it is late; a message of 2 s before has arrived.
    assert value(main, "in_time") == pytest.approx(0.25, abs=1e-12)


@pytest.mark.parametrize(("depth", "arrives"), [(1, 0.0), (2, 1.0), (3, 1.0)])
def test_a_full_queue_drops_its_oldest_message(main: Path, depth: int, arrives: float) -> None:
    """A message is on its way for 1.5 s, and the next one follows after 1 s. The last one is never dropped."""
    with_channel(main, f'<channel topic="level" delay="1500 ms" step="100 ms" depth="{depth}" />')
    text = (main.parent / "properties.xml").read_text()
    (main.parent / "properties.xml").write_text(
        text.replace("received &lt;= 2", "received == 2").replace('within="200"', 'within="1500"')
    )
    assert value(main, "in_time") == arrives
    assert value(main, "notices") == arrives


def test_the_expanded_files_have_the_same_translation(main: Path, tmp_path: Path) -> None:
    plain = tmp_path / "plain"
    assert run(["translate", str(main), "--expand", str(plain), "-o", str(tmp_path / "x.jani")]) == 0
    assert "channel_level_to_Monitor.ascxml" in {path.name for path in plain.iterdir()}
    assert "<channel" not in (plain / "main.xml").read_text()
    assert not [d for d in api.check([str(plain / "main.xml")]).diagnostics if d.severity is Severity.ERROR]
    assert jani(plain / "main.xml") == jani(main)


def test_a_service_is_delayed_both_ways(tmp_path: Path) -> None:
    """Request and response take 100 ms or 200 ms, each with the probability 0.5."""
    files = {
        "main.xml": """<roaml>
    <channels><channel service="/add" delay="categorical(100 ms, 0.5, 200 ms, 0.5)" /></channels>
    <parameters><max_time value="3" unit="s" reaction_time="instant" /></parameters>
    <node_models>
        <input type="node-ascxml" src="adder.ascxml" />
        <input type="node-ascxml" src="counter.ascxml" />
    </node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>""",
        "adder.ascxml": """<ascxml name="Adder" version="1.0" initial="serve">
    <datamodel><data id="sum" type="int64" expr="0" /></datamodel>
    <ros_service_server service_name="/add" type="example_interfaces/AddTwoInts" />
    <state id="serve">
        <ros_service_handle_request name="/add" target="serve">
            <assign location="sum" expr="_req.a + _req.b" />
            <ros_service_send_response name="/add"><field name="sum" expr="sum" /></ros_service_send_response>
        </ros_service_handle_request>
    </state>
</ascxml>""",
        "counter.ascxml": """<ascxml name="Counter" version="1.0" initial="ask">
    <datamodel><data id="count" type="int64" expr="0" /></datamodel>
    <ros_service_client name="add" service_name="/add" type="example_interfaces/AddTwoInts" />
    <ros_topic_publisher name="count" topic="/count" type="std_msgs/Int64" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="ask">
        <ros_rate_callback name="second" target="wait">
            <ros_service_send_request name="add">
                <field name="a" expr="count" /><field name="b" expr="1" />
            </ros_service_send_request>
        </ros_rate_callback>
    </state>
    <state id="wait">
        <ros_service_handle_response name="add" target="ask">
            <assign location="count" expr="_res.sum" />
            <ros_topic_publish name="count"><field name="data" expr="count" /></ros_topic_publish>
        </ros_service_handle_response>
    </state>
</ascxml>""",
        "properties.xml": """<properties>
    <ports>
        <ros_topic topic_name="/count" type="std_msgs/Int64" event="publish">
            <state_var id="count" type="int64" field="data" expr="0" />
        </ros_topic>
    </ports>
    <guarantees>"""
        + "".join(
            f"""
        <property id="by_{time}" pattern="existence">
            <event>count == 1</event><scope type="globally" /><time_interval within="{time}" time_unit="ms" />
        </property>"""
            for time in (1100, 1200, 1300, 1400)
        )
        + "\n    </guarantees>\n</properties>",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    values = [value(tmp_path / "main.xml", f"by_{time}") for time in (1100, 1200, 1300, 1400)]
    assert values == pytest.approx([0, 0.25, 0.75, 1], abs=1e-12)


@pytest.mark.parametrize(
    ("channel", "reason"),
    [
        ('<channel topic="levle" />', "no machine of this system publishes or subscribes to the topic `levle`"),
        ('<channel topic="clock" />', "no machine of this system publishes"),
        ("<channel />", "either a `topic` or a `service`"),
        ('<channel topic="level" service="level" />', "either a `topic` or a `service`"),
        ('<channel topic="level" /><channel topic="/level" />', "has two channels"),
        ('<channel topic="level" loss="1.5" />', "is not a probability from 0 to 1"),
        ('<channel topic="level" loss="-loss" />', "is not a probability from 0 to 1"),
        ('<channel topic="level" loss="high" />', "is not a probability from 0 to 1"),
        ('<channel topic="level" depth="0" />', "an integer from 1 to 100"),
        ('<channel topic="level" depth="2.5" />', "an integer from 1 to 100"),
        ('<channel topic="level" reliability="reliabel" />', "did you mean `reliable`?"),
        ('<channel topic="level" reliability="reliable" loss="0.1" />', "a reliable channel loses no messages"),
        ('<channel topic="level" delay="soon" />', "`soon` in `delay` is not a duration"),
        ('<channel topic="level" delay="20" />', "`20` in `delay` is not a duration"),
        ('<channel topic="level" delay="poisson(2 ms)" />', "is not a number without a unit"),
        ('<channel topic="level" delay="poisson(2)" />', "multiply it by a duration"),
        ('<channel topic="level" delay="poison(2)" />', "did you mean `poisson`?"),
        ('<channel topic="level" delay="normal(20 ms, 5 ms)" />', "add the step"),
        (
            '<channel topic="level" delay="histogram(\'late.csv\', ms)" />',
            "there is no file `late.csv` that can be read",
        ),
        ('<channel topic="level" delay="histogram(\'late.csv\')" />', "the unit of its values"),
        ('<channel topic="level" delay="20 ms" step="0 ms" />', "is not a step"),
        ('<channel topic="level" step="5 ms" />', "`step` has an effect only on a `delay`"),
        ('<channel topic="level" delay="normal(1 min, 1 min)" step="1 ms" />', "use a greater `step`"),
        ('<channel service="level" loss="0.1" />', "the channel of a service has no `loss`"),
        ('<channel service="level" />', "no machine of this system declares the service `level`"),
    ],
)
def test_invalid_channels(main: Path, channel: str, reason: str) -> None:
    (message,) = messages(with_channel(main, channel))
    assert reason in message


def test_machines_with_different_types_have_no_channel(main: Path) -> None:
    monitor = main.parent / "monitor.ascxml"
    monitor.write_text(monitor.read_text().replace("std_msgs/UInt8", "std_msgs/UInt16"))
    assert ["different types" in message for message in messages(main)] == [True]


def test_times_use_parameters(main: Path) -> None:
    with_channel(main, '<channel topic="level" delay="normal(loss * 2000 ms, $(var loss) s)" step="100 ms" />')
    assert value(main, "in_time", loss=0.05) == pytest.approx(phi(2), abs=1e-5)
    assert not [d for d in api.check([str(main)]).diagnostics if d.code == "unused-parameter"]


def test_a_topic_is_renamed_with_its_channel(main: Path) -> None:
    snapshot, text = api.check([str(main)]).snapshot, main.read_text()
    renaming = rename(snapshot.analysis, str(main), text.index('"level"') + 2, "charge")
    assert isinstance(renaming, Renaming)
    assert 'topic="charge"' in apply_edits(text, renaming.edits[str(main)])
    assert str(main.parent / "monitor.ascxml") in renaming.edits


RECEIVED = {
    "op": "F",
    "exp": {"op": "∧", "left": "topic_level__to_Monitor_msg.valid", "right": "topic_level_msg.valid"},
}


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("main.xml", '"level', "charge"),
        ("battery.ascxml", 'topic="level', "charge"),
        ("monitor.ascxml", 'name="Monitor', "Watcher"),
        ("main.xml", 'name="Monitor', "Watcher"),
        ("properties.xml", "level/to_Monitor", "Watcher"),
        ("properties.xml", "level/", "/robot/charge"),
        ("p.jani", "level__to_Monitor", "Watcher"),
        ("p.jani", "topic_level_", "/robot/charge"),
    ],
)
def test_names_of_a_channel_are_renamed_in_properties(file: str, old: str, new: str, main: Path) -> None:
    """`T/to_R` contains the names of the topic and of the machine, which can be an instance."""
    values = {"op": "filter", "fun": "values", "values": {"op": "Pmin", "exp": RECEIVED}, "states": {"op": "initial"}}
    properties = {"properties": [{"name": "q", "expression": values}]}
    (main.parent / "p.jani").write_text(json.dumps(properties, ensure_ascii=False), encoding="utf-8")
    text = main.read_text().replace('"properties.xml" />', '"properties.xml" /><input type="jani" src="p.jani" />')
    if (file, old) == ("main.xml", 'name="Monitor'):
        text = text.replace('src="monitor.ascxml"', 'src="monitor.ascxml" name="Monitor"')
    main.write_text(text)
    before = jani(main)
    path = main.parent / file
    analysis = api.check([str(main)]).snapshot.analysis
    renaming = rename(analysis, str(path), path.read_text(encoding="utf-8").index(old) + len(old) - 1, new)
    assert isinstance(renaming, Renaming), renaming
    assert {"p.jani", "properties.xml"} <= {Path(changed).name for changed in renaming.edits}
    for changed, edits in renaming.edits.items():
        Path(changed).write_text(apply_edits(Path(changed).read_text("utf-8"), tuple(edits)), "utf-8")
    assert [d.message for d in api.check([str(main)]).diagnostics if d.severity >= Severity.WARNING] == []
    assert jani(main).count(new.strip("/").replace("/", "__")) >= 5
    assert len(json.loads(jani(main))["automata"]) == len(json.loads(before)["automata"])


def test_topics_are_completed(main: Path) -> None:
    with_channel(main, '<channel topic="" />')
    snapshot, text = api.check([str(main)]).snapshot, main.read_text()
    found = complete(snapshot, str(main), text.index('topic=""') + 7)
    assert found is not None
    assert "level" in {item.label for item in found.items}


def test_the_steps_of_a_channel_are_at_its_declaration(main: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["simulate", str(main), "--set", "loss=0"]) == 0
    assert re.search(r"channel_level_to_Monitor\s+receives /?level .*main\.xml:6", capsys.readouterr().out)


def test_losses_share_the_explored_states(main: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The derivative exists only if only probabilities depend on the parameter."""
    assert run(["experiment", str(main), "--set", "loss=0.1,0.2", "--property", "notices", "--slopes"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"0\.1  0\.999, d/d\w+ -0\.03", out), out


def test_the_page_about_experiments(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "radio"
    folder.mkdir()
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    ((command, printed),) = re.findall(
        r"^\$ as2fm-lsp (experiment radio.*)\n((?:.*\n)*?)```", EXPERIMENTS, re.MULTILINE
    )
    assert run([*shlex.split(command), "--jobs", "1"]) == 0
    assert capsys.readouterr().out == printed
