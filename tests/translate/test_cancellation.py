# SPDX-License-Identifier: Apache-2.0
"""Clients cancel their goals (docs/spec/ros.md#cancel): Storm computes what must come out of it.

The systems are in `cancellation.txt`. The lines `VARIABLE = VALUE: LEAST GREATEST` below a title are the probabilities
over all schedulers that the variable ever has the value.
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest
from storm import exact
from test_translate_storm import reaches, system
from translating import translated

from fixture import split_files
from roaml.jani.typecheck import check_model

_TITLE = re.compile(r"^## (.+)\n", re.MULTILINE)
_, *_PARTS = _TITLE.split((Path(__file__).parent / "cancellation.txt").read_text(encoding="utf-8"))
_SYSTEMS = dict(zip(_PARTS[::2], _PARTS[1::2], strict=True))
_VALUE = re.compile(r"(\w+) = (\d+): (\S+) (\S+)")
QUESTIONS = [
    pytest.param(text, *value, id=f"{title}: {value[0]} = {value[1]}")
    for title, text in _SYSTEMS.items()
    for value in _VALUE.findall(text)
]


@pytest.mark.parametrize(("text", "variable", "value", "least", "greatest"), QUESTIONS)
def test_probability(text: str, variable: str, value: str, least: str, greatest: str) -> None:
    machines = split_files(text[text.index("-- ") :]).values()
    model = translated(system(*machines, properties=reaches(variable, int(value))))
    assert check_model(model) == ()
    answer = exact(model, "p")
    assert (answer.least, answer.greatest) == pytest.approx((float(Fraction(least)), float(Fraction(greatest))))
