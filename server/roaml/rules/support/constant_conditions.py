# SPDX-License-Identifier: Apache-2.0
"""The conditions of a machine whose results are constant because of the values of its own variables."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

from roaml.diagnostics import Fix, Related, Severity
from roaml.expr.tree import Expr, Member, Name, walk
from roaml.model.behavior.explore import condition_facts
from roaml.model.behavior.knowledge import NOTHING, ConditionFacts, variables_in
from roaml.model.machine import Assign, Chart, Handler, If, State
from roaml.model.syntax import Expression
from roaml.model.triggers import trigger
from roaml.model.values.analyse import ChartValues, MachineValues, analyse
from roaml.model.values.arriving import arriving_by_type
from roaml.model.values.describe import described, is_informative
from roaml.model.values.domain import FALSE, TRUE, ValueSet
from roaml.model.values.evaluate import place_of
from roaml.record import Record
from roaml.rules.rule import MachineContext, listing
from roaml.rules.support.assignments import is_unchanged
from roaml.rules.support.triggers import awaited
from roaml.text import Span

MAX_TRIED = 8
"""The maximum number of conditions that are examined as the cause of the others."""


MAX_NAMED = 3
"""The maximum number of variables whose values a message states."""


_WITHOUT_EFFECT = "it has no effect; later ones are never tested"
_TAKEN_AT_ONCE = (
    "the transition is taken at once and the state never waits for {names}; check what assigns the variables, or give "
    "the transition an `event`"
)


class ConstantPart(Record, frozen=True):
    """A condition, or a part of one, that always has the same result.

    Attributes:
        span: the place to report.
        message: what it is, and why.
        is_true: the result, if other rules depend on it.
        severity: the severity, if it is not that of the rule.
    """

    span: Span
    message: str
    is_true: bool | None = None
    fixes: tuple[Fix, ...] = ()
    related: tuple[Related, ...] = ()
    severity: Severity | None = None


def constant_conditions(context: MachineContext, machine: MachineValues) -> dict[Span, ConstantPart]:
    """The conditions of a machine that are constant because of the values of its own variables, or contradict
    themselves, by their places."""
    parts: list[ConstantPart] = []
    for chart in context.machine.charts:
        values = machine.charts.get(chart.scope)
        if values is None:
            continue
        facts = condition_facts(chart)
        unjudged = _unjudged(context, chart)
        for state in chart.states:
            for handlers in _groups(context, state):
                names = awaited(state) if handlers[0].trigger is None else ()
                always = _TAKEN_AT_ONCE.format(names=listing(names)) if names else _WITHOUT_EFFECT
                effects = "the transition is never taken", always
                parts += _first(values, facts, [h.cond for h in handlers], effects, unjudged)
        for statement in chart.statements:
            if isinstance(statement, If):
                effects = "the branch is never executed", _WITHOUT_EFFECT
                parts += _first(values, facts, [b.cond for b in statement.branches], effects, unjudged)
    return {part.span: part for part in parts}


def find_causes(context: MachineContext, constant: Mapping[Span, ConstantPart]) -> Collection[Span]:
    """The conditions that are constant by themselves. Others are constant only because one of these is: a part that is
    never executed assigns no values."""
    arriving = arriving_by_type(context.machine, context.interface)

    def constant_without(ignored: frozenset[Span]) -> Collection[Span]:
        relaxed = analyse(context.machine, context.typed, arriving, ignored)
        return constant_conditions(context, relaxed).keys() & constant.keys()

    causes = constant_without(frozenset(constant))
    if causes:
        return causes
    # Each one is constant because of another one: the cause is the one without which the fewest others are constant.
    tried = list(constant)[:MAX_TRIED]
    return (min(tried, key=lambda span: len(constant_without(frozenset((span,))))),)


def _unjudged(context: MachineContext, chart: Chart) -> frozenset[str]:
    """The variables whose values are not a reason to report a condition: those that are assigned to themselves, which
    self-assignment reports and, in a machine without a system, which may not be finished, those that are never
    assigned."""
    assignments = [s for s in chart.statements if isinstance(s, Assign) and s.location is not None]
    unchanged = variables_in(s.location.tree for s in assignments if s.location is not None and is_unchanged(s))
    if context.system is not None:
        return unchanged
    assigned = variables_in(s.location.tree for s in assignments if s.location is not None)
    return unchanged | {data.id.value for data in chart.data if data.id and data.id.value not in assigned}


def _groups(context: MachineContext, state: State) -> Iterable[list[Handler]]:
    """The handlers of a state, grouped by their triggers."""
    groups: dict[object, list[Handler]] = {}
    for number, handler in enumerate(state.handlers):
        if handler.effective:
            key = trigger(context.machine, handler)
            groups.setdefault(number if key is None else key, []).append(handler)
    return groups.values()


def _first(
    values: ChartValues,
    facts: ConditionFacts,
    conditions: Iterable[Expression | None],
    effects: tuple[str, str],
    unjudged: frozenset[str],
) -> Iterator[ConstantPart]:
    """The conditions that are never true, up to the first one that is always true: the conditions after it are
    not tested.

    Args:
        effects: what follows from a condition that is never true, and from one that is always true.
    """
    never, always = effects
    for cond in conditions:
        names = variables_in((cond.tree,)) if cond is not None else frozenset()
        if cond is None or cond.broken or not names:
            continue
        results = values.conditions.get(cond.span)
        if results is None:
            continue
        contradicts = not any(facts.assume(NOTHING, cond.tree))
        if names & unjudged and not contradicts:
            continue
        if results.alone == FALSE or contradicts:
            why = values_in(values, cond.tree) or ("its parts contradict each other" if contradicts else "")
            message = f"this condition is never true{because(why)}, so {never}"
            yield ConstantPart(cond.span, message, is_true=False)
        elif results.alone == TRUE:
            why = values_in(values, cond.tree)
            message = f"this condition is always true{because(why)}, so {always}"
            yield ConstantPart(cond.span, message, is_true=True)
            return


def because(reason: str) -> str:
    """The reason of a result, as a part of a message; nothing without one."""
    return f": {reason}" if reason else ""


def values_in(values: ChartValues, tree: Expr) -> str:
    """The values of the variables in a condition, where the values are known."""
    places = ((place_of(node), node) for node in walk(tree) if isinstance(node, Name | Member))
    known = ((place, values.at(node)) for place, node in places if place is not None)
    return stated_values((place, at) for place, at in known if at is not None)


def stated_values(known: Iterable[tuple[str, ValueSet]]) -> str:
    """The names and values of the first variables whose values are informative."""
    texts = dict.fromkeys(
        f"`{name}` is {'always ' if values.value is not None else ''}{described(values)}"
        for name, values in known
        if is_informative(values)
    )
    return ", ".join(list(texts)[:MAX_NAMED])
