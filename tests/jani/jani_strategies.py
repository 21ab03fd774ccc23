# SPDX-License-Identifier: Apache-2.0
"""Random JANI models. They are well-formed, but names and types in them need not make sense."""

from __future__ import annotations

from hypothesis import strategies as st

from roaml.jani import expressions as x
from roaml.jani import model as m
from roaml.jani import properties as p
from roaml.jani import types as t
from roaml.jani.operators import BinaryOperator, Distribution, NumberConstant, UnaryOperator

NAMES = st.sampled_from(["x", "y", "e__p", "seen.valid", "a.d1_len", "größe ∧", 'say "hi"\n', "\ud800"])
COMMENTS = st.none() | st.sampled_from(["", "why", "π ≤ 4"])
FLOATS = st.floats(allow_nan=False, allow_infinity=False)
SMALL = st.integers(-1000, 1000)


def lists(items: st.SearchStrategy[x.Expression]) -> st.SearchStrategy[tuple[x.Expression, ...]]:
    return st.lists(items, max_size=3).map(tuple)


def compound_expressions(inner: st.SearchStrategy[x.Expression]) -> st.SearchStrategy[x.Expression]:
    members = st.lists(st.tuples(NAMES, inner), max_size=2).map(tuple)
    return st.one_of(
        st.builds(x.Unary, st.sampled_from(UnaryOperator), inner, comment=COMMENTS),
        st.builds(x.Binary, st.sampled_from(BinaryOperator), inner, inner, comment=COMMENTS),
        st.builds(x.Conditional, inner, inner, inner, comment=COMMENTS),
        st.builds(x.ArrayAccess, inner, inner, comment=COMMENTS),
        st.builds(x.ArrayValue, lists(inner), comment=COMMENTS),
        st.builds(x.ArrayConstructor, NAMES, inner, inner, comment=COMMENTS),
        st.builds(x.DatatypeAccess, inner, NAMES, comment=COMMENTS),
        st.builds(x.DatatypeValue, NAMES, members, comment=COMMENTS),
        st.builds(x.OptionAccess, inner, comment=COMMENTS),
        st.builds(x.OptionValue, inner, comment=COMMENTS),
        st.builds(x.Call, NAMES, lists(inner), comment=COMMENTS),
        st.builds(x.Selection, NAMES, inner, comment=COMMENTS),
        st.builds(x.Sample, st.sampled_from(Distribution), lists(inner), comment=COMMENTS),
    )


EXPRESSIONS: st.SearchStrategy[x.Expression] = st.recursive(
    st.one_of(
        st.builds(x.Boolean, st.booleans()),
        st.builds(x.Integer, st.integers()),
        st.builds(x.Real, FLOATS),
        st.builds(x.NamedNumber, st.sampled_from(NumberConstant), comment=COMMENTS),
        st.builds(x.Name, NAMES),
        st.builds(x.EmptyOption, comment=COMMENTS),
        st.builds(x.Derivative, NAMES, comment=COMMENTS),
    ),
    compound_expressions,
    max_leaves=6,
)

VARIABLES = st.builds(x.Name, NAMES)
LVALUES: st.SearchStrategy[x.LValue] = st.one_of(
    VARIABLES,
    st.builds(x.ArrayAccess, VARIABLES, EXPRESSIONS, comment=COMMENTS),
    st.builds(x.ArrayAccess, st.builds(x.ArrayAccess, VARIABLES, EXPRESSIONS), EXPRESSIONS),
    st.builds(x.DatatypeAccess, VARIABLES, NAMES),
    st.builds(x.OptionAccess, VARIABLES),
)

ACCUMULATIONS = st.lists(st.sampled_from(p.Accumulation), max_size=2).map(tuple)
FLAGS = st.none() | st.booleans()
INTERVALS = st.builds(p.Interval, st.none() | EXPRESSIONS, st.none() | EXPRESSIONS, FLAGS, FLAGS, comment=COMMENTS)
REWARD_BOUNDS = st.lists(
    st.builds(p.RewardBound, EXPRESSIONS, ACCUMULATIONS, INTERVALS, comment=COMMENTS), max_size=2
).map(tuple)
REWARD_INSTANTS = st.lists(
    st.builds(p.RewardInstant, EXPRESSIONS, ACCUMULATIONS, EXPRESSIONS, comment=COMMENTS), max_size=2
).map(tuple)


def proper_formulas(inner: st.SearchStrategy[p.Formula]) -> st.SearchStrategy[p.Formula]:
    bounds = {
        "step_bounds": st.none() | INTERVALS,
        "time_bounds": st.none() | INTERVALS,
        "reward_bounds": st.none() | REWARD_BOUNDS,
        "comment": COMMENTS,
    }
    proper = st.one_of(
        st.builds(p.Filter, st.sampled_from(p.FilterFunction), inner, inner, comment=COMMENTS),
        st.builds(p.Probability, st.sampled_from(p.ProbabilityOperator), inner, comment=COMMENTS),
        st.builds(p.Quantified, st.sampled_from(p.PathQuantifier), inner, comment=COMMENTS),
        st.builds(
            p.Expectation,
            st.sampled_from(p.ExpectationOperator),
            EXPRESSIONS,
            st.none() | ACCUMULATIONS,
            st.none() | inner,
            st.none() | EXPRESSIONS,
            st.none() | EXPRESSIONS,
            st.none() | REWARD_INSTANTS,
            comment=COMMENTS,
        ),
        st.builds(
            p.SteadyState, st.sampled_from(p.SteadyStateOperator), inner, st.none() | ACCUMULATIONS, comment=COMMENTS
        ),
        st.builds(p.UnaryPath, st.sampled_from(p.UnaryPathOperator), inner, **bounds),
        st.builds(p.BinaryPath, st.sampled_from(p.BinaryPathOperator), inner, inner, **bounds),
        st.builds(p.Predicate, st.sampled_from(p.StatePredicate), comment=COMMENTS),
    )
    return st.one_of(
        proper,
        st.builds(p.UnaryFormula, st.sampled_from(UnaryOperator), proper, comment=COMMENTS),
        st.builds(p.BinaryFormula, st.sampled_from(BinaryOperator), proper, inner, comment=COMMENTS),
        st.builds(p.ConditionalFormula, inner, proper, inner, comment=COMMENTS),
    )


FORMULAS: st.SearchStrategy[p.Formula] = st.recursive(EXPRESSIONS, proper_formulas, max_leaves=3)
PROPERTIES = st.builds(p.Property, NAMES, FORMULAS, comment=COMMENTS)

TYPES: st.SearchStrategy[t.Type] = st.recursive(
    st.one_of(
        st.sampled_from(t.BasicType),
        st.builds(t.BoundedType, st.sampled_from([t.INT, t.REAL]), st.none() | EXPRESSIONS, st.none() | EXPRESSIONS),
        st.builds(t.DatatypeType, NAMES),
    ),
    lambda inner: st.builds(t.ArrayType, inner) | st.builds(t.OptionType, inner),
    max_leaves=3,
)

CLAUSES = st.none() | st.builds(m.Clause, EXPRESSIONS, comment=COMMENTS)


def some(items: st.SearchStrategy[object], least: int = 0) -> st.SearchStrategy[tuple[object, ...]]:
    return st.lists(items, min_size=least, max_size=2).map(tuple)


VARIABLE_LISTS = some(st.builds(m.Variable, NAMES, TYPES, st.none() | EXPRESSIONS, st.booleans(), comment=COMMENTS))
FUNCTION_LISTS = some(
    st.builds(m.Function, NAMES, TYPES, some(st.builds(m.Parameter, NAMES, TYPES, comment=COMMENTS)), EXPRESSIONS)
)
ASSIGNMENTS = st.builds(m.Assignment, LVALUES, EXPRESSIONS, st.integers(0, 9), comment=COMMENTS)
DESTINATIONS = st.builds(m.Destination, NAMES, CLAUSES, some(ASSIGNMENTS), comment=COMMENTS)
EDGES = st.builds(m.Edge, NAMES, some(DESTINATIONS), st.none() | NAMES, CLAUSES, CLAUSES, comment=COMMENTS)
TRANSIENT_VALUES = some(st.builds(m.TransientValue, LVALUES, EXPRESSIONS, comment=COMMENTS))
LOCATIONS = st.builds(m.Location, NAMES, CLAUSES, TRANSIENT_VALUES, comment=COMMENTS)
AUTOMATA = st.builds(
    m.Automaton,
    NAMES,
    some(LOCATIONS),
    some(NAMES),
    some(EDGES),
    VARIABLE_LISTS,
    FUNCTION_LISTS,
    CLAUSES,
    comment=COMMENTS,
)


@st.composite
def systems(draw: st.DrawFn) -> m.System:
    elements = draw(some(st.builds(m.Element, NAMES, some(NAMES), comment=COMMENTS), 1))
    participants = st.dictionaries(st.integers(0, len(elements) - 1), NAMES).map(
        lambda chosen: tuple(sorted(chosen.items()))
    )
    syncs = draw(some(st.builds(m.Sync, participants, st.none() | NAMES, comment=COMMENTS)))
    return m.System(elements, syncs, comment=draw(COMMENTS))  # type: ignore[arg-type]


METADATA = st.builds(m.Metadata, COMMENTS, COMMENTS, COMMENTS, COMMENTS, COMMENTS)
DATATYPES = st.builds(
    m.Datatype, NAMES, some(st.builds(m.DatatypeMember, NAMES, TYPES, comment=COMMENTS)), comment=COMMENTS
)
MODELS = st.builds(
    m.Model,
    st.sampled_from(m.ModelType),
    some(AUTOMATA),
    systems(),
    NAMES,
    some(st.sampled_from(["arrays", "x-mine"])).map(lambda names: tuple(dict.fromkeys(names))),
    st.none() | METADATA,
    some(st.builds(m.Constant, NAMES, TYPES, st.none() | EXPRESSIONS, comment=COMMENTS)),
    VARIABLE_LISTS,
    some(st.builds(m.Action, NAMES, comment=COMMENTS)),
    some(DATATYPES),
    FUNCTION_LISTS,
    CLAUSES,
    some(PROPERTIES),
)
