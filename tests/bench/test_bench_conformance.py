# SPDX-License-Identifier: Apache-2.0
"""The numbers of states of a conformance system."""

from __future__ import annotations

import json

import conformance
from bench.reductions import Counted, Size, counted


def test_numbers_of_states_that_are_known_are_not_counted_again() -> None:
    path = next(path for path in conformance.systems() if "on_entry_exit_test" in str(path))
    (first,) = counted(path, [])
    assert Counted.read(json.dumps(first)) == first
    recorded = first._replace(whole=Size(7, True, 0.0))
    assert list(counted(path, [recorded])) == [recorded]
