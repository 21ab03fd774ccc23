# SPDX-License-Identifier: Apache-2.0
"""The rule `never-reset`, which never_reset.md describes."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import first_in
from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Boolean, Expr, Name
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import Assign, Chart, Data, Handler, If, Machine, State, Statement, bodies, statements
from roaml.model.syntax import Expression
from roaml.model.triggers import trigger
from roaml.model.values.domain import ValueSet
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.one_way_values import REACHED, one_way_values
from roaml.rules.support.steps import step_of
from roaml.rules.support.words import words_of


def check(context: MachineContext) -> Iterator[Finding]:
    if context.system is None:
        return
    for chart in context.machine.charts:
        assigned = _assigned(chart)
        yield from _counters(chart, assigned)
        yield from _loops(context.machine, chart, assigned)
        yield from _phases(context.machine, chart)
        yield from _flags(context.machine, chart, assigned)
        yield from _latches(context, chart, assigned)
        yield from _resets(context, chart, assigned)
        for found in one_way_values(context, chart):
            yield RULE.at(found.span, found.message, related=found.related)


class _Assigned(NamedTuple):
    """An assignment to a variable, with its state, its handler and its value."""

    state: State
    handler: Handler | None
    statement: Assign
    value: Expr | None


def _assigned(chart: Chart) -> dict[str, list[_Assigned]]:
    """Variable -> all assignments to it or to a part of it."""
    result: dict[str, list[_Assigned]] = {}
    for state, handler, body in bodies(chart):
        for statement in statements(body):
            if isinstance(statement, Assign) and statement.location is not None:
                tree, value = statement.location.tree, statement.value
                expr = value.tree if isinstance(value, Expression) and not value.broken else None
                if isinstance(tree, Name):
                    result.setdefault(tree.name, []).append(_Assigned(state, handler, statement, expr))
    return result


# ---------------------------------------------------------------- counters


def _counters(chart: Chart, assigned: Mapping[str, Sequence[_Assigned]]) -> Iterator[Finding]:
    """Report a limit up to which a machine counts in a state, if it can leave the state and enter it again, and nothing
    resets the counter: the second time, it does not wait."""
    for name, steps in assigned.items():
        signs = {step_of(step.value, name) if step.value is not None else 0 for step in steps}
        states = {id(step.state) for step in steps}
        if len(states) != 1 or len(signs) != 1 or 0 in signs:
            continue
        state, (sign,) = steps[0].state, signs
        for cond, following in _tests(state, [step.statement for step in steps]):
            if _counts_requests(chart, state, [step.handler for step in steps]):
                continue
            if _is_limit(cond.tree, name, sign) and _returns(chart, state, following):
                message = (
                    f"nothing resets `{name}` when it has reached this limit, so it is still there when the machine "
                    "enters the state again; assign the initial value"
                )
                related = [Related(step.statement.element.name_span, "counted here") for step in steps]
                yield RULE.at(cond.span, message, related=related, severity=_severity(name, _POSITIONS | _ONCE))


def _counts_requests(chart: Chart, state: State, counting: Iterable[Handler | None]) -> bool:
    """Whether a machine counts once for each request, goal or tick: `photos` on a card that nobody empties. Then the
    limit is one for all of them together."""
    handlers = [handler for handler in counting if handler is not None]
    if not handlers or any(handler.trigger is not None for handler in handlers):
        return False
    following = [end for handler in handlers for end in _ends(handler)]
    return not _returns(chart, state, following, without=_ASKED)


_ASKED = (ProtocolPart.REQUEST, ProtocolPart.GOAL, ProtocolPart.BT_TICK)
"""With what another machine asks for something."""


def _loops(machine: Machine, chart: Chart, assigned: Mapping[str, Sequence[_Assigned]]) -> Iterator[Finding]:
    """Report the condition of a timer that counts up to a limit and leaves the state there, if the machine can enter
    the state again, and all assignments lead towards the limit or behind the initial value."""
    initial = {data.id.value: data.value for data in chart.data if data.id is not None}
    for state in chart.states:
        for handler, _, name, limit in _counting(machine, chart, state):
            steps, begin = assigned.get(name, ()), initial.get(name)
            start = constant(begin.tree) if isinstance(begin, Expression) else None
            values = [(constant(s.value), step_of(s.value, name)) for s in steps if s.value is not None]
            if start is None or len(values) != len(steps):
                continue
            if any(s.handler is not handler and s.state is not state for s in steps):
                continue
            if not all(step > 0 or (number is not None and number > start) for number, step in values):
                continue
            message = (
                f"nothing resets `{name}`, so the next time in this state it is still at the limit, and the machine "
                "leaves the state at once; assign the initial value"
            )
            related = [Related(step.statement.element.name_span, "counted here") for step in steps]
            yield RULE.at(limit.span, message, related=related, severity=_severity(name, _POSITIONS | _ONCE))


def _phases(machine: Machine, chart: Chart) -> Iterator[Finding]:
    """Report the handler of a timer that leaves a state in which the machine counts, and does not reset the counter,
    before a state that counts up to the same limit or a lower one, although another such handler resets it. A higher
    limit may be a later time on the same clock."""
    loops = [(state, *loop) for state in chart.states for loop in _counting(machine, chart, state)]
    for name in {name: None for _, _, _, name, _ in loops}:
        own = [(state, leaving, limit) for state, _, leaving, of, limit in loops if of == name]
        resets = [leaving for _, leaving, _ in own if any(_sets(t.body, name) for t in leaving.targets)]
        limits = {id(state): _number(limit) for state, _, limit in own}
        if len(own) < 2 or not resets:
            continue
        for state, leaving, limit in own:
            end = limits[id(state)]
            entered = None if leaving in resets else _continued(chart, state, leaving, name, limits)
            later = limits[id(entered)] if entered is not None else None
            if (
                entered is not None
                and entered.id is not None
                and end is not None
                and later is not None
                and later <= end
            ):
                message = (
                    f"nothing resets `{name}` here, so it is already at the limit in the state `{entered.id.value}`, "
                    "which does not wait; assign the initial value, as where the machine leaves the other states"
                )
                related = [Related(limit.span, "the limit"), Related(resets[0].element.name_span, "reset here")]
                yield RULE.at(leaving.element.name_span, message, related=related)


def _number(limit: Expression) -> float | None:
    return constant(limit.tree.right) if isinstance(limit.tree, Binary) else None


def _continued(chart: Chart, state: State, leaving: Handler, name: str, counting: Collection[int]) -> State | None:
    """The state, one of those with the ids `counting`, that a machine enters after a handler without having assigned a
    variable."""
    states = {other.id.value: other for other in chart.states if other.id is not None}
    if state.exit is not None and _sets(state.exit.statements, name):
        return None
    todo = _unset_targets(leaving, name)
    seen: set[str] = set()
    while todo:
        entered = states.get(todo.pop())
        if entered is None or entered.id is None or entered.id.value in seen:
            continue
        seen.add(entered.id.value)
        if entered.entry is not None and _sets(entered.entry.statements, name):
            continue
        if id(entered) in counting:
            return entered
        if entered.exit is None or not _sets(entered.exit.statements, name):
            todo += [following for handler in entered.handlers for following in _unset_targets(handler, name)]
    return None


def _unset_targets(handler: Handler, name: str) -> list[str]:
    return [t.state.value for t in handler.targets if t.state is not None and not _sets(t.body, name)]


def _sets(body: tuple[Statement, ...], name: str) -> bool:
    """Whether a body assigns a variable."""
    return any(
        isinstance(s, Assign) and s.location is not None and name in variables_in((s.location.tree,))
        for s in statements(body)
    )


_REPEATED = (ProtocolPart.TICK, ProtocolPart.BT_TICK)
"""What arrives again and again while a machine counts."""


def _counting(machine: Machine, chart: Chart, state: State) -> Iterator[tuple[Handler, Handler, str, Expression]]:
    """The handlers of timers and ticks that count while a variable is less than a limit, each with the handler that
    leaves the state, the variable and the condition, if the next handler for the same trigger leaves the state in which
    the machine may later be again. Other targets than the one that counts may lead anywhere."""
    own = state.id.value if state.id is not None else ""
    repeated = [h for h in state.handlers if h.trigger in _REPEATED]
    for handler, following in itertools.pairwise(repeated):
        test = handler.cond.tree if handler.cond is not None and not handler.cond.broken else None
        ends = [target.state.value if target.state is not None else "" for target in following.targets]
        if handler.cond is None or not isinstance(test, Binary) or not isinstance(test.left, Name):
            continue
        counting = [target for target in handler.targets if _counts(target.body, test.left.name)]
        stays = all(target.state is not None and target.state.value == own for target in counting)
        is_alike = trigger(machine, handler) == trigger(machine, following)
        is_limit = test.operator in (Operator.LESS, Operator.LESS_EQUAL) and counting and stays and is_alike
        if is_limit and own not in ends and _returns(chart, state, ends):
            yield handler, following, test.left.name, handler.cond


def _counts(body: tuple[Statement, ...], name: str) -> bool:
    """Whether a body increases a variable, whatever its conditions are."""
    return any(
        isinstance(s, Assign) and isinstance(s.value, Expression) and step_of(s.value.tree, name) > 0 for s in body
    )


def _is_limit(tree: Expr, name: str, sign: int) -> bool:
    return (
        isinstance(tree, Binary)
        and isinstance(tree.left, Name)
        and tree.left.name == name
        and tree.operator in REACHED[sign]
    )


def _tests(state: State, steps: Sequence[Assign]) -> Iterator[tuple[Expression, Sequence[str]]]:
    """The conditions under which the machine does not count: those of transitions that leave the state, and those of an
    `<if>` that counts in another branch. Each has the states that follow."""
    own = state.id.value if state.id is not None else ""
    for handler in state.handlers:
        targets = [target.state.value if target.state else "" for target in handler.targets]
        counts = any(step in statements(target.body) for target in handler.targets for step in steps)
        if handler.cond is not None and own not in targets and not counts:
            yield handler.cond, targets
    following = [name for name in _next(state) if name != own]
    for body in _bodies_of(state):
        for statement in statements(body):
            if isinstance(statement, If):
                parts = [part for part in (*statement.branches, statement.otherwise) if part is not None]
                counting = [part for part in parts if any(inner in steps for inner in statements(part.body))]
                for branch in statement.branches if counting else ():
                    if branch.cond is not None and branch not in counting:
                        yield branch.cond, following


def _bodies_of(state: State) -> Iterator[tuple[Statement, ...]]:
    if state.entry is not None:
        yield state.entry.statements
    for handler in state.handlers:
        for target in handler.targets:
            yield target.body


def _returns(
    chart: Chart, state: State, following: Sequence[str], without: Collection[ProtocolPart | None] = ()
) -> bool:
    """Whether a machine can enter `state` again from one of the states `following`.

    Args:
        without: the triggers of handlers that are not taken.
    """
    states = {other.id.value: other for other in chart.states if other.id is not None}
    own = state.id.value if state.id is not None else ""
    todo = list(following)
    seen: set[str] = set()
    while todo:
        name = todo.pop()
        if name == own:
            return True
        if name not in seen and name in states:
            seen.add(name)
            todo += _next(states[name], without)
    return False


def _next(state: State, without: Collection[ProtocolPart | None] = ()) -> list[str]:
    taken = [handler for handler in state.handlers if handler.effective and handler.trigger not in without]
    return [t.state.value for handler in taken for t in handler.targets if t.state]


# ------------------------------------------------------------------- flags


_RECORDS = frozenset(
    [
        "any",
        "calibrated",
        "configured",
        "emergency",
        "ever",
        "failed",
        "had",
        "happened",
        "has",
        "homed",
        "initialized",
        "known",
        "latched",
        "localized",
        "received",
        "seen",
        "tripped",
        "violated",
        "visited",
        "was",
    ]
)
_POSITIONS = frozenset(["altitude", "angle", "floor", "height", "pos", "position", "x", "y", "z"])
_ONCE = frozenset(["boot", "startup", "total", "warmup"])
"""Words in the names of flags that record what has happened, of what stays where it is, and of what is counted once."""


def _severity(name: str, words: frozenset[str]) -> Severity | None:
    return None if words.isdisjoint(words_of(name)) else Severity.INFORMATION


def _flags(machine: Machine, chart: Chart, assigned: Mapping[str, Sequence[_Assigned]]) -> Iterator[Finding]:
    """Report a flag that several handlers set and none clears. One that is set in one place, or by one event in several
    states, may record that something has happened; one that each of several events sets if its data have certain
    values may stop the machine for good."""
    for data in chart.data:
        if data.id is None or not isinstance(data.value, Expression) or not isinstance(data.value.tree, Boolean):
            continue
        values = assigned.get(data.id.value, [])
        constants = {value.value.value if isinstance(value.value, Boolean) else None for value in values}
        places = {id(value.handler or value.state) for value in values}
        events = {trigger(machine, v.handler) if v.handler is not None else None for v in values}
        states = {id(v.state) for v in values}
        is_known = len(events) == 1 and None not in events and len(states) == len(places)
        is_latch = len(events) == len(values) and all(_is_conditional(value) for value in values)
        if len(places) > 1 and not is_known and not is_latch and constants == {not data.value.tree.value}:
            yield _flag(data, data.id.value, not data.value.tree.value, values)


def _is_conditional(assigned: _Assigned) -> bool:
    """Whether what arrives must have certain values to set a variable."""
    if assigned.handler is None:
        return False
    body = [inner for target in assigned.handler.targets for inner in statements(target.body)]
    branches = [branch for inner in body if isinstance(inner, If) for branch in inner.branches]
    inside = [branch.cond for branch in branches if assigned.statement in statements(branch.body)]
    conditions = [cond.tree for cond in (assigned.handler.cond, *inside) if cond is not None and not cond.broken]
    return any(name.startswith("_") for name in variables_in(conditions))


def _latches(context: MachineContext, chart: Chart, assigned: Mapping[str, Sequence[_Assigned]]) -> Iterator[Finding]:
    """Report the condition with which a machine leaves a state when a message has set a flag there, if it can enter the
    state again, and nothing changes the flag back: the second time, the machine does not wait for the message."""
    values = context.values.charts.get(chart.scope)
    for data in chart.data if values is not None else ():
        begin = data.value.tree if isinstance(data.value, Expression) and not data.value.broken else None
        if data.id is None or not isinstance(begin, Boolean):
            continue
        name = data.id.value
        sets = assigned.get(name, ())
        states = {id(s.state) for s in sets}
        changed = {None if s.value is None or values is None else _only(values.at(s.value)) for s in sets}
        if len(states) != 1 or changed != {not begin.value}:
            continue
        state, own = sets[0].state, sets[0].state.id.value if sets[0].state.id is not None else ""
        if any(s.handler is None or own not in _ends(s.handler) for s in sets):
            continue
        for handler in state.handlers:
            tree = handler.cond.tree if handler.cond is not None and not handler.cond.broken else None
            is_left = isinstance(tree, Name) and tree.name == name and own not in _ends(handler)
            if begin.value or not is_left or handler.cond is None or not _returns(chart, state, _ends(handler)):
                continue
            message = (
                f"nothing resets `{name}`, so the next time in this state it is still true, and the machine does not "
                "wait; assign false when the state is left or entered"
            )
            related = [Related(s.statement.element.name_span, "set here") for s in sets]
            yield RULE.at(handler.cond.span, message, related=related, severity=_severity(name, _RECORDS))


# ------------------------------------------------------------------ resets

_MIN_STEM = 4
"""How many letters at the beginning words have in common that are forms of one word, such as `bump` and `bumped`."""


def _resets(context: MachineContext, chart: Chart, assigned: Mapping[str, Sequence[_Assigned]]) -> Iterator[Finding]:
    """Report the handler of a request or message to reset something, as its name says, that does not assign a flag or
    counter of this name, if all assignments lead away from its initial value."""
    for state in chart.states:
        for handler in state.handlers:
            words = words_of(handler.handle.value if handler.handle is not None else "")
            asked = [word for number, word in enumerate(words) if number and words[number - 1] == "reset"]
            if handler.handle is None or handler.trigger not in _ASKING or len(asked) != 1:
                continue
            named = [data for data in chart.data if data.id is not None and _is_about(asked[0], data.id.value)]
            kept = [data for data in named if _never_back(data, assigned)]
            resets = any(s.handler is handler for d in named if d.id for s in assigned.get(d.id.value, ()))
            if not asked[0].endswith("s") and (resets or len(kept) != 1):
                continue  # `reset_bump` is about one variable, `reset_counters` about all counters
            for data in kept:
                name = data.id.value if data.id is not None else ""
                message = f"this does not reset `{name}`, and nothing else does; assign the initial value"
                related = [Related(step.statement.element.name_span, "changes") for step in assigned[name]]
                yield RULE.at(handler.handle.span, message, *_assigning(context, handler, data), related=related)


def _assigning(context: MachineContext, handler: Handler, data: Data) -> Iterator[Fix]:
    """A fix that assigns the initial value of a variable at the beginning of a handler."""
    if data.id is None or not isinstance(data.value, Expression) or handler.element.find("target") is not None:
        return
    line = f'<assign location="{data.id.value}" expr="{data.value.text.strip()}" />'
    yield Fix(f"Reset `{data.id.value}`", (first_in(context.document, handler.element, line),))


_ASKING = (ProtocolPart.REQUEST, ProtocolPart.MESSAGE, ProtocolPart.EVENT)


def _is_about(word: str, name: str) -> bool:
    """Whether a name contains a form of `word`, such as `bumped` of `bump`, or `counter` of `counters`."""
    pairs = ((word, other) if len(word) < len(other) else (other, word) for other in words_of(name))
    return any(len(short) >= _MIN_STEM and long.startswith(short) for short, long in pairs)


def _never_back(data: Data, assigned: Mapping[str, Sequence[_Assigned]]) -> bool:
    """Whether all assignments to a variable are steps in one direction from a constant, or the opposite of its initial
    Boolean."""
    name = data.id.value if data.id is not None else ""
    steps = assigned.get(name, ())
    begin = data.value.tree if isinstance(data.value, Expression) and not data.value.broken else None
    if not steps:
        return False
    if isinstance(begin, Boolean):
        return all(isinstance(s.value, Boolean) and s.value.value is not begin.value for s in steps)
    if begin is None or constant(begin) is None:
        return False
    signs = {step_of(s.value, name) if s.value is not None else 0 for s in steps}
    return len(signs) == 1 and 0 not in signs


def _only(known: ValueSet | None) -> object:
    return known.value if known is not None else None


def _ends(handler: Handler) -> list[str]:
    return [target.state.value if target.state is not None else "" for target in handler.targets]


def _flag(data: Data, name: str, value: bool, values: Sequence[_Assigned]) -> Finding:
    assert data.id is not None
    word = "true" if value else "false"
    message = f"all assignments to `{name}` assign {word}, so it never changes back; change one of them, or reset it"
    related = [Related(other.statement.element.name_span, f"becomes {word}") for other in values]
    return RULE.at(data.id.span, message, related=related, severity=_severity(name, _RECORDS))


RULE = Rule(
    "never-reset",
    Severity.WARNING,
    "A counter or flag is not reset.",
    machine=check,
    whole=True,
)
