# SPDX-License-Identifier: Apache-2.0
"""The shared variables of a translated system have names for users."""

from __future__ import annotations

from roaml.views.shared_names import field_name, operand_names, read_names, shared_names

AUTOMATA = {
    "Arm": "Arm",
    "1004_Deliver": "Deliver (bt_1004)",
    "BT_plugin_1004_Deliver": "Deliver (bt_1004)",
    "BT_plugin_1005_Wait": "Wait",
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
        "bt_1000_response__status": "bt_1000_response__status",  # there is no node with this number
        "bt_1004_response__status": "Deliver (bt_1004).status",
        "bt_1004_response.valid": "Deliver (bt_1004) response: valid",
        "bt_1004_halt_response.valid": "Deliver (bt_1004) halt response: valid",
        "bt_1004_inner_tick.valid": "bt_1004_inner_tick.valid",
        "bt_1005_response__status": "Wait.status",
        "bt_blackboard_get__load": "{load}",
        "bt_blackboard_set_load__value": "{load} written",
        "bt_blackboard_set_load.valid": "{load} written: valid",
        "action_drive_goal_accept_client_Arm__goal_id": "Arm: /drive goal acceptance.goal_id",
        "action_drive_goal_rejected.valid": "/drive goal rejection: valid",
        "action_drive_result__ros_fields__way.d1_len": "/drive result.way: length",
        "action_drive_result__ros_fields__way.d2_len": "action_drive_result__ros_fields__way.d2_len",
        "action_drive_thread_start.valid": "action_drive_thread_start.valid",
        "my__variable": "my__variable",
    }
    assert shared_names(names, AUTOMATA) == names


def test_equal_names_are_those_of_jani() -> None:
    pair = ("topic_a_msg__ros_fields__p__x", "topic_a_msg__ros_fields__p.x")
    assert shared_names(pair, AUTOMATA) == dict(zip(pair, pair, strict=True))


def test_events_of_the_translation_have_no_name() -> None:
    assert field_name("bt_1000_tick", "", AUTOMATA) == ""
    assert field_name("ros_time_rate.second__Arm", "", AUTOMATA) == ""


def test_names_in_expressions_have_no_colon_before_their_last_part() -> None:
    names = {
        "topic_arm__command_msg.valid": "/arm/command.valid",
        "action_drive_result__ros_fields__way.d1_len": "/drive result.way.length",
        "action_drive_goal_req_client_Arm__ros_fields__x": "Arm: /drive goal.x",
        "bt_1005_response__status": "Wait.status",
    }
    assert operand_names(names, AUTOMATA) == names


def test_flags_beside_fields_are_left_out_of_what_a_property_reads() -> None:
    names = ["topic_level_msg.valid", "topic_level_msg__ros_fields__pose__x", "topic_on_msg.valid", "Arm.way"]
    assert read_names(names, AUTOMATA) == ["/level.pose.x", "/on", "Arm.way"]
