# SPDX-License-Identifier: Apache-2.0
"""The shared variables of a translated system have names for users."""

from __future__ import annotations

from roaml.views.shared_names import field_name, shared_names

AUTOMATA = {
    "Arm": "Arm",
    "1004_Deliver": "Deliver (bt_1004)",
    "topic_arm__command_msg": "topic_arm__command_msg",
    "begin": "begin",
    "placed__observer": "placed__observer",
}


def test_names_of_users() -> None:
    names = {
        "topic_arm__command_msg__ros_fields__pose__x": "/arm/command.pose.x",
        "topic_arm__command_msg.valid": "/arm/command: valid",
        "srv_hand_over_response__ros_fields__success": "/hand_over response.success",
        "srv_hand_over_response_client_1004_Deliver__ros_fields__success": (
            "Deliver (bt_1004): /hand_over response.success"
        ),
        "begin__times": "begin.times",
        "placed__violated": "placed: violated",
        "bt_1000_response__status": "bt_1000_response__status",
        "my__variable": "my__variable",
    }
    assert shared_names(names, AUTOMATA) == names


def test_equal_names_are_those_of_jani() -> None:
    pair = ("topic_a_msg__ros_fields__p__x", "topic_a_msg__ros_fields__p.x")
    assert shared_names(pair, AUTOMATA) == dict(zip(pair, pair, strict=True))


def test_events_of_the_translation_have_no_name() -> None:
    assert field_name("bt_1000_tick", "", AUTOMATA) == ""
    assert field_name("ros_time_rate.second__Arm", "", AUTOMATA) == ""
