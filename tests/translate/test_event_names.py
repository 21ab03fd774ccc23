# SPDX-License-Identifier: Apache-2.0
"""The names of events are read as the translation writes them."""

from __future__ import annotations

import pytest

from roaml.lower.interfaces import ActionEvents, ServiceEvents, topic_event
from roaml.scxml.names import (
    InterfaceEvent,
    InterfaceEventKind,
    TreeEvent,
    TreeEventKind,
    answered_by,
    is_reserved_name,
    read_interface_event,
    read_tree_event,
    tree_event_name,
)

CLIENTS = ("Arm", "BT_plugin_1001_look")
SERVICE, ACTION = ServiceEvents("/arm/look"), ActionEvents("/arm/look")


@pytest.mark.parametrize(
    ("event", "kind"),
    [
        (topic_event("/arm/look").name, InterfaceEventKind.MESSAGE),
        (SERVICE.request.name, InterfaceEventKind.REQUEST),
        (f"{SERVICE.stem}_req_client_Arm", InterfaceEventKind.REQUEST),
        (SERVICE.response.name, InterfaceEventKind.RESPONSE),
        (f"{SERVICE.stem}_response_client_BT_plugin_1001_look", InterfaceEventKind.RESPONSE),
        (ACTION.goal.name, InterfaceEventKind.GOAL),
        (ACTION.cancel.name, InterfaceEventKind.CANCEL),
        (f"{ACTION.stem}_goal_accept_client_Arm", InterfaceEventKind.GOAL_ANSWER),
        (f"{ACTION.stem}_feedback", InterfaceEventKind.FEEDBACK),
        (f"{ACTION.stem}_result_handle_client_Arm", InterfaceEventKind.RESULT),
        (ACTION.thread_start.name, InterfaceEventKind.THREAD_START),
        (f"{ACTION.stem}_thread_free", InterfaceEventKind.THREAD_FREE),
    ],
)
def test_events_of_interfaces(event: str, kind: InterfaceEventKind) -> None:
    assert read_interface_event(event, CLIENTS) == InterfaceEvent(kind, "arm__look")
    assert is_reserved_name(event)


def test_a_name_that_continues_another_is_another_interface() -> None:
    request = InterfaceEvent(InterfaceEventKind.REQUEST, "look_again")
    assert read_interface_event("srv_look_again_request", ()) == request
    feedback = InterfaceEvent(InterfaceEventKind.FEEDBACK, "get_result")
    assert read_interface_event("action_get_result_feedback", ()) == feedback


@pytest.mark.parametrize("event", ["topic_look", "look", "srv_look_req_client_Unknown", "bt_1_tick"])
def test_other_events(event: str) -> None:
    assert read_interface_event(event, CLIENTS) is None


def test_events_of_the_tree() -> None:
    for kind in TreeEventKind:
        assert read_tree_event(tree_event_name(1002, kind)) == TreeEvent(1002, kind)
        assert read_tree_event(tree_event_name("1002_inner", kind)) == TreeEvent(1002, kind)
    assert answered_by("bt_1002_response") == "bt_1002_tick"
    assert answered_by("bt_1002_inner_halt_response") == "bt_1002_inner_halt"
    assert answered_by("bt_1002_tick") == answered_by("response") == ""
