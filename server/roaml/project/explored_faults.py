# SPDX-License-Identifier: Apache-2.0
"""The finding about an undefined operation, such as an index outside of its array, that a run of a system executes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.explicit.path import Path, path_to
from roaml.explicit.path_recorder import PathRecorder
from roaml.explicit.space import LimitError, Space, StateLimits, explore
from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, Index, walk
from roaml.interruption import checkpoint
from roaml.model.syntax import Expression
from roaml.model.system import System
from roaml.project.analysis import Analysis
from roaml.project.exploration import MAX_BYTES, MAX_STATES, MAX_STEPS
from roaml.record import Record
from roaml.rules.expressions import division_by_zero, index_out_of_bounds
from roaml.rules.properties import model_fault
from roaml.rules.rule import Rule
from roaml.scxml.names import CLOCK, CLOCK_VARIABLES
from roaml.smc.batch import TraceProblem
from roaml.smc.fault import FaultCode
from roaml.smc.model import ModelChecker
from roaml.smc.program import UNKNOWN
from roaml.smc.record import SELECTED, Recorder
from roaml.smc.story import build_story
from roaml.text import Location, Span
from roaml.views.ends import is_event
from roaml.views.parting import read_trace
from roaml.views.story import turn_line
from roaml.views.turn_words import details
from roaml.views.turns import Turn

MAX_TURNS = 4
"""The maximum number of turns that are shown, the last ones before the operation."""
MAX_SIMULATED = 150_000
"""The maximum number of steps of a simulated run that is recorded again."""
_RULES: dict[FaultCode, Rule] = {
    FaultCode.INDEX: index_out_of_bounds.RULE,
    FaultCode.EMPTY: index_out_of_bounds.RULE,
    FaultCode.DIVISION: division_by_zero.RULE,
}
"""The rules that report such an operation without an exploration. `model-fault` reports the others."""


class FaultyRun(Record, frozen=True):
    """A run of a system that executes an undefined operation.

    Attributes:
        checker: the model of the system.
        problem: the operation.
        recorder: records the run again.
        trace: the number of the run, for the recorder.
    """

    checker: ModelChecker
    problem: TraceProblem
    recorder: Recorder
    trace: int


def searched_run(space: Space) -> FaultyRun:
    """The run to an undefined operation that has ended a search."""
    space = _with_all_steps(space)
    assert space.problem is not None
    root, steps = path_to(space, space.fault_at)
    path = Path(space.fault_at, tuple(steps), UNKNOWN, is_end=False, root=space.roots.index(root))
    recorder = PathRecorder(space.checker, space.compiled_property, path)
    return FaultyRun(space.checker, space.problem, recorder, SELECTED)


def simulated_run(checker: ModelChecker, problem: TraceProblem) -> FaultyRun:
    """A simulated run to an undefined operation."""
    return FaultyRun(checker, problem, Recorder(checker, checker.stuck, 0, MAX_SIMULATED), problem.trace)


def finding_about_fault(analysis: Analysis, path: str, system: System, run: FaultyRun) -> Iterator[tuple[str, Finding]]:
    """The path of a file, and the finding in it, for a run that executes an undefined operation.

    Args:
        path: the path of the system file.
    """
    fault, code = run.checker.fault(run.problem), FaultCode(run.problem.code)
    if fault.origin is None:
        return
    span = fault.origin.span
    if fault.origin.path in analysis.machines_in(system):
        span = _place(analysis, path, fault.origin, code)
    rule, severity, remedy = _RULES.get(code, model_fault.RULE), Severity.ERROR, ""
    if code is FaultCode.INDEX and run.problem.size == system.parameters.max_array_size:
        # The limit belongs to the translation, not to the user's array, and the run may be longer than what matters.
        severity, remedy = Severity.INFORMATION, " (`max_array_size`)"
    message = f"a run of this system executes this undefined operation: {fault.message}{remedy}"
    yield fault.origin.path, rule.at(span, message, severity=severity, related=tuple(_trace(run)))


def _with_all_steps(space: Space) -> Space:
    """A search that has left out no steps, whose trace is a shortest one; the search itself if that is too long."""
    if not space.is_reduced:
        return space
    limits = StateLimits(MAX_STATES, MAX_BYTES, transitions=MAX_STEPS)
    try:
        found = explore(space.checker, space.compiled_property, limits, lambda _: checkpoint())
    except LimitError:
        return space
    return space if found.problem is None else found


def _place(analysis: Analysis, path: str, origin: Location, code: FaultCode) -> Span:
    """The part of an expression that is undefined; the whole expression, or the element, if there are several."""
    values = [
        value
        for value in analysis.typed_in(origin.path, path).values
        if isinstance(value.value, Expression) and value.element.span == origin.span
    ]
    expressions = [value.value for value in values if isinstance(value.value, Expression)]
    parts = [(part, expression) for expression in expressions for part in _parts(expression.tree, code)]
    if code is FaultCode.INDEX:
        parts = [(part, expression) for part, expression in parts if constant(part) is None] or parts
    if len(parts) == 1:
        return parts[0][0].span
    around = {expression.span for _, expression in parts} or {expression.span for expression in expressions}
    if len(around) == 1:
        return around.pop()
    document = analysis.document(origin.path)
    elements = () if document is None else document.path_at(origin.span.start + 1)
    return next((element.name_span for element in elements if element.span == origin.span), origin.span)


def _parts(tree: Expr, code: FaultCode) -> Sequence[Expr]:
    """The parts of an expression that may be undefined in this way."""
    match code:
        case FaultCode.INDEX | FaultCode.EMPTY:
            return [node.index for node in walk(tree) if isinstance(node, Index)]
        case FaultCode.DIVISION:
            operators = (Operator.DIVIDE, Operator.REMAINDER)
            return [node.right for node in walk(tree) if isinstance(node, Binary) and node.operator in operators]
        case _:
            return [tree]


def _trace(run: FaultyRun) -> Iterator[Related]:
    """What machines do last before the operation."""
    checker = run.checker
    has_clock = {storage.name for storage in run.recorder.shared}.issuperset(CLOCK_VARIABLES)
    story = build_story(run.recorder, run.trace, CLOCK_VARIABLES if has_clock else None)
    events = {automaton.name for automaton in checker.model.automata if is_event(automaton)}
    shown = [turn for turn in read_trace(story).turns if _is_shown(turn, events)]
    for turn in shown[-MAX_TURNS:]:
        line = turn_line(turn, lambda _: "")
        effects = f" ({', '.join(line.details)})" if line.details else ""
        when = f"{line.time}: " if line.time else ""
        if line.origin is not None:
            yield Related(line.origin, f"{when}{line.who} {line.what}{effects}")


def _is_shown(turn: Turn, events: set[str]) -> bool:
    is_silent = turn.heard is None and not any(details(turn))
    return turn.origin is not None and turn.automaton != CLOCK and turn.automaton not in events and not is_silent
