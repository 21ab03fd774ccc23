# SPDX-License-Identifier: Apache-2.0
"""What the stage of a client shows: where a run begins, the moments that are played, curves, marks and properties."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from dap_client import Client

ROOT = Path(__file__).resolve().parents[2]
BUG = ROOT / "examples" / "assembly_robot" / "main_with_bug.xml"
DELIVERY = ROOT / "examples" / "delivery_robot" / "main.xml"


@pytest.fixture
def client() -> Iterator[Client]:
    with Client() as client:
        yield client


@pytest.mark.parametrize("path", [BUG, DELIVERY], ids=lambda path: path.parent.name)
def test_a_run_begins_where_the_robot_begins(client: Client, path: Path) -> None:
    client.begin(path, seed=3)
    choices = client.ask("choices")
    assert choices["step"] > 0
    (following,) = (choice for choice in choices["choices"] if choice["isNext"])
    assert not following["isOfTranslation"]
    # Backwards, the steps of the translation are there.
    client.ask("goToStep", step=0)
    client.event("stopped")
    first = client.ask("choices")["choices"]
    assert {choice["text"] for choice in first if choice["isOfTranslation"]} >= {"clock starts"}
    client.ask("restart")
    client.event("stopped")
    assert client.step() == choices["step"]


def test_moments_are_the_states_that_the_run_stops_in(client: Client) -> None:
    client.begin(BUG, seed=3)
    before = client.step()
    moments = client.ask("moments", axis="steps", count=15, **{"from": 35})["moments"]
    assert [moment["step"] for moment in moments] == list(range(35, 50))
    assert client.step() == before
    for moment in moments[::7]:
        client.ask("goToStep", step=moment["step"])
        client.event("stopped")
        assert {key: moment[key] for key in ("nodes", "edges", "verdicts")} == client.ask("pictures")


def test_moments_in_time_are_the_last_steps_up_to_each_time(client: Client) -> None:
    client.begin(BUG, seed=3)
    moments = client.ask("moments", axis="time", by=0.5, count=50, **{"from": 1.0})["moments"]
    times = [moment["time"] for moment in moments]
    assert times == sorted(times) == [moment["position"] for moment in moments]
    # In the same instant, only states in which a property is decided are added.
    assert len(set(times[:-1])) == len(times) - 1
    assert [moment["isEnd"] for moment in moments] == [False] * (len(moments) - 1) + [True]
    for moment in moments[:2]:
        assert (
            client.ask("moments", axis="steps", **{"from": moment["step"] + 1})["moments"][0]["time"] > moment["time"]
        )
    for wrong in ({"count": 0}, {"count": 100_000}, {"by": 0}, {"from": -1}):
        assert client.refusal("moments", **wrong)


def test_the_moment_in_which_a_property_is_decided_is_not_left_out(client: Client) -> None:
    client.begin(BUG, property="never_placed_empty", against=1)
    end = client.step()

    def failed(start: int, by: int, **given: int) -> int:
        moments = client.ask("moments", axis="steps", by=by, count=200, **{"from": start, **given})["moments"]
        steps = [moment["step"] for moment in moments]
        assert steps == sorted(set(steps))
        return next(m["step"] for m in moments if m["verdicts"]["never_placed_empty"] == "failed")

    violated = failed(end - 100, 1)
    assert failed(end - 100, 7) == violated
    assert failed(violated + 2, 5, after=violated - 3) == violated, "between the state before and the first one"


def test_moments_end_where_breakpoints_stop_the_run(client: Client) -> None:
    client.begin(BUG, seed=3)
    client.ask("setFunctionBreakpoints", breakpoints=[{"name": "/arm/command"}])
    stops: list[int] = []
    step = client.step()
    while len(stops) < 3:
        moments = client.ask("moments", axis="steps", by=3.5, count=40, **{"from": step + 3.5}, after=step)["moments"]
        assert all(moment["stop"] is None for moment in moments[:-1])
        step = moments[-1]["step"]
        if moments[-1]["stop"] is not None:
            stops.append(step)
    reached = []
    for _ in stops:
        client.move()
        reached.append(client.step())
    assert stops == reached, "playing and continuing stop in the same states"


def test_curves_are_drawn_over_each_other(client: Client) -> None:
    client.begin(BUG, seed=3)
    client.ask("goToStep", step=300)
    client.event("stopped")
    apart = client.ask("timeline", width=800, names=True)
    assert {"Arm.way", "/arm/command.data", "/arm/gripper.data"} <= set(apart["plots"])
    over = client.ask("timeline", width=800, names=True, curves=["Arm.way", "/arm/command.data"])
    assert over["names"].count('class="curve') == 2
    assert over["scene"].count('class="plot') == apart["scene"].count('class="plot')
    assert over["plots"] == apart["plots"]


def test_a_violation_is_marked_and_said(client: Client) -> None:
    client.begin(BUG, property="never_placed_empty", against=1, stopOnEntry=True)
    assert "mark-card" not in client.ask("timeline")["scene"]
    client.ask("goToStep", step=100_000)
    client.event("stopped")
    shown = client.ask("timeline", width=800)
    assert "violated: never_placed_empty" in shown["scene"]
    properties = {property_["name"]: property_ for property_ in client.ask("properties")["properties"]}
    failed = properties["never_placed_empty"]
    assert failed["verdict"] == "failed"
    assert failed["line"] > 1
    assert failed["source"]["name"].endswith((".xml", ".jani", ".scxml"))
    # It is marked where it is decided, also when the run has gone back.
    client.ask("goToStep", step=20)
    client.event("stopped")
    assert "violated: never_placed_empty" in client.ask("timeline", width=800)["scene"]
    assert client.ask("properties")["properties"] != list(properties.values())


def test_properties_are_sentences_as_in_the_editor(client: Client) -> None:
    client.begin(DELIVERY, stopOnEntry=True)
    properties = {property_["name"]: property_["text"] for property_ in client.ask("properties")["properties"]}
    assert properties["never_delivers_when_empty"] == "hands_over && battery <= 10 never holds."


def test_lanes_have_the_nodes_of_pictures(client: Client) -> None:
    client.begin(BUG, seed=3)
    timeline = client.ask("timeline", axis="steps", width=800, names=True)
    nodes = client.ask("pictures")["nodes"]
    assert all(word in timeline["legend"] for word in ("IDLE", "states, in order of entry"))
    assert timeline["legendHeight"] >= 20
    lanes = timeline["lanes"]
    assert any(lane[0].endswith("arm.ascxml#") for lane in lanes)
    for node in nodes:
        if node["kind"] in ("tree", "system"):
            shown = [lane for lane in lanes if any(_belongs(node["node"], one) for one in lane)]
            assert len(shown) == 1, node


def _belongs(node: str, lane: str) -> bool:
    return node.startswith(lane) if lane.endswith("#") else node == lane
