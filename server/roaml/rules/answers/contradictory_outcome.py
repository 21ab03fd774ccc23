# SPDX-License-Identifier: Apache-2.0
"""The rule `contradictory-outcome`, which contradictory_outcome.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Binary, Boolean, Expr, Name, Unary
from roaml.model.machine import Assign, Chart, Handler, If, ReturnStatus, RosSend, Send, State, Statement
from roaml.model.syntax import Expression
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule, replacements
from roaml.rules.support.alternatives import handlers_by_trigger
from roaml.rules.support.words import NEGATIVE, words_of
from roaml.text import Span, TextEdit

SUCCESS, FAILURE, RUNNING = "SUCCESS", "FAILURE", "RUNNING"

_OUTCOMES = {
    **dict.fromkeys(("success", "succeed", "succeeded", "successful"), SUCCESS),
    **dict.fromkeys(("failure", "fail", "failed"), FAILURE),
    "running": RUNNING,
}
"""A word in the name of a state or constant -> the outcome that it names."""

_NEUTRAL = frozenset(
    ("action", "answer", "reply", "report", "return", "respond", "response", "result", "send", "skill", "state", "tick")
)
"""Words that a name of a state may have besides its outcome. Others may change its meaning, as in `check_failure`."""

_OK = frozenset(("ok", "success", "succeeded", "successful"))
"""Words in the names of received fields that are true after a success."""

_DONE = frozenset(("complete", "completed", "done", "finished"))
"""Words in the names of received fields that are false as long as nothing has succeeded."""

_ASKING = (["are"], ["has"], ["is"], ["needs"])
"""First words in the names of conditions, which may ask for the opposite of a success, as in `IsBatteryLow`."""

_LACKING = frozenset(
    ("blocked", "critical", "empty", "expired", "late", "lost", "low", "missing", "occupied", "unknown")
)
"""Words in the names of conditions that ask for the opposite of a success."""

_RECEIVED = ("_res.", "_msg.", "_feedback.", "_wrapped_result.", "_event.data.")


def check(context: MachineContext) -> Iterator[Finding]:
    name = words_of(context.machine.name.value) if context.machine.name is not None else []
    if not NEGATIVE.isdisjoint(name) or (name[:1] in _ASKING and not _LACKING.isdisjoint(name)):
        return
    for chart in context.machine.charts:
        yield from _states(chart)
        outcomes = {state.id.value: outcome for state in chart.states if state.id and (outcome := _outcome(state))}
        fields = _fields(chart)
        for state in chart.states:
            for group in handlers_by_trigger(context.machine, state):
                ways = [(handler.cond, _after(handler, outcomes)) for handler in group]
                yield from _conditions(ways, fields)
                # mixed-names reports handlers that return the status of another one.
                yield from _comparisons([w for w, h in zip(ways, group, strict=True) if not _returns(h)])
        for statement in chart.statements:
            if isinstance(statement, If):
                bodies = [(branch.cond, branch.body) for branch in statement.branches]
                if statement.otherwise is not None:
                    bodies.append((None, statement.otherwise.body))
                ways = [(cond, _only(_sent(body))) for cond, body in bodies]
                yield from (*_conditions(ways, fields), *_comparisons(ways))


# ------------------------------------------------------------------- states


class _Sent(NamedTuple):
    """A status that is sent or returned: the name of the constant, and the outcome that it names."""

    name: str
    span: Span
    outcome: str


def _states(chart: Chart) -> Iterator[Finding]:
    """Report statuses that a state sends although it is named after another outcome, which it never sends."""
    names = {data.id.value for data in chart.data if data.id is not None}
    for state in chart.states:
        named = _named(state)
        entry = list(_sent(state.entry.statements)) if state.entry is not None else []
        # In a state named after an outcome, an earlier answer may be RUNNING, and a running node may end.
        sent = (
            entry
            if named == RUNNING
            else [*entry, *(s for h in state.handlers for t in h.targets for s in _sent(t.body))]
        )
        if named is None or state.id is None or any(status.outcome == named for status in sent):
            continue
        for status in sent:
            if named != RUNNING and status.outcome == RUNNING:
                continue
            meant = _like(status.name, status.outcome, named)
            fixes = replacements(status.span, (meant,)) if meant in names or status.name == status.outcome else ()
            message = f"the state `{state.id.value}` answers {status.outcome} here; did you mean {named}?"
            yield RULE.at(status.span, message, *fixes, related=[Related(state.id.span, f"named after {named}")])


def _like(name: str, outcome: str, meant: str) -> str:
    return name.removesuffix(outcome) + meant if name.endswith(outcome) else ""


def _named(state: State) -> str | None:
    """The outcome after which a state is named."""
    words = words_of(state.id.value) if state.id is not None else []
    outcomes = [_OUTCOMES[word] for word in words if word in _OUTCOMES]
    return outcomes[0] if len(outcomes) == 1 and all(w in _OUTCOMES or w in _NEUTRAL for w in words) else None


def _outcome(state: State) -> str | None:
    """The outcome after which a state is named, or that it sends as soon as it is entered."""
    return _named(state) or (_only(_sent(state.entry.statements)) if state.entry is not None else None)


def _sent(body: Sequence[Statement]) -> Iterator[_Sent]:
    """The statuses that a body always sends or returns."""
    for statement in body:
        match statement:
            case ReturnStatus(status=status) if status is not None and status.value in (SUCCESS, FAILURE, RUNNING):
                yield _Sent(status.value, status.span, status.value)
            case Send(params=params) | RosSend(fields=params):
                for value in (param.value for param in params if isinstance(param.value, Expression)):
                    tree = value.tree
                    words = words_of(tree.name) if isinstance(tree, Name) and tree.name.isupper() else []
                    outcome = words[-1].upper() if words else ""
                    if isinstance(tree, Name) and outcome in (SUCCESS, FAILURE, RUNNING):
                        yield _Sent(tree.name, value.span, outcome)


def _only(sent: Iterator[_Sent]) -> str | None:
    outcomes = {status.outcome for status in sent}
    return outcomes.pop() if len(outcomes) == 1 else None


# --------------------------------------------------------------- conditions


def _fields(chart: Chart) -> dict[str, tuple[str, Span]]:
    """Variable -> the name of the received field that it holds, and where it gets it. Other assignments may give it
    `true` or `false`."""
    fields: dict[str, set[str]] = {}
    places: dict[str, Span] = {}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None:
            name, value = place_of(statement.location.tree), statement.value
            if name is None or (isinstance(value, Expression) and isinstance(value.tree, Boolean)):
                continue
            place = place_of(value.tree) if isinstance(value, Expression) else None
            fields.setdefault(name, set()).add(_field(place) if place is not None else "")
            places.setdefault(name, statement.element.name_span)
    return {name: (next(iter(f)), places[name]) for name, f in fields.items() if len(f) == 1 and "" not in f}


def _field(place: str) -> str:
    return place.rpartition(".")[2] if place.startswith(_RECEIVED) else ""


def _returns(handler: Handler) -> bool:
    return any(isinstance(statement, ReturnStatus) for target in handler.targets for statement in target.body)


def _after(handler: Handler, outcomes: Mapping[str, str]) -> str | None:
    """The outcome of what a handler does: what all its targets send, or the states to which they lead."""
    after = {
        _only(_sent(target.body)) or outcomes.get(target.state.value if target.state is not None else "")
        for target in handler.targets
    }
    return after.pop() if len(after) == 1 else None


_Ways = Sequence[tuple["Expression | None", "str | None"]]
"""Conditions that are tested in order, each with the outcome of what is done if it holds."""


def _conditions(ways: _Ways, fields: Mapping[str, tuple[str, Span]]) -> Iterator[Finding]:
    """Report the first condition if it is about the success of something and leads to a failure, or the other way
    round, either itself or, if there is only one other way, without a condition, in that one."""
    if not ways or ways[0][0] is None or ways[0][0].broken:
        return
    cond, after = ways[0]
    other = ways[1][1] if len(ways) == 2 and ways[1][0] is None else None
    assert cond is not None
    tested, positive = _tested(cond.tree)
    field, place = fields.get(tested or "", (_field(tested or ""), None))
    words = {*words_of(field)}
    if tested is None or (after is not None and after == other):
        return
    is_wrong = False
    if words & _OK:
        good, bad = (after, other) if positive else (other, after)
        is_wrong = good == FAILURE or bad == SUCCESS
    elif words & _DONE:
        is_wrong = (other if positive else after) == SUCCESS
    if is_wrong:
        text = " ".join(cond.text.split())
        when = "after a success" if positive else "after a failure" if words & _OK else "before the end"
        leads = after if after is not None and (after == FAILURE) == positive else other
        message = (
            f"`{tested}` has the value of the received field `{field}`, so this condition holds {when}, and the "
            f"machine {'then' if leads == after else 'otherwise'} answers {leads}; did you mean `{_negated(text)}`?"
        )
        related = [Related(place, f"gets `{field}`")] if place is not None else []
        fix = Fix(f"Change to `{_negated(text)}`", (TextEdit(cond.span, _negated(text)),))
        yield RULE.at(cond.span, message, fix, related=related)


def _comparisons(ways: _Ways) -> Iterator[Finding]:
    """Report comparisons with a constant that is named after a success or failure, if the opposite is answered."""
    for cond, after in ways:
        tree = cond.tree if cond is not None and not cond.broken else None
        if cond is None or not isinstance(tree, Binary) or tree.operator is not Operator.EQUAL:
            continue
        for side in (tree.left, tree.right):
            words = words_of(side.name) if isinstance(side, Name) and side.name.isupper() else []
            tested = _OUTCOMES.get(words[-1]) if words else None
            if {tested, after} == {SUCCESS, FAILURE}:
                message = f"the machine answers {after} under this condition for {tested}; change one of them"
                yield RULE.at(cond.span, message)


def _tested(tree: Expr) -> tuple[str | None, bool]:
    """The place that a condition tests, and whether the condition holds if the place is true."""
    if isinstance(tree, Unary) and tree.operator is UnaryOperator.NOT:
        return place_of(tree.operand), False
    return place_of(tree), True


def _negated(text: str) -> str:
    return text.removeprefix("!").strip() if text.startswith("!") else f"!{text}"


RULE = Rule(
    "contradictory-outcome",
    Severity.WARNING,
    "A machine answers as after the opposite outcome.",
    machine=check,
    whole=True,
)
