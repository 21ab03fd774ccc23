# SPDX-License-Identifier: Apache-2.0
"""Properties in the notation of PRISM: the formulas that they denote, and Storm's answers to the same texts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import stormpy
from smc_models import automaton, document, edge, model, op, variable, way

from roaml import api
from roaml.jani.property_text import PropertyTextError, is_property_text, read_property_text
from roaml.verification.target import asking, target_of

CLOCK = ("sec", "nanosec")


def asked(text: str) -> Any:
    return read_property_text(text, CLOCK).expression["values"]


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("Pmax=? [ F done ]", {"op": "Pmax", "exp": {"op": "F", "exp": "done"}}),
        ("P=? [F done]", {"op": "Pmin", "exp": {"op": "F", "exp": "done"}}),
        ("Pmin=?[a U b]", {"op": "Pmin", "exp": {"op": "U", "left": "a", "right": "b"}}),
        ("P>=0.9 [ G a ]", {"op": "≥", "left": {"op": "Pmin", "exp": {"op": "G", "exp": "a"}}, "right": 0.9}),
        ("P<0.1 [ F bad ]", {"op": "<", "left": {"op": "Pmax", "exp": {"op": "F", "exp": "bad"}}, "right": 0.1}),
        ("P=? [ F<=100 x ]", {"op": "Pmin", "exp": {"op": "F", "exp": "x", "step-bounds": {"upper": 100}}}),
        (
            "P=? [ F[2,5] a ]",
            {"op": "Pmin", "exp": {"op": "F", "exp": "a", "step-bounds": {"lower": 2, "upper": 5}}},
        ),
        (
            "P=? [ F>=3 a ]",
            {"op": "Pmin", "exp": {"op": "F", "exp": "a", "step-bounds": {"lower": 3}}},
        ),
        (
            "P=? [ F<7 a ]",
            {"op": "Pmin", "exp": {"op": "F", "exp": "a", "step-bounds": {"upper": 7, "upper-exclusive": True}}},
        ),
        # As in PRISM, F applies to the conjunction, `!` to the comparison, and `&` binds more strongly than `|`.
        ("P=? [ F a & b ]", {"op": "Pmin", "exp": {"op": "F", "exp": op("∧", "a", "b")}}),
        ("P=? [ F !x=1 ]", {"op": "Pmin", "exp": {"op": "F", "exp": op("¬", op("=", "x", 1))}}),
        ("P=? [ F a | b & c ]", {"op": "Pmin", "exp": {"op": "F", "exp": op("∨", "a", op("∧", "b", "c"))}}),
        ("P=? [ F a => b => c ]", {"op": "Pmin", "exp": {"op": "F", "exp": op("⇒", "a", op("⇒", "b", "c"))}}),
        ("P=? [ G F a ]", {"op": "Pmin", "exp": {"op": "G", "exp": {"op": "F", "exp": "a"}}}),
        ("P=? [ (F a) & (G b) ]", {"op": "Pmin", "exp": op("∧", {"op": "F", "exp": "a"}, {"op": "G", "exp": "b"})}),
        ("P=? [ F x-1-1 = 2*y+mod(x,3) ]", {
            "op": "Pmin",
            "exp": {"op": "F", "exp": op("=", op("-", op("-", "x", 1), 1), op("+", op("*", 2, "y"), op("%", "x", 3)))},
        }),
        ('P=? [ F "deadlock" ]', {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "deadlock"}}}),
        ('P=? [ F "odd name" ]', {"op": "Pmin", "exp": {"op": "F", "exp": "odd name"}}),
        ('R{"steps"}max=? [ F done ]', {"op": "Emax", "exp": 1, "accumulate": ["steps"], "reach": "done"}),
        ("Rmin{steps}=? [ C<=10 ]", {"op": "Emin", "exp": 1, "accumulate": ["steps"], "step-instant": 10}),
    ],
)  # fmt: skip
def test_formulas(text: str, formula: Any) -> None:
    assert is_property_text(text)
    assert asked(text) == formula


def test_bounds_on_time() -> None:
    second, nanosecond = CLOCK
    within = op("∨", op("<", second, 10), op("∧", op("=", second, 10), op("≤", nanosecond, 500_000_000)))
    assert asked("P=? [ F<=10.5 s done ]")["exp"] == {"op": "F", "exp": op("∧", "done", within)}
    assert asked("P=? [ G<=10500 ms done ]")["exp"] == {"op": "G", "exp": op("⇒", within, "done")}
    until = asked("P=? [ a U<=10500ms b ]")["exp"]
    assert until == {"op": "U", "left": "a", "right": op("∧", "b", within)}
    with pytest.raises(PropertyTextError, match="the model has no clock"):
        read_property_text("P=? [ F<=10 s done ]")


def test_conditions() -> None:
    """`||` is a disjunction, except directly before a path."""
    read = read_property_text("P=? [ F a || G b ]")
    assert read.expression["values"] == {"op": "Pmin", "exp": {"op": "F", "exp": "a"}}
    assert read.given is not None
    assert read.given["values"] == {"op": "Pmin", "exp": {"op": "G", "exp": "b"}}
    for text in ("P=? [ F a || b ]", "P=? [ (F a) || (F b) ]", "P=? [ (F a) | F b ]"):
        assert read_property_text(text).given is None


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("P=? [ F ]", "expected a variable, a number or a bracket before `]` (column 9)"),
        ("P=? [ F a", "expected `]` at the end (column 10)"),
        ("P [ F a ]", "expected `=?`, or a comparison such as `>=0.9`, before `[` (column 3)"),
        ("Pmax=? [ F a ] b", "unexpected text before `b` (column 16)"),
        ("Q=? [ F a ]", "expected `P`, `Pmin`"),
        ("P=? [ X<=3 a ]", "`X` has no bound"),
        ("P=? [ F a § ]", "unknown character (column 11)"),
        ("R=? [ F a ]", "expected the reward in braces"),
        ("P=? [ F " + "(" * 200 + "a" + ")" * 200 + " ]", "nested too deeply"),
    ],
)
def test_what_is_not_a_property(text: str, problem: str) -> None:
    with pytest.raises(PropertyTextError) as raised:
        read_property_text(text)
    assert problem in str(raised.value)


def chain() -> dict[str, Any]:
    """A counter that goes up or down, with a choice in the middle."""
    edges = [
        edge(
            "l",
            way("l", 0.4, x=op("+", "x", 1)),
            way("l", 0.6, x=op("-", "x", 1)),
            guard=op("∧", op(">", "x", 0), op("<", "x", 6)),
        ),
        edge("l", way("l", 0.7, x=op("+", "x", 1)), way("l", 0.3, x=0), guard=op("=", "x", 3)),
        edge("l", way("l"), guard=op("∨", op("=", "x", 0), op("=", "x", 6))),
    ]
    return document(
        automaton("m", "l", edges),
        variables=[variable("x", {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 6}, 2)],
    )


TEXTS = (
    "Pmax=? [ F x=6 ]",
    "Pmin=? [ F<=7 x=6 ]",
    "Pmax=? [ F[3,9] x=6 ]",
    "Pmin=? [ x<5 U x=0 ]",
    "Pmax=? [ (x!=3) U<=10 (x=0 | x=6) ]",
    "Pmin=? [ F !(x<6) ]",
    "Pmax=? [ G x>=1 ]",
)


def test_storm_reads_the_same_texts(tmp_path: Path) -> None:
    """Storm parses each text itself, so its answer judges the meaning as well as the value."""
    written = chain()
    target = asking(target_of(model(written)), TEXTS)
    ours = {result.name: result.asked_value() for result in api.verify(target, TEXTS, exact_if_small=True)}
    jani, _ = stormpy.parse_jani_model_from_string(json.dumps({**written, "properties": []}))
    for text in TEXTS:
        properties = stormpy.parse_properties(text, jani)
        built = stormpy.build_model(jani, properties)
        theirs = stormpy.model_checking(built, properties[0]).get_value(built.initial_states[0])
        value = ours[text]
        assert value is not None
        assert value[1] == pytest.approx(theirs, abs=1e-6), text


def test_names_are_checked() -> None:
    target = target_of(model(chain()))
    with pytest.raises(PropertyTextError, match="`y`"):
        asking(target, ["P=? [ F y=1 ]"])
    with pytest.raises(PropertyTextError):
        asking(target, ["P=? [ F x ]"])


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        ("P=? [ F<=5 a ]", "A bound without a unit counts steps of the model, not seconds; `F<=5 s` has one."),
        ("P=? [ F<=5 s a ]", ""),
        ("P=? [ F a ]", ""),
        ("P=? [ a | b U c ]", ""),
        (
            "P=? [ F a || G b ]",
            "Assumption: only traces that satisfy `G b` count; `||` before F, G or X begins an assumption.",
        ),
        ('R{"time"}=? [ F a ]', "The time is in s."),
        ('R{"steps"}=? [ F a ]', "The steps are those of the model: each transition of an automaton is one."),
    ],
)
def test_what_a_reader_may_mistake(text: str, remark: str) -> None:
    assert read_property_text(text, CLOCK).remark == remark


def test_a_model_without_a_clock_has_only_steps() -> None:
    assert read_property_text("P=? [ F<=5 a ]").remark == ""


@pytest.mark.parametrize(
    ("text", "instead"),
    [
        ("Tmin=? [ F a ]", 'the expected time is `R{"time"}min=? [ F … ]`'),
        ("E=? [ F a ]", "an expected value is `R{…}min=? [ F … ]`"),
        ("Smax=? [ a ]", "probabilities in the long run are not supported"),
        ("p: P=? [ F a ]", "before `p` (column 1)"),
    ],
)
def test_properties_of_other_notations(text: str, instead: str) -> None:
    """They are not taken for names of properties, of which the model has none like that."""
    assert is_property_text(text)
    with pytest.raises(PropertyTextError) as caught:
        read_property_text(text, CLOCK)
    assert instead in str(caught.value)
