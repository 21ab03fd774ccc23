# SPDX-License-Identifier: Apache-2.0
"""Sentences for properties of JANI."""

from __future__ import annotations

import json
from collections.abc import Mapping

import pytest
from smc_models import Json, op, probability

from roaml.jani.property_text import read_property_text
from roaml.jani.reader import read_properties
from roaml.jani.semantics import Value
from roaml.jani.sentences import MAX_LENGTH, sentence
from roaml.json_syntax import parse


def said(expression: object, constants: Mapping[str, Value] | None = None) -> str:
    value, _ = parse(json.dumps({"properties": [{"name": "p", "expression": expression}]}))
    (property_,), findings = read_properties(value)
    assert not findings
    return sentence(property_.expression, constants)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Pmax=? [ F done ]", "`done` holds at some time."),
        ("P=? [ F<=100 done ]", "`done` holds within 100 steps."),
        ("P=? [ F<=1 done ]", "`done` holds within 1 step."),
        ("P=? [ F[5,100] done ]", "`done` holds after 5 to 100 steps."),
        ("P=? [ G !failed ]", "`failed` never holds."),
        ("P=? [ G (x > 1) ]", "`x > 1` always holds."),
        ("P=? [ X done ]", "`done` holds after the next step."),
        ("P=? [ a U b ]", "`b` holds at some time, and until then `a` always holds."),
        ("P=? [ true U b ]", "`b` holds at some time."),
        ("P=? [ a W b ]", "`a` holds until `b` holds, or for ever."),
        ("P=? [ a R b ]", "`b` holds up to and including the time when `a` holds, or for ever."),
        ("P=? [ F G a ]", "From some time on, `a` holds for ever."),
        ("P=? [ G F a ]", "Again and again, `a` holds."),
        ("P=? [ G (a => F b) ]", "Whenever `a` holds, `b` holds then or later."),
        ("P=? [ G (a => F<=3 b) ]", "Whenever `a` holds, `b` holds within 3 steps later."),
        ("P>=0.9 [ (F a) & (G b) ]", "Both `a` holds at some time, and `b` always holds."),
        ("P=? [ F (a & (b | c)) ]", "`a ∧ (b ∨ c)` holds at some time."),
        ("P=? [ F (x - (y - 1) = max(x, 2)) ]", "`(x - (y - 1)) = max(x, 2)` holds at some time."),
        ('Rmax{"steps"}=? [ F done ]', "The expected number of steps until `done` holds."),
        ("R{fuel}=? [ C<=20 ]", "The expected total of `fuel` in the first 20 steps."),
        ("P=? [ F floor(x) = 1 ]", ""),
    ],
)
def test_sentences(text: str, expected: str) -> None:
    assert said(read_property_text(text).expression) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("R{price * fuel}=? [ F x = limit ]", "until `x = limit` holds (price = 0.25, limit = 3)."),
        (
            "R{price}=? [ C<=limit ]",
            " total of `price` in the first limit steps (price = 0.25, limit = 3).",
        ),
        ("P=? [ F (fast & x = list) ]", " holds at some time (fast = true)."),
        ("P=? [ F (x > limit | y > limit) ]", "`x > limit ∨ y > limit` holds at some time (limit = 3)."),
        ("P=? [ F done ]", "`done` holds at some time."),
    ],
)
def test_sentences_give_the_values_of_the_constants_that_they_name(text: str, expected: str) -> None:
    values: dict[str, Value] = {"limit": 3, "price": 0.25, "fast": True, "other": 1}
    assert said(read_property_text(text).expression, values).endswith(expected)


def test_deadlocks() -> None:
    deadlock: Json = {"op": "deadlock"}
    assert said(probability(op("F", deadlock))) == "No step is possible at some time."
    assert said(probability(op("G", op("¬", deadlock)))) == "Always a step is possible."


def test_long_formulas_have_no_sentence() -> None:
    condition = " & ".join(f"variable_{i}" for i in range(40))
    assert said(read_property_text(f"P=? [ F {condition} ]").expression) == ""
    assert len(said(read_property_text("P=? [ F a ]").expression)) < MAX_LENGTH
