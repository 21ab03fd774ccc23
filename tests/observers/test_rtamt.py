# SPDX-License-Identifier: Apache-2.0
"""Past formulas against rtamt, an independent evaluation of temporal logic (https://github.com/nickovic/rtamt).

rtamt has one sample for each step of time. So the traces have one letter at each time.
"""

from __future__ import annotations

from importlib import util

import naive
import pytest
from drawn import observed
from hypothesis import given, settings
from hypothesis import strategies as st
from test_observer_random import formulas

from examples import examples
from roaml.observers.properties import And, Atom, Constant, Formula, FormulaProperty, Not, Or, Since
from roaml.observers.verdict import End, Verdict

ATOMS = ("left", "right")


def in_rtamt(formula: Formula, length: int) -> str:
    """The formula in the notation of rtamt, for a trace of `length` samples. Atoms are the numbers 0 and 1."""
    match formula:
        case Atom(name):
            return f"({name} >= 0.5)"
        case Constant(value):
            return f"(left >= {-1 if value else 2})"
        case Not(operand):
            return f"(not {in_rtamt(operand, length)})"
        case And(left, right):
            return f"({in_rtamt(left, length)} and {in_rtamt(right, length)})"
        case Or(left, right):
            return f"({in_rtamt(left, length)} or {in_rtamt(right, length)})"
        case Since(left, right, window):
            upper = max(window.lower, length) if window.upper is None else window.upper
            return f"({in_rtamt(left, length)} since[{window.lower}:{upper}] {in_rtamt(right, length)})"


@st.composite
def samples(draw: st.DrawFn) -> tuple[naive.Letter, ...]:
    rows = draw(st.lists(st.sets(st.sampled_from(ATOMS)), min_size=2, max_size=20))  # rtamt fails for one sample
    return tuple(naive.Letter(time, frozenset(holds)) for time, holds in enumerate(rows))


if util.find_spec("rtamt") is None:
    print("rtamt is not installed: it does not judge past formulas")
else:

    @pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of its parser
    @settings(max_examples=examples(60), deadline=None)
    @given(formulas(), samples())
    def test_formulas_as_rtamt_evaluates_them(formula: Formula, trace: tuple[naive.Letter, ...]) -> None:
        import rtamt  # noqa: PLC0415 - not everywhere

        judge = rtamt.StlDiscreteTimeSpecification()
        for name in (*ATOMS, "out"):
            judge.declare_var(name, "float")
        judge.spec = f"out = {in_rtamt(formula, len(trace))}"
        judge.parse()
        numbers = {name: [float(name in letter.holds) for letter in trace] for name in ATOMS}
        robustness = judge.evaluate({"time": list(range(len(trace))), **numbers})
        expected = [value > 0 for _, value in robustness]
        assert [naive.holds(formula, trace, i) for i in range(len(trace))] == expected
        result = observed(FormulaProperty(formula), trace, End.FINISHED)
        assert result is (Verdict.SATISFIED if all(expected) else Verdict.VIOLATED)
