# SPDX-License-Identifier: Apache-2.0
"""Nested formulas in JANI, in one system with properties in XML that require the same: both have the same answers."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pytest
from storm import exact
from test_translate_observers import COUNT, TAILS, WHISTLE, hand_written, op, system
from translating import loaded, reported

from examples import examples
from roaml import api
from roaml.explicit.space import StateLimits
from roaml.smc.program import FALSE, TRUE
from roaml.smc.record import Recorder, Recording
from roaml.smc.run import EstimationMethod, Options
from roaml.verification.results import Exact, Refused


def within(name: str, operand: object, **bounds: float) -> dict[str, object]:
    return {**op(name, operand), "time-bounds": bounds}


def equal(count: int) -> dict[str, object]:
    return op("=", COUNT, count)


def pattern(name: str, *events: str, scope: str = 'type="globally"', time: str = "") -> str:
    written = "".join(f"<event>{event}</event>" for event in events)
    written = f"<events>{written}</events>" if len(events) > 1 else written
    return f'<property id="{{}}" pattern="{name}">{written}<scope {scope} />{time}</property>'


ODD, EVEN = op("=", op("%", COUNT, 2), 1), op("=", op("%", COUNT, 2), 0)
IS_ODD, IS_EVEN = "n % 2 == 1", "n % 2 == 0"
LOW, IS_LOW = op("≤", COUNT, 1), "n &lt;= 1"
ONE, TWO, THREE = "n == 1", "n == 2", "n == 3"
EQUIVALENTS = {
    "response": (
        op("G", op("⇒", ODD, op("F", EVEN))),
        pattern("response", IS_ODD, IS_EVEN),
    ),
    "response, as a disjunction": (
        op("G", op("∨", op("F", EVEN), op("¬", ODD))),
        pattern("response", IS_ODD, IS_EVEN),
    ),
    "response in time": (
        op("G", op("⇒", ODD, within("F", EVEN, upper=2.5))),
        pattern("response", IS_ODD, IS_EVEN, time='<time_interval time="2500" time_unit="ms" />'),
    ),
    "response after some time": (
        op("G", op("⇒", ODD, within("F", EVEN, lower=1, upper=3))),
        pattern("response", IS_ODD, IS_EVEN, time='<time_interval after="1" within="3" time_unit="s" />'),
    ),
    "recurrently": (
        op("G", within("F", EVEN, upper=3)),
        pattern("response", "true", IS_EVEN, time='<time_interval time="3" time_unit="s" />'),
    ),
    "universality after": (
        op("G", op("⇒", equal(1), op("G", op("≤", COUNT, 2)))),
        pattern("universality", "n &lt;= 2", scope='type="after" event="n == 1"'),
    ),
    "universality after, in time": (
        op("W", op("≠", COUNT, 1), op("∧", equal(1), within("G", equal(1), upper=1, lower=0))),
        pattern(
            "universality", ONE, scope='type="after" event="n == 1"', time='<time_interval time="1" time_unit="s" />'
        ),
    ),
    "universality in time after each": (
        op("G", op("⇒", ODD, within("G", op("≤", COUNT, 4), upper=2))),
        '<property id="{}" logic="pmtl" expr="O[:2] {{ n % 2 == 1 }} -&gt; {{ n &lt;= 4 }}" />',
    ),
    "existence after": (
        op("W", op("≠", COUNT, 1), op("∧", equal(1), op("F", equal(3)))),
        pattern("existence", THREE, scope='type="after" event="n == 1"'),
    ),
    "existence after, in time": (
        op("W", op("≠", COUNT, 1), op("∧", equal(1), within("F", equal(2), upper=2))),
        pattern("existence", TWO, scope='type="after" event="n == 1"', time='<time_interval time="2" time_unit="s" />'),
    ),
    "response after": (
        op("G", op("⇒", equal(1), op("G", op("⇒", ODD, op("F", EVEN))))),
        pattern("response", IS_ODD, IS_EVEN, scope='type="after" event="n == 1"'),
    ),
    "precedence after": (
        op("W", op("≠", COUNT, 1), op("∧", equal(1), op("W", op("≠", COUNT, 3), equal(4)))),
        pattern("precedence", "n == 4", THREE, scope='type="after" event="n == 1"'),
    ),
    "universality after-until": (
        op("G", op("⇒", op("∧", equal(1), op("¬", equal(3))), op("W", op("≤", COUNT, 1), equal(3)))),
        pattern("universality", IS_LOW, scope='type="after-until" event="n == 1" until="n == 3"'),
    ),
    "response after-until": (
        op(
            "G",
            op(
                "⇒",
                equal(1),
                op("W", op("⇒", ODD, op("U", op("≠", COUNT, 3), op("∧", EVEN, op("≠", COUNT, 3)))), equal(3)),
            ),
        ),
        pattern("response", IS_ODD, IS_EVEN, scope='type="after-until" event="n == 1" until="n == 3"'),
    ),
    "universality between": (
        op("G", op("⇒", op("∧", equal(1), op("F", equal(3))), op("U", op("≤", COUNT, 2), equal(3)))),
        pattern("universality", "n &lt;= 2", scope='type="between" event="n == 1" until="n == 3"'),
    ),
    "response between": (
        op(
            "G",
            op(
                "⇒",
                op("∧", op("=", COUNT, 1), op("F", equal(3))),
                op("U", op("⇒", ODD, op("U", op("≠", COUNT, 3), op("∧", EVEN, op("≠", COUNT, 3)))), equal(3)),
            ),
        ),
        pattern("response", IS_ODD, IS_EVEN, scope='type="between" event="n == 1" until="n == 3"'),
    ),
    "response until": (
        op("W", op("⇒", ODD, op("U", op("≠", COUNT, 3), op("∧", EVEN, op("≠", COUNT, 3)))), equal(3)),
        pattern("response", IS_ODD, IS_EVEN, scope='type="until" event="n == 3"'),
    ),
    "response before": (
        op(
            "⇒",
            op("F", equal(3)),
            op("U", op("⇒", ODD, op("U", op("≠", COUNT, 3), op("∧", EVEN, op("≠", COUNT, 3)))), equal(3)),
        ),
        pattern("response", IS_ODD, IS_EVEN, scope='type="before" event="n == 3"'),
    ),
    "an event of its own after each": (
        op(
            "G",
            op(
                "⇒",
                op("∧", ODD, op("≠", COUNT, 3)),
                op("U", op("≠", COUNT, 3), op("∧", equal(2), op("≠", COUNT, 3))),
            ),
        ),
        pattern(
            "response", "n % 2 == 1 &amp;&amp; n != 3", TWO, scope='type="after-until" event="true" until="n == 3"'
        ),
    ),
}
PORT = """<ports><ros_topic topic_name="/heads" type="std_msgs/Int32" event="publish">
    <state_var id="n" type="int32" field="data" expr="0" /></ros_topic></ports>"""


def answered(files: Mapping[str, str]) -> dict[str, object]:
    (result,) = api.verify(
        loaded(files), ["p"], Options(method=EstimationMethod.FIXED, max_traces=300, seed=11), only_uniform=True
    )
    assert not isinstance(result.outcome, Refused), result.outcome
    assert result.answer.tally.successes > 0
    return {**result.answer.tally.to_json(), "value": result.answer.value, "bounds": result.answer.bounds}


def only(in_jani: object = None, in_xml: str = "") -> dict[str, str]:
    """A system with one property."""
    files = system("", [] if in_jani is None else [hand_written("p", in_jani)])
    guarantees = f"<guarantees>{in_xml.format('p')}</guarantees>" if in_xml else ""
    return {**files, "properties.xml": f"<properties>{PORT if in_xml else ''}{guarantees}</properties>"}


@pytest.mark.parametrize("name", EQUIVALENTS)
def test_the_twin_in_xml_has_the_same_answer(name: str) -> None:
    in_jani, in_xml = EQUIVALENTS[name]
    assert answered(only(in_jani)) == answered(only(None, in_xml))


# ------------------------------------------------------------------ random formulas

State = Mapping[str, object]
CONDITIONS: tuple[tuple[object, Callable[[State], object]], ...] = (
    (TAILS, lambda s: s[TAILS]),
    (op("¬", WHISTLE), lambda s: not s[WHISTLE]),
    (equal(1), lambda s: s[COUNT] == 1),
    (op("≠", COUNT, 2), lambda s: s[COUNT] != 2),
    (op("<", COUNT, 3), lambda s: s[COUNT] < 3),
    (ODD, lambda s: s[COUNT] % 2 == 1),
    (EVEN, lambda s: s[COUNT] % 2 == 0),
)
HOLDS = {str(written): holds for written, holds in CONDITIONS}


def drawn_formula(random_: random.Random, depth: int = 3) -> object:
    if depth == 0 or (depth < 3 and random_.random() < 0.3):
        return random_.choice(CONDITIONS)[0]
    name = random_.choice("FGUWR" if depth == 3 else "¬∧∨⇒FGFGUWR")
    return op(name, *(drawn_formula(random_, depth - 1) for _ in range(1 if name in "¬FG" else 2)))


def table_formula(random_: random.Random) -> object:
    """A formula of one of the forms, with random conditions."""
    p, q, r, s = (random_.choice(CONDITIONS)[0] for _ in range(4))
    wait = op("⇒", p, op("U", op("¬", r), op("∧", q, op("¬", r))))
    return random_.choice(
        (
            op("G", op("⇒", p, op("F", q))),
            op("G", op("⇒", p, op("G", q))),
            op("G", op("⇒", p, op("U", q, r))),
            op("G", op("∨", op("W", q, r), p)),
            op("G", op("⇒", op("∧", p, op("F", r)), op("U", q, r))),
            op("G", op("⇒", op("∧", p, op("F", r)), op("U", q, op("∨", s, r)))),
            op("W", op("¬", p), op("∧", p, op("F", q))),
            op("U", op("¬", p), op("∧", p, op("W", q, r))),
            op("W", op("¬", p), op("∧", p, op("G", op("⇒", q, op("F", r))))),
            op("G", op("⇒", s, op("U", wait, r))),
            op("G", op("⇒", op("∧", s, op("F", r)), op("W", wait, r))),
            op("W", wait, r),
            op("G", op("⇒", op("∧", s, op("¬", r)), op("U", op("¬", r), op("∧", p, op("¬", r))))),
            op("G", op("⇒", op("∧", s, op("¬", r)), op("W", op("¬", r), op("∧", p, op("¬", r))))),
            op("⇒", op("F", r), op("U", wait, r)),
            op("F", op("∧", p, op("G", q))),
            op("F", op("∧", p, op("F", q))),
            op("G", op("⇒", p, op("G", op("F", q)))),
            op("G", op("⇒", p, op("∧", op("F", q), op("G", r)))),
        )
    )


def holds(formula: object, states: Sequence[State], i: int = 0) -> bool:
    """Whether a formula holds in a state; nothing changes after the last one."""
    if str(formula) in HOLDS:
        return bool(HOLDS[str(formula)](states[i]))
    assert isinstance(formula, dict)
    parts = [formula[key] for key in ("exp", "left", "right") if key in formula]
    later = range(i, len(states))
    match formula["op"]:
        case "¬":
            return not holds(parts[0], states, i)
        case "∧":
            return holds(parts[0], states, i) and holds(parts[1], states, i)
        case "∨":
            return holds(parts[0], states, i) or holds(parts[1], states, i)
        case "⇒":
            return not holds(parts[0], states, i) or holds(parts[1], states, i)
        case "F":
            return any(holds(parts[0], states, j) for j in later)
        case "G":
            return all(holds(parts[0], states, j) for j in later)
        case "R":
            return not until(states, i, *(op("¬", part) for part in parts))
        case "W":
            return until(states, i, *parts) or all(holds(parts[0], states, j) for j in later)
    return until(states, i, *parts)


def until(states: Sequence[State], i: int, left: object, right: object) -> bool:
    for j in range(i, len(states)):
        if holds(right, states, j):
            return True
        if not holds(left, states, j):
            return False
    return False


def traces(checker: object, count: int) -> list[list[State]]:
    """The states of some traces to their end, without repetitions."""
    recorder = Recorder(checker, checker.stuck, 5, 100_000)  # type: ignore[arg-type, attr-defined]
    storages = [s for s in recorder.shared if s.name in (COUNT, TAILS, WHISTLE)]
    names = [s.name for s in storages]
    initial = {COUNT: 0, TAILS: False, WHISTLE: False}
    result = []
    for number in range(count):
        states: list[State] = [initial]
        for _ in recorder.walk(Recording(number)):
            state = dict(zip(names, recorder.values(storages), strict=True))
            if state != states[-1]:
                states.append(state)
        result.append(states)
    return result


@pytest.mark.parametrize("draw", [drawn_formula, table_formula])
def test_random_formulas_in_traces(draw: Callable[[random.Random], object]) -> None:
    random_ = random.Random(17)
    formulas = {f"p{i}": draw(random_) for i in range(examples(40))}
    files = system("", [hand_written(name, formula) for name, formula in formulas.items()])
    checker = api.verifier(loaded({**files, "properties.xml": "<properties />"})).checker
    assert {fault.code for fault in checker.refused.values()} <= {"unsupported-property"}
    states = traces(checker, 15)
    verdicts = set()
    for property_ in checker.compiled_properties:
        recorder = Recorder(checker, property_, 5, 100_000)
        for number, seen in enumerate(states):
            recording = Recording(number)
            recorder.rush(recording)
            expected = holds(formulas[property_.question.name], seen)
            assert recording.verdict == (TRUE if expected else FALSE), formulas[property_.question.name]
            verdicts.add(expected)
    assert verdicts == {True, False}
    assert bool(checker.refused) == (draw is drawn_formula)
    assert any(automaton.name.endswith("__observer") for automaton in checker.model.automata)


# ------------------------------------------------------------------------- Storm

BY_STORM = {
    "response": EQUIVALENTS["response"][0],
    "negated": op("F", op("∧", ODD, op("G", ODD))),
    "universality after": EQUIVALENTS["universality after"][0],
    "until": op("G", op("⇒", equal(1), op("U", op("≤", COUNT, 1), op("≥", COUNT, 2)))),
    "two": op("∧", EQUIVALENTS["response"][0], op("F", WHISTLE)),
}


@pytest.mark.parametrize("name", BY_STORM)
def test_all_states_give_what_storm_computes_for_the_nested_formula(name: str) -> None:
    source = loaded(only(BY_STORM[name]))
    by_storm = exact(api.to_jani(source), "p")
    assert 0 < by_storm.least < 1
    values = all_states(api.verifier(source))
    assert values.minimum.lower == pytest.approx(by_storm.least, abs=1e-5)
    assert values.maximum.upper == pytest.approx(by_storm.greatest, abs=1e-5)


def all_states(verifier: api.Verifier) -> Exact:
    (property_,) = verifier.checker.compiled_properties
    values = verifier.exhaustive(property_, StateLimits()).exact
    assert values is not None
    return values


# ------------------------------------------------------------- models in JANI


def written(folder: Path, formula: object, **variable: object) -> str:
    """A chain with silent steps: x is 0, then 1; from 1 it changes to 0 or 2, from 2 to 1 or 3; 3 is the end."""

    def edge(before: int, *after: int) -> dict[str, object]:
        ways = [
            {
                "location": "l",
                "probability": {"exp": 1 / len(after)},
                "assignments": [{"ref": "x", "value": value}],
            }
            for value in after
        ]
        return {"location": "l", "guard": {"exp": op("=", "x", before)}, "destinations": ways}

    edges = [edge(0, 1), edge(1, 0, 2), edge(2, 1, 3)]
    automaton = {"name": "a", "locations": [{"name": "l"}], "initial-locations": ["l"], "edges": edges}
    type_ = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 3}
    document = {
        "jani-version": 1,
        "name": "chain",
        "type": "dtmc",
        "variables": [{"name": "x", "type": type_, **(variable or {"initial-value": 0})}],
        "automata": [automaton],
        "system": {"elements": [{"automaton": "a"}]},
        "properties": [hand_written("p", formula)],
    }
    path = folder / "chain.jani"
    path.write_text(json.dumps(document))
    return str(path)


NO_RETURN = op("G", op("⇒", op("=", "x", 1), op("W", op("≠", "x", 0), op("=", "x", 3))))


def test_silent_steps_are_observed(tmp_path: Path) -> None:
    """From 1, the chain reaches 3 before 0 with probability 1/3."""
    values = all_states(api.verifier(api.target(written(tmp_path, NO_RETURN))))
    assert values.minimum.lower == pytest.approx(1 / 3, abs=1e-5)
    assert values.maximum.upper == pytest.approx(1 / 3, abs=1e-5)


def test_variables_that_cannot_be_observed(tmp_path: Path) -> None:
    """A transient variable changes without an assignment."""
    path = written(tmp_path, NO_RETURN, **{"initial-value": 0, "transient": True})
    assert "have initial values and none is transient" in api.verifier(api.target(path)).checker.refused["p"].message


REWARD = {"exp": 1, "accumulate": ["steps"], "bounds": {"upper": 2}}
REFUSED = {
    "next": op("G", op("⇒", ODD, op("X", EVEN))),
    "steps": op("G", op("⇒", ODD, {**op("F", EVEN), "step-bounds": {"upper": 3}})),
    "three levels": op("G", op("F", op("∧", ODD, op("F", op("G", EVEN))))),
    "rewards": op("G", op("⇒", ODD, {**op("F", EVEN), "reward-bounds": [REWARD]})),
    "time outside": within("G", op("⇒", ODD, op("F", EVEN)), upper=3),
    "no step of the clock": op("G", op("⇒", ODD, within("F", EVEN, lower=0.25, upper=0.75))),
}


@pytest.mark.parametrize("name", REFUSED)
def test_other_forms_are_refused_and_reported(name: str) -> None:
    source = only(REFUSED[name])
    (refused,) = api.verifier(loaded(source)).checker.refused.values()
    assert "`G (p ⇒ F q)`, `G (p ⇒ G q)`, `G (p ⇒ (q U r))`" in refused.message
    reports = reported(source, "twins.jani")
    assert refused.code in {finding.code for finding in reports}
    assert {finding.code for finding in reports} <= {"unsupported-property", "ignored-bounds"}


@pytest.mark.parametrize("name", EQUIVALENTS)
def test_forms_that_are_answered_are_not_reported(name: str) -> None:
    assert not reported(only(EQUIVALENTS[name][0]), "twins.jani")


def test_without_a_clock_no_time_is_measured(tmp_path: Path) -> None:
    bounded = op("G", op("⇒", op("=", "x", 1), within("F", op("=", "x", 3), upper=3)))
    (refused,) = api.verifier(api.target(written(tmp_path, bounded))).checker.refused.values()
    assert refused.code == "ignored-bounds"


def test_all_states_get_stuck_only_where_they_are_stuck() -> None:
    verifier = api.verifier(loaded(only(EQUIVALENTS["response"][0])), ["stuck"])
    assert all_states(verifier).maximum.upper == 0
