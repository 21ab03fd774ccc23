# SPDX-License-Identifier: Apache-2.0
"""Plain SCXML says what each event is for, and the translation to JANI reads that, not the name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
from bt_trees import Setup, Tree, leaf, system, writer
from translating import lowered

from roaml import api
from roaml.durations import ANY_TIME
from roaml.jani.writer import write
from roaml.model.parameters import Overrides
from roaml.record import replace
from roaml.scxml.events import EventRole, ScxmlEvent
from roaml.scxml.model import Body, If, Network, Send, bodies, statements
from roaml.scxml.names import automaton_role, is_synchronising, role_of
from roaml.to_jani import translate

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*/main.xml"))
NETWORKS = ("blackboard", *(path.parent.name for path in EXAMPLES))
Change = Callable[[ScxmlEvent], ScxmlEvent]


@cache
def network_of(name: str) -> Network:
    """That of an example, or of a tree that writes and reads a variable. A reaction time is added to a model in JANI,
    which has only names, and flags of events that are never sent have no event that could be renamed."""
    if name == "blackboard":
        wait = Tree("Repeat", (("num_cycles", "{few}"),), (leaf("S"),))
        return lowered(system(Tree("Sequence", children=(writer("few", 2), wait)), Setup(3)))
    path = next(path for path in EXAMPLES if path.parent.name == name)
    return replace(api.to_scxml(api.load(str(path), overrides=Overrides(reaction_time=ANY_TIME))), flags=())


@pytest.fixture(params=NETWORKS)
def network(request: pytest.FixtureRequest) -> Network:
    return network_of(request.param)


def events(network: Network) -> Iterator[ScxmlEvent]:
    for automaton in network.automata:
        for state in automaton.states:
            yield from (transition.event for transition in state.transitions if transition.event)
        for body in bodies(automaton):
            yield from (statement.event for statement in statements(body) if isinstance(statement, Send))


def test_networks_have_events_of_every_role() -> None:
    assert {event.role for name in NETWORKS for event in events(network_of(name))} == set(EventRole)


def test_role_is_that_of_the_name(network: Network) -> None:
    """Whoever reads names in a trace comes to the same result as the translation."""
    assert {event.name: event.role for event in events(network)} == {e.name: role_of(e.name) for e in events(network)}


def test_role_of_an_automaton_is_that_of_its_name(network: Network) -> None:
    assert all(automaton.role is automaton_role(automaton.name) for automaton in network.automata)


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("level", EventRole.PLAIN),
        ("topic_level_msg", EventRole.PLAIN),
        ("bt_12_tick", EventRole.BLOCKING),
        ("bt_12_halt_response", EventRole.BLOCKING),
        ("bt_x_tick", EventRole.PLAIN),
        ("action_walk_goal_handle", EventRole.BLOCKING),
        ("action_walk_feedback", EventRole.PLAIN),
        ("action_go_to_goal_feedback", EventRole.BLOCKING),
        ("srv_add_response_client_a", EventRole.BLOCKING),
        ("ros_time_rate.clock", EventRole.TIMER_TICK),
        ("global_timer_tick_event", EventRole.CLOCK_STEP),
        ("global_timer_tick_event_2", EventRole.PLAIN),
        ("bt_blackboard_req", EventRole.BLACKBOARD_READ),
        ("bt_blackboard_set_x", EventRole.BLACKBOARD_WRITE),
        ("bt_blackboard_get", EventRole.PLAIN),
    ],
)
def test_role_by_name(name: str, role: EventRole) -> None:
    assert role_of(name) is role
    assert is_synchronising(name) is (role in (EventRole.BLOCKING, EventRole.CLOCK_STEP))


# ------------------------------------------------------------------ other names


def changed(network: Network, change: Change) -> Network:
    """The network with other events."""

    def in_body(body: Body) -> Body:
        done = []
        for statement in body:
            match statement:
                case Send():
                    done.append(replace(statement, event=change(statement.event)))
                case If():
                    branches = tuple(replace(branch, body=in_body(branch.body)) for branch in statement.branches)
                    done.append(replace(statement, branches=branches, otherwise=in_body(statement.otherwise)))
                case _:
                    done.append(statement)
        return tuple(done)

    automata = []
    for automaton in network.automata:
        states = []
        for state in automaton.states:
            transitions = tuple(
                replace(
                    transition,
                    event=change(transition.event) if transition.event else None,
                    targets=tuple(replace(target, body=in_body(target.body)) for target in transition.targets),
                )
                for transition in state.transitions
            )
            states.append(replace(state, entry=in_body(state.entry), exit=in_body(state.exit), transitions=transitions))
        automata.append(replace(automaton, states=tuple(states)))
    return replace(network, automata=tuple(automata))


def test_the_translation_does_not_depend_on_names(network: Network) -> None:
    """With other names and the same roles comes the same model, but for the names."""
    names = {event.name for event in events(network)}
    renamed = changed(network, lambda event: replace(event, name=f"qq.{event.name}.qq"))
    model = "".join(write(translate(renamed)))
    for name in sorted(names, key=len, reverse=True):
        model = model.replace(f"qq.{name}.qq", name)
    assert sorted(model) == sorted("".join(write(translate(network))))


@pytest.mark.parametrize("role", [role for role in EventRole if role is not EventRole.PLAIN])
def test_each_role_matters(network: Network, role: EventRole) -> None:
    if role in {event.role for event in events(network)}:
        plain = changed(network, lambda event: ScxmlEvent(event.name) if event.role is role else event)
        assert "".join(write(translate(plain))) != "".join(write(translate(network)))
