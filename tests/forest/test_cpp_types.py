# SPDX-License-Identifier: Apache-2.0
"""Texts for ports of C++ types: what BehaviorTree.CPP converts (docs/spec/lone-trees.md#literals)."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.forest.cpp_types import mismatch, normal


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("std::string", "string"),
        ("const std::string &", "string"),
        ("unsigned int", "unsigned"),
        ("uint32_t", "unsigned"),
        ("int32", "int"),
        ("std::vector<std::string>", "vector<string>"),
        ("BT::SharedQueue<int32_t>", "vector<int>"),
        ("std::chrono::milliseconds", "chrono::milliseconds"),
        ("BT::NodeStatus", "NodeStatus"),
        ("geometry_msgs::msg::PoseStamped", "geometry_msgs::msg::PoseStamped"),
        ("geometry_msgs::msg::PoseStamped_<std::allocator<void> >", "geometry_msgs::msg::PoseStamped"),
        ("geometry_msgs/msg/PoseStamped", "geometry_msgs::msg::PoseStamped"),
        ("geometry_msgs/PoseStamped", "geometry_msgs::msg::PoseStamped"),
        (
            "std::vector<nav_msgs::msg::Path_<std::allocator<void> >, std::allocator<nav_msgs::msg::Path> >",
            "vector<nav_msgs::msg::Path>",
        ),
        ("std::__cxx11::basic_string<char, std::char_traits<char>, std::allocator<char> >", "string"),
        ("std::chrono::duration<long, std::ratio<1l, 1000l> >", "chrono::milliseconds"),
        ("std::chrono::duration<long, std::ratio<1l, 1l> >", "chrono::seconds"),
        ("Grasp::SharedPtr", "shared_ptr<Grasp>"),
        ("std::shared_ptr<const Grasp>", "shared_ptr<Grasp>"),
        ("", "any"),
        ("BT::AnyTypeAllowed", "any"),
    ],
)
def test_spellings(written: str, name: str) -> None:
    assert normal(written) == name


@pytest.mark.parametrize(
    ("type_name", "text", "says"),
    [
        ("int", "3", None),
        ("int", "-3", None),
        ("int", "x", "must be an integer"),
        ("int", "", "must be an integer"),
        ("int", "3.5", "reads `3` and ignores the rest"),
        ("int", "4000000000", "must be from -2147483648 to 2147483647"),
        ("unsigned int", "-1", "must be 0 or greater"),
        ("uint8_t", "256", "must be from 0 to 255"),
        ("double", "1e-3", None),
        ("double", ".5", None),
        ("double", "inf", None),
        ("double", "fast", "must be a number"),
        ("double", "1.5m", "reads `1.5` and ignores the rest"),
        ("bool", "true", None),
        ("bool", "1", None),
        ("bool", "yes", "must be `true` or `false`"),
        ("NodeStatus", "SKIPPED", None),
        ("NodeStatus", "success", "must be one of `SUCCESS`"),
        ("std::vector<double>", "1;2.5;-3", None),
        ("std::vector<double>", "1;b", "must be a number"),
        ("std::vector<double>", "1,b", "must be a number"),
        ("std::vector<int>", "1, 2;3", "must separate its elements by `;`: write `1;2;3`"),
        ("std::vector<std::string>", "a,b", None),
        ("int", "1,2", "reads `1` and ignores the rest"),
        ("std::vector<Pose>", "1;b", None),
        ("string", "anything at all", None),
        ("Pose", "anything at all", None),
        ("int", 'json:{"x": 1}', None),
    ],
)
def test_literals(type_name: str, text: str, says: str | None) -> None:
    wrong = mismatch(type_name, text)
    assert (wrong is None) if says is None else (wrong is not None and says in wrong.message)


@given(st.text(max_size=20), st.text(max_size=20))
def test_any_type_and_text_give_an_answer(type_name: str, text: str) -> None:
    normal(type_name)
    mismatch(type_name, text)


@given(st.integers(-(2**31), 2**31 - 1))
def test_integers_fit(value: int) -> None:
    assert mismatch("int", str(value)) is None
    assert mismatch("double", str(value)) is None
