# SPDX-License-Identifier: Apache-2.0
"""The reaction time of systems and files, and what results say about it. The values are computed by hand."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from storm import exact as storm_exact

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.durations import ANY_TIME, AT_ONCE, ReactionTime, reaction_time
from roaml.model.parameters import Overrides
from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.goal import Question
from roaml.smc.statistics import Bounds
from roaml.verification.headline import claim_for_all
from roaml.verification.reactions import with_reactions
from roaml.verification.results import Exact

LAMP = """\
<ascxml name="Lamp" version="1.0" initial="off">
    <ros_time_rate name="blink" rate_hz="1" />
    <ros_topic_publisher name="light" topic="/light" type="std_msgs/Bool" />
    <state id="off">
        <ros_rate_callback name="blink" target="on">
            <ros_topic_publish name="light"><field name="data" expr="true" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
    <state id="on" />
</ascxml>
"""
COUNTER = """\
<ascxml name="Counter" version="1.0" initial="wait">
    <datamodel><data id="n" type="int16" expr="0" /></datamodel>
    <ros_topic_subscriber name="light" topic="/light" type="std_msgs/Bool" />
    <state id="wait">
        <ros_topic_callback name="light" target="wait">
            <assign location="n" expr="n + 1" />
            <send event="counted"><param name="n" expr="n" /></send>
        </ros_topic_callback>
    </state>
</ascxml>
"""
IDLER = """\
<ascxml name="Idler" version="1.0" initial="a">
    <state id="a"><transition target="b" /></state>
    <state id="b"><transition target="a" /></state>
</ascxml>
"""
SECOND = {"op": "=", "left": "topic_clock_msg__ros_fields__sec", "right": 4}
COUNTED = {"op": "=", "left": "counted__n", "right": 1}


def written(folder: Path, *machines: str, time: str = "", limit: int = 5, setting: str = "") -> str:
    """The path of a system with these machines, whose property `seen` is that a light is counted before 4 s."""
    inputs = ""
    for number, machine in enumerate(machines):
        (folder / f"m{number}.ascxml").write_text(machine)
        inputs += f'<input type="node-ascxml" src="m{number}.ascxml" />'
    attribute = f' reaction_time="{time}"' if time else ""
    (folder / "main.xml").write_text(
        f'<roaml><parameters><max_time value="{limit}" unit="s"{attribute} /></parameters>'
        f"<node_models>{inputs}</node_models>"
        '<properties><input type="jani" src="properties.jani" /></properties></roaml>'
    )
    path = {"op": "U", "left": {"op": "¬", "exp": SECOND}, "right": COUNTED}
    values = {"op": "Pmin", "exp": path}
    formula = {"op": "filter", "fun": "values", "values": values, "states": {"op": "initial"}}
    (folder / "properties.jani").write_text(json.dumps({"properties": [{"name": "seen", "expression": formula}]}))
    if setting:
        (folder / "as2fm.toml").write_text(f'reaction-time = "{setting}"\n')
    return str(folder / "main.xml")


def assumed(path: str, option: ReactionTime | None = None) -> ReactionTime:
    model = api.to_jani(api.load(path, overrides=Overrides(reaction_time=option)))
    assert model.metadata is not None
    return model.metadata.reaction_time


def test_precedence(tmp_path: Path) -> None:
    """The option, then the system file, then the configuration, then `any`."""
    for name in ("none", "setting", "file"):
        (tmp_path / name).mkdir()
    assert assumed(written(tmp_path / "none", LAMP, COUNTER)) == ANY_TIME
    assert assumed(written(tmp_path / "setting", LAMP, COUNTER, setting="instant")) == AT_ONCE
    path = written(tmp_path / "file", LAMP, COUNTER, time="20 ms", setting="instant")
    assert assumed(path) == reaction_time("20 ms")
    assert assumed(path, ANY_TIME) == ANY_TIME


@pytest.mark.parametrize(("time", "least"), [("any", 0), ("4 s", 0), ("1 s", 1), ("instant", 1)])
def test_values_by_hand(tmp_path: Path, time: str, least: float) -> None:
    """The light is sent within the reaction time after 1 s, and counted within the reaction time after that."""
    path = written(tmp_path, LAMP, COUNTER)
    model = api.to_jani(api.load(path, overrides=Overrides(reaction_time=reaction_time(time))))
    limits = api.StateLimits()
    verifier = api.verifier(model)
    (property_,) = verifier.checker.compiled_properties
    exact = verifier.exhaustive(property_, limits).exact
    assert exact is not None
    assert (exact.least, exact.greatest) == (least, 1)
    assert storm_exact(model, "seen")[:2] == pytest.approx((least, 1))


def test_a_written_file_is_verified_in_the_same_way(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, LAMP, COUNTER)
    for time in ("instant", "1 s"):
        file = str(tmp_path / f"{time[0]}.jani")
        assert run(["translate", path, "-o", file, "--reaction-time", time]) == 0
        capsys.readouterr()
        assert run(["verify", file, "--exhaustive"]) == 0
        assert "seen: = 1 for all schedulers" in capsys.readouterr().out
        assert run(["verify", file, "--reaction-time", "any"]) == 2
        assert f"assumes the reaction time `{time}`" in capsys.readouterr().err
    file = str(tmp_path / "any.jani")
    assert run(["translate", path, "-o", file]) == 0
    assert run(["verify", file, "--exhaustive", "--reaction-time", "instant"]) == 0
    shown = capsys.readouterr().out
    assert "seen: = 1 for all schedulers" in shown
    assert "machines take possible steps at once" in shown


def test_a_file_without_a_clock_has_no_reaction_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "model.jani"
    assert run(["translate", written(tmp_path, LAMP, COUNTER), "-o", str(file)]) == 0
    model = json.loads(file.read_text())
    del model["metadata"]["clock"]
    file.write_text(json.dumps(model))
    assert run(["verify", str(file), "--reaction-time", "instant"]) == 2
    assert "name no clock" in capsys.readouterr().err


def test_open_extremes_are_shown_for_instant_reactions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, LAMP, COUNTER)
    for options in ((), ("--exhaustive",)):
        assert run(["verify", path, *options]) == 0
        shown = capsys.readouterr().out
        assert "seen: minimum 0, maximum 1" in shown
        assert "if machines react at once: = 1 for all schedulers, exact" in shown
        assert "the property does not hold, for example, if `Counter` is delayed from" in shown
    assert run(["verify", path, "--exhaustive", "--format", "json"]) == 0
    (result,) = json.loads(capsys.readouterr().out)["results"]
    (conditional,) = result["conditional"]
    assert conditional["assumption"] == "if machines react at once"
    assert conditional["exact"]["least"] == 1
    for format_ in ("markdown", "csv"):
        assert run(["verify", path, "--exhaustive", "--format", format_]) == 0
        assert "if machines react at once: = 1 for all schedulers, exact" in capsys.readouterr().out


def test_values_for_instant_reactions_bound_those_of_all_schedulers() -> None:
    """Machines that react at once follow some of all schedulers."""
    uniform = Extreme(1.0, Bounds(0.98, 1.0), ExtremeMethod.UNIFORM)
    instant = Exact(Bounds(0.9, 0.9), Bounds(0.99, 0.99), None, 20)
    known = with_reactions(Choices("", uniform, uniform), instant)
    assert known.minimum == Extreme(0.9, Bounds(0.9, 0.9), ExtremeMethod.REACTIONS)
    assert known.maximum == Extreme(0.99, Bounds(0.99, 0.99), ExtremeMethod.REACTIONS)
    sampled = Extreme(0.5, Bounds(0.4, 0.6), ExtremeMethod.SAMPLING, "sampled scheduler 1", 60)
    assert with_reactions(Choices("", sampled, uniform), instant).minimum == sampled
    nothing = with_reactions(Choices(), Exact(Bounds(1, 1), Bounds(1, 1), None, 20))
    assert claim_for_all(Question("p", "Pmin", False, None, ()), nothing, 0.95) == "minimum undecided"


@pytest.mark.parametrize(
    ("value", "least", "greatest"),
    [
        (0.872, "at most 0.872, no closer bounds", "at least 0.128, no closer bounds"),
        (1 - 2**-20, "at most 0.9999991, no closer bounds", "at least 9e-07, no closer bounds"),
        (1.0, "undecided", "undecided"),
    ],
)
def test_a_bound_is_true_after_rounding(value: float, least: str, greatest: str) -> None:
    known = Extreme(value, Bounds(value, value), ExtremeMethod.REACTIONS)
    question = Question("p", "Pmin", False, None, ())
    assert claim_for_all(question, Choices("", known, None), 0.95) == f"minimum {least}"
    opposite = Extreme(1 - value, Bounds(1 - value, 1 - value), ExtremeMethod.REACTIONS)
    question = Question("p", "Pmax", False, None, ())
    assert claim_for_all(question, Choices("", None, opposite), 0.95) == f"maximum {greatest}"


def test_requested_traces_are_not_extended_by_a_search(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, LAMP, COUNTER)
    assert run(["verify", path, "--method", "fixed", "--max-traces", "50"]) == 0
    shown = capsys.readouterr().out
    assert "under uniform choices" in shown
    assert "if machines react at once" not in shown


@pytest.mark.parametrize("machines", [(LAMP, IDLER), (LAMP, COUNTER, IDLER)])
def test_time_stops(tmp_path: Path, capsys: pytest.CaptureFixture[str], machines: tuple[str, ...]) -> None:
    """A machine that never rests: no light is sent, and all traces repeat for ever."""
    path = written(tmp_path, *machines, COUNTER.replace("Counter", "Other"), time="instant")
    assert run(["verify", path, "--exhaustive"]) == 0
    assert "seen: = 0 for all schedulers" in capsys.readouterr().out
    assert run(["verify", path, "--format", "json", "--method", "fixed", "--max-traces", "20"]) == 0
    (result,) = json.loads(capsys.readouterr().out)["results"]
    assert result["probability"] == 0
    assert result["ends"]["repeats_for_ever"] == 20


def test_a_delay_ends_with_the_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The last step of the clock only ends the time: none passes in it, and other elements can take steps after it."""

    def edge(source: str, guard: dict[str, object] | None, action: str, target: str, **values: object) -> object:
        assignments = [{"ref": name, "value": value} for name, value in values.items()]
        edge: dict[str, object] = {
            "location": source,
            "destinations": [{"location": target, "assignments": assignments}],
        }
        return edge | ({"action": action} if action else {}) | ({"guard": {"exp": guard}} if guard else {})

    def automaton(name: str, *edges: object, locations: str) -> object:
        places = [{"name": location} for location in locations]
        return {"name": name, "locations": places, "initial-locations": [locations[0]], "edges": edges}

    is_early, later = {"op": "<", "left": "now", "right": 2}, {"op": "+", "left": "now", "right": 1}
    never = {"op": "G", "exp": {"op": "¬", "exp": "is_late"}}
    formula = {"op": "filter", "fun": "values", "values": {"op": "Pmin", "exp": never}, "states": {"op": "initial"}}
    flag = {"type": "bool", "initial-value": False}
    model = {
        "jani-version": 1,
        "name": "late",
        "type": "mdp",
        "metadata": {"clock": {"automaton": "clock", "actions": ["tick"], "step": "1 s"}, "reaction-time": "any"},
        "actions": [{"name": "tick"}],
        "variables": [
            {
                "name": "now",
                "type": {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 2},
                "initial-value": 0,
            },
            {"name": "is_over", **flag},
            {"name": "is_late", **flag},
        ],
        "automata": [
            automaton(
                "clock",
                edge("a", is_early, "tick", "a", now=later),
                edge("a", {"op": "¬", "exp": is_early}, "tick", "b", is_over=True),
                locations="ab",
            ),
            automaton("worker", edge("a", None, "", "b", is_late="is_over"), locations="ab"),
        ],
        "system": {
            "elements": [{"automaton": "clock"}, {"automaton": "worker"}],
            "syncs": [{"synchronise": ["tick", None], "result": "tick"}],
        },
        "properties": [{"name": "in_time", "expression": formula}],
    }
    file = tmp_path / "late.jani"
    file.write_text(json.dumps(model))
    assert run(["verify", str(file)]) == 0
    shown = capsys.readouterr().out
    assert "the property does not hold, for example, if `worker` is delayed from 0 s until the end" in shown


EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def test_a_tree_that_has_finished_is_not_stuck(capsys: pytest.CaptureFixture[str]) -> None:
    """The guards of a reaction time let the clock begin a step where the tree waits, and count in variables of their
    own, which no story shows."""
    path = str(EXAMPLES / "assembly_robot" / "main_with_bug.xml")
    sampled = ("--property", "block_placed", "--method", "fixed", "--max-traces", "20")
    assert run(["verify", path, "--reaction-time", "20 ms", *sampled, "--explain"]) == 0
    text = capsys.readouterr().out
    assert "got stuck" not in text
    assert "the tree ends with SUCCESS" in text
    assert "as2fm__" not in text
    assert run(["verify", path, "--reaction-time", "20 ms", *sampled, "--format", "json"]) == 0
    (result,) = json.loads(capsys.readouterr().out)["results"]
    assert result["ends"]["stuck"] == 0
    assert result["ends"]["tree_finished"] == result["failed"] > 0


def test_a_reaction_time_that_is_rounded_up_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The clock of this system has steps of 1 s."""
    path = written(tmp_path, LAMP, COUNTER)
    assert run(["verify", path, "--reaction-time", "20 ms"]) == 0
    text = "assumed: each machine takes a possible step within 20 ms"
    assert f"{text}, rounded up to 1 s, because a step of the clock takes 1 s (reaction" in capsys.readouterr().out
    assert run(["verify", path, "--reaction-time", "2 s"]) == 0
    assert "within 2 s (reaction time)" in capsys.readouterr().out
