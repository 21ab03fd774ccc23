# SPDX-License-Identifier: Apache-2.0
"""Storm, the search through all states and traces agree on generated properties in XML of small conformance systems.
`tests/bench/run.py observers` compares all systems that Storm can read."""

from __future__ import annotations

import pytest
from generated_properties import with_properties
from three_answers import answers

import conformance

SYSTEMS = (
    "different_rate_senders/main.xml",
    "ros_add_int_srv_example/main.xml",
    "bt_test_models/main_test_repeat.xml",
    "set_float_srv_example/main.xml",
)
PROPERTIES = 8


@pytest.mark.parametrize("system", SYSTEMS)
def test_all_agree(system: str) -> None:
    source = with_properties(conformance.ROOT / "models" / system, [str(conformance.INTERFACES)], PROPERTIES)
    answered = {p.name: answers(source, p.name, 20_000) for p in source.observed}
    assert len(answered) == PROPERTIES
    assert {name: [*answer.differences()] for name, answer in answered.items()} == {name: [] for name in answered}
    assert all(answer.storm is not None for answer in answered.values())
