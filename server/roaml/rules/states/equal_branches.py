# SPDX-License-Identifier: Apache-2.0
"""The rule `equal-branches`, which equal_branches.md describes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Name
from roaml.expr.types import ScalarKind, is_kind
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import (
    Assign,
    Branch,
    Chart,
    Handler,
    If,
    ReturnHalted,
    ReturnStatus,
    RosSend,
    State,
    Statement,
    Target,
)
from roaml.model.syntax import Expression
from roaml.model.triggers import Trigger, trigger
from roaml.model.value_types import GOAL_STATUSES
from roaml.model.values.evaluate import place_of
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.words import words_of
from roaml.text import Span
from roaml.xml_syntax import Element, Text

_SUCCEEDED, _ABORTED = (
    next(code for code, name in GOAL_STATUSES.items() if name == status)
    for status in ("STATUS_SUCCEEDED", "STATUS_ABORTED")
)


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, If):
                yield from _branches(context, chart, statement)
        yield from _equal_states(chart)
        for state in chart.states:
            yield from _handlers(context, state)
            yield from _last_handlers(context, state)
            for handler in state.handlers:
                if handler.is_probabilistic:
                    yield from _targets(handler)


def _branches(context: MachineContext, chart: Chart, statement: If) -> Iterator[Finding]:
    parts = statement.parts
    contents = {_content(part.body) for part in parts}
    if statement.otherwise is not None and len(contents) == 1 and all(part.body for part in parts):
        message = "all branches of this `<if>` do the same, so its conditions have no effect"
        yield from _alike(message, [part.body[0].element.name_span for part in parts])
    elif len(parts) >= _MIN_CASES:
        types = context.typed.variables.get(chart.scope, {})
        real = {name for name, type_ in types.items() if is_kind(type_, ScalarKind.REAL)}
        repeated = list(_repeated(parts, real))
        yield from repeated or _repeated_steps(parts)
    elif len(parts) == 2 and statement.otherwise is not None:
        yield from _half_equal(chart, parts)


def _half_equal(chart: Chart, parts: Sequence[Branch]) -> Iterator[Finding]:
    """Report a constant that both branches assign to a variable, if they only assign constants to the same variables,
    and different ones to all others. If it gets another constant elsewhere, both branches may change it back."""
    first, second = (_assigned(part.body) for part in parts)
    if first.keys() != second.keys() or any(len(part.body) != len(first) for part in parts):
        return
    if any(variables_in((value.tree,)) for value in (*first.values(), *second.values())):
        return
    equal = [
        place for place, value in first.items() if "".join(value.text.split()) == "".join(second[place].text.split())
    ]
    if len(equal) == 1 and len(first) > 1 and not _changes(chart, equal[0], first[equal[0]]):
        message = (
            f"both branches of this `<if>` assign the same value to `{equal[0]}`, and different ones to the others"
        )
        yield from _alike(message, [first[equal[0]].span, second[equal[0]].span])


def _changes(chart: Chart, place: str, value: Expression) -> bool:
    """Whether a variable gets another constant than `value` somewhere."""
    known = [_assigned((s,)).get(place) for s in chart.statements if isinstance(s, Assign)]
    constants = {"".join(v.text.split()) for v in known if v is not None and not variables_in((v.tree,))}
    return bool(constants - {"".join(value.text.split())})


_MIN_CASES = 4
"""How many branches must assign different values before two equal ones are suspicious."""


def _repeated(parts: Sequence[Branch], real: Set[str]) -> Iterator[Finding]:
    """Report a value that two branches assign to a variable, while all others assign different ones. A repeated
    constant is only suspicious beside another variable that gets a different constant in each branch, and not if it is
    a coordinate or another real number (`real`): two of several places often have the same one."""
    assigned = [_assigned(part.body) for part in parts]
    places = [place for place in assigned[0] if all(place in values for values in assigned[:-1])]
    unique = set()
    repeated: list[tuple[str, list[Expression]]] = []
    for place in places:
        values = [values[place] for values in assigned if place in values]
        texts = Counter("".join(value.text.split()) for value in values)
        if len(texts) == len(values):
            unique.add(place)
        elif len(texts) == len(values) - 1:
            equal = [value for value in values if texts["".join(value.text.split())] > 1]
            repeated.append((place, equal))
    for place, equal in repeated:
        is_computed = all(variables_in((value.tree,)) for values in assigned for value in _at(values, place))
        is_measure = place in real or not _COORDINATES.isdisjoint(words_of(place)[-1:])
        if is_computed or (unique - {place} and not is_measure):
            message = (
                f"another branch of this `<if>` assigns the same value to `{place}`, and each of the others another"
            )
            yield from _alike(message, [value.span for value in equal])


def _repeated_steps(parts: Sequence[Branch]) -> Iterator[Finding]:
    """Report two branches that compute the same from variables, if each of the others computes something else."""
    if not all(part.body and all(_is_progress(statement) for statement in part.body) for part in parts):
        return
    contents = Counter(_content(part.body) for part in parts)
    if len(contents) == len(parts) - 1:
        message = "another branch of this `<if>` does the same, and each of the others something else"
        yield from _alike(message, [p.body[0].element.name_span for p in parts if contents[_content(p.body)] > 1])


_COORDINATES = frozenset(("x", "y", "z", "row", "column", "col"))


def _at(values: Mapping[str, Expression], place: str) -> tuple[Expression, ...]:
    return (values[place],) if place in values else ()


def _assigned(body: Sequence[Statement]) -> dict[str, Expression]:
    return {
        place: statement.value
        for statement in body
        if isinstance(statement, Assign) and isinstance(statement.value, Expression) and statement.location is not None
        if (place := place_of(statement.location.tree)) is not None
    }


def _handlers(context: MachineContext, state: State) -> Iterator[Finding]:
    """Report handlers for the same event, the last of which has no condition, and handlers for the success and the
    failure of a goal, if they do the same."""
    groups: dict[tuple[ProtocolPart | None, str, int], list[Handler]] = {}
    for handler in state.handlers:
        key = trigger(context.machine, handler)
        if key is not None and handler.effective and len(handler.targets) == 1:
            part, name, code = key
            groups.setdefault((part, name, 0 if part is ProtocolPart.RESULT else code), []).append(handler)
    for (part, _, _), handlers in groups.items():
        if len(handlers) < 2 or not handlers[0].targets[0].body:
            continue
        does = {(_state(handler), _content(handler.targets[0].body)) for handler in handlers}
        spans = [handler.targets[0].body[0].element.name_span for handler in handlers if handler.targets[0].body]
        if part is ProtocolPart.RESULT:
            codes = {handler.type.code for handler in handlers}
            ends = any(isinstance(s, ReturnHalted) for handler in handlers for s in handler.targets[0].body)
            is_progress = all(_is_progress(statement) for statement in handlers[0].targets[0].body)
            if len(does) == 1 and codes == {_SUCCEEDED, _ABORTED} and not ends and not is_progress:
                yield from _alike("the handlers for the success and the failure of this goal do the same", spans)
        elif len(does) == 1 and handlers[-1].cond is None and all(handler.cond for handler in handlers[:-1]):
            yield from _alike("all handlers of this event do the same, so their conditions have no effect", spans)


def _last_handlers(context: MachineContext, state: State) -> Iterator[Finding]:
    """Report the last condition among several on one event, or among eventless transitions, if the transition behind
    it, which has none, does the same. Transitions that only lead to the same state often list cases."""
    for handlers in _by_trigger(context, state).values():
        last, fallback = handlers[-2:] if len(handlers) > 2 else (None, None)
        if last is None or fallback is None or last.cond is None or fallback.cond is not None:
            continue
        if _lists_cases(handlers[:-1]):
            continue
        if all(target.body for target in last.targets[:1]) and _does(last) == _does(fallback):
            spans = [h.targets[0].body[0].element.name_span for h in (last, fallback)]
            yield from _alike("the last transitions do the same, so the condition of the first has no effect", spans)


def _lists_cases(handlers: Sequence[Handler]) -> bool:
    """Whether all conditions compare the same place with a constant each: the transition without a condition then often
    provides for values that should not occur, in the way of one that may."""
    places: set[str | None] = set()
    for handler in handlers:
        tree = handler.cond.tree if handler.cond is not None and not handler.cond.broken else None
        if not isinstance(tree, Binary) or tree.operator is not Operator.EQUAL:
            return False
        places.add(place_of(tree.left) or place_of(tree.right))
    return len(places) == 1 and None not in places


def _by_trigger(context: MachineContext, state: State) -> dict[Trigger, list[Handler]]:
    groups: dict[Trigger, list[Handler]] = {}
    for handler in state.handlers:
        if handler.effective and handler.targets:
            key = trigger(context.machine, handler)
            if key is not None:
                groups.setdefault(key, []).append(handler)
    return groups


def _does(handler: Handler) -> tuple[tuple[str | None, str | None, tuple[object, ...]], ...]:
    """What a handler does after its condition."""
    return tuple(
        (
            target.state.value if target.state is not None else None,
            target.probability.value if target.probability is not None else None,
            _content(target.body),
        )
        for target in handler.targets
    )


def _equal_states(chart: Chart) -> Iterator[Finding]:
    """Report two states that answer in the same way, with constants: one of them is probably a copy of the other. If
    other states give another answer, the two are often different reasons for the same answer."""
    alike: dict[object, list[State]] = {}
    answers: set[str] = set()
    for state in chart.states:
        if _answers(state):
            alike.setdefault(_behavior(state), []).append(state)
            answers |= _final_answers(state)
    for equal in alike.values():
        if len(equal) == 2 and answers == _final_answers(equal[0]) and _is_decided(chart, equal):
            names = " and ".join(f"`{state.id.value}`" for state in equal if state.id is not None)
            yield from _alike(f"the states {names} do the same", [_answers(state)[0][0] for state in equal])


def _is_decided(chart: Chart, states: Sequence[State]) -> bool:
    """Whether a state decides which one of `states` follows."""
    names = {state.id.value for state in states if state.id is not None}
    return any(
        names <= {t.state.value for h in state.handlers for t in h.targets if t.state is not None}
        for state in chart.states
    )


def _answers(state: State) -> list[tuple[Span, str]]:
    """The statuses that a state returns, and the variables that it sends in answers, with their places: first those in
    fields with the names of constants, such as `SKILL_SUCCESS`."""
    own = [*(state.entry.statements if state.entry is not None else ())]
    own += [statement for handler in state.handlers for target in handler.targets for statement in target.body]
    found = [(s.status.span, s.status.value) for s in own if isinstance(s, ReturnStatus) and s.status is not None]
    sent = [s for s in own if isinstance(s, RosSend) and s.part is ProtocolPart.RESPONSE]
    values = [p.value for s in sent for p in s.fields if isinstance(p.value, Expression) and not p.value.broken]
    return [*found, *((v.span, v.tree.name) for v in values if isinstance(v.tree, Name))]


def _final_answers(state: State) -> frozenset[str]:
    """The answers of a state, without that the work is still running."""
    return frozenset(answer for _, answer in _answers(state) if "running" not in words_of(answer))


def _behavior(state: State) -> tuple[object, ...]:
    """The content of a state, without its name."""
    own = state.id.value if state.id is not None else ""
    return (
        *((_content(body.statements) if body is not None else ()) for body in (state.entry, state.exit)),
        *(
            (
                tuple(sorted((a.name, a.value) for a in h.element.attributes if a.name != "target")),
                tuple(("" if end == own else end, probability, content) for end, probability, content in _does(h)),
            )
            for h in state.handlers
        ),
    )


def _is_progress(statement: Statement) -> bool:
    """Whether a statement only computes a value, as in `index + 1`. A machine may go on after a failure, too."""
    return (
        isinstance(statement, Assign)
        and isinstance(statement.value, Expression)
        and bool(variables_in((statement.value.tree,)))
    )


def _state(handler: Handler) -> str | None:
    state = handler.targets[0].state
    return state.value if state is not None else None


def _targets(handler: Handler) -> Iterator[Finding]:
    alike: dict[object, list[Target]] = {}
    for target in handler.targets:
        if target.element is not None and target.state is not None:
            alike.setdefault((target.state.value, _content(target.body)), []).append(target)
    for targets in alike.values():
        # Among other targets, the probabilities of several causes of the same outcome may be stated separately.
        probabilities = {target.probability.value if target.probability else "" for target in targets}
        is_copy = len(probabilities) == 1 and all(target.body for target in targets)
        severity = Severity.WARNING if len(alike) == 1 or is_copy else Severity.INFORMATION
        if len(targets) > 1:
            message = "another `<target>` of this element has the same state and content, so one of them is enough"
            places = [t.body[0].element if t.body else t.element for t in targets]
            yield from _alike(message, [place.name_span for place in places if place is not None], severity)


def _alike(message: str, spans: Sequence[Span], severity: Severity = Severity.WARNING) -> Iterator[Finding]:
    for span in spans:
        related = [Related(other, "the same") for other in spans if other != span]
        yield RULE.at(span, f"{message}; change one of them, or merge them", related=related, severity=severity)


def _content(body: Sequence[Statement]) -> tuple[object, ...]:
    return tuple(_canonical(statement.element) for statement in body)


def _canonical(element: Element) -> tuple[object, ...]:
    """An element without its layout and comments."""
    attributes = tuple(sorted((attribute.name, attribute.value) for attribute in element.attributes))
    text = " ".join(node.value.strip() for node in element.nodes if isinstance(node, Text)).split()
    return (element.name, attributes, tuple(text), tuple(_canonical(child) for child in element.elements))


RULE = Rule(
    "equal-branches",
    Severity.WARNING,
    "Branches of an `<if>`, handlers of an event or targets of a transition do the same.",
    machine=check,
    whole=True,
)
