# SPDX-License-Identifier: Apache-2.0
"""Numbers as exact fractions."""

from __future__ import annotations

from fractions import Fraction

import pytest

from roaml.exact_number import exact_number


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("4", Fraction(4)),
        (" 0.1 ", Fraction(1, 10)),
        ("2e3", Fraction(2000)),
        ("-0.5", Fraction(-1, 2)),
        ("0", Fraction(0)),
        ("0.0e-5", Fraction(0)),
        ("1/4", None),
        ("1/0", None),
        ("fast", None),
        ("", None),
        ("nan", None),
        ("inf", None),
        ("1e400", None),
        ("1e-9999999", None),
        ("1e9999999", None),
    ],
)
def test_value(text: str, value: Fraction | None) -> None:
    assert exact_number(text) == value
