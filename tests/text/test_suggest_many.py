# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import difflib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.suggest import MAX_COMPARED, MAX_LENGTH, close_names

MANY = [f"sensor_{number}_reading" for number in range(2000)]
NAMES = st.text(alphabet="abcXYZ_1", min_size=1, max_size=12)


@pytest.mark.parametrize(
    "written",
    ["batery_level", "battery_levell", "battery_lavel", "abttery_level", "battery_levle", "BATTERY_LEVE"],
)
def test_the_intended_name_is_first_among_many(written: str) -> None:
    assert close_names(written, [*MANY, "battery_level"])[:1] == ("battery_level",)


@pytest.mark.parametrize("written", ["battery_lvl", "btry_level"])
def test_among_many_names_one_that_begins_or_ends_alike_is_close(written: str) -> None:
    assert "battery_level" in close_names(written, [*MANY, "battery_level"])


def test_few_names_are_all_compared() -> None:
    names = ["level", "love", "velle", "xyz"]
    assert close_names("levle", names) == tuple(difflib.get_close_matches("levle", names, 3, 0.6))


@given(st.lists(NAMES, min_size=MAX_COMPARED + 1, max_size=200), NAMES)
def test_close_names_are_candidates_and_no_others_are_closer(names: list[str], name: str) -> None:
    close = close_names(name, names, 1)
    assert set(close) <= set(names)
    if name.lower() in {known.lower() for known in names}:
        assert [suggested.lower() for suggested in close] == [name.lower()]


def test_the_number_of_comparisons_does_not_grow_with_the_names(monkeypatch: pytest.MonkeyPatch) -> None:
    compared: list[int] = []

    def count(word: str, possibilities: Any, n: int, cutoff: float) -> list[str]:
        compared.append(len(list(possibilities)))
        return []

    monkeypatch.setattr(difflib, "get_close_matches", count)
    for number in range(100):
        close_names(f"snesor_{number}_raeding", MANY)
    assert len(compared) == 100
    assert max(compared) <= MAX_COMPARED


def test_very_long_names() -> None:
    long = "a" * 100_000
    assert close_names(long, [*MANY, long]) == ()
    assert close_names("a" * (MAX_LENGTH + 5), [*MANY, "a" * MAX_LENGTH]) == ("a" * MAX_LENGTH,)
