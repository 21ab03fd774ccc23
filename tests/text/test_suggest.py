# SPDX-License-Identifier: Apache-2.0
"""Suggestions for misspelled names (`roaml.suggest`)."""

from __future__ import annotations

import pytest

from roaml.suggest import MAX_LENGTH, are_similar, close_names, did_you_mean, nearest_name

KNOWN = ["topic_level_msg__ros_fields__data", "topic_level_msg.valid", "seen.valid", "level", "idle", "n"]


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("topic_level_msg__ros_field__data", "topic_level_msg__ros_fields__data"),
        ("topic_lvel_msg.valid", "topic_level_msg.valid"),
        ("seen.vaild", "seen.valid"),
        ("levels", "level"),
        ("Idle", "idle"),
        ("idel", "idle"),
        ("iddel", None),
        ("m", None),
        ("alarm", None),
        ("", None),
    ],
)
def test_nearest_name(name: str, meant: str | None) -> None:
    assert nearest_name(name, KNOWN) == meant


def test_the_nearest_name_wins() -> None:
    assert nearest_name("counter_10", ["counter_2", "counter_11", "counter_20", "counter_1"]) == "counter_11"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("TOPIC", ("topic",)),
        ("tpoic", ("topic",)),
        ("servce", ("service", "services")),
        ("service", ("service", "services")),
        ("xyz", ()),
        ("", ()),
    ],
)
def test_close_names(name: str, expected: tuple[str, ...]) -> None:
    assert close_names(name, ["topic", "services", "service", "action"]) == expected
    assert close_names(name, ["topic", "services", "service", "action"], 1) == expected[:1]


def test_long_names_are_compared_by_their_beginning() -> None:
    name = "a" * MAX_LENGTH
    assert are_similar(name + "b" * 1000, name)
    assert not are_similar(name, name + "b" * 1000)


def test_did_you_mean() -> None:
    assert did_you_mean(()) == ""
    assert did_you_mean(("a", "b")) == "; did you mean `a`?"
    assert did_you_mean(("a", "b", "c"), 2) == "; did you mean `a` or `b`?"
