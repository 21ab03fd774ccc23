# SPDX-License-Identifier: Apache-2.0
"""The rule `mixed-names`, which mixed_names.md describes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.operators import COMPARING, Operator
from roaml.expr.tree import Binary, Name, walk
from roaml.expr.types import Type
from roaml.jani.expressions import Binary as JaniBinary
from roaml.jani.expressions import Name as JaniName
from roaml.jani.operators import Signature
from roaml.jani.properties import Property
from roaml.jani.properties import walk as walk_formula
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import Assign, Chart, Handler, If, ReturnStatus, Send, statements, values_of
from roaml.model.syntax import Expression
from roaml.model.syntax import Name as SyntaxName
from roaml.model.waits import fixed_variables
from roaml.rules.rule import MachineContext, PropertiesContext, Rule, replacements
from roaml.rules.support.counted_names import other_guards, steps_from_others
from roaml.rules.support.numbered_machines import numbers_of_others
from roaml.rules.support.similar_parts import copied_names
from roaml.rules.support.words import LIMITS, difference, with_word, words_of
from roaml.scxml.names import STATUSES
from roaml.text import Span, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        types = context.typed.variables.get(chart.scope, {})
        reported: set[Span] = set()
        findings = (*_copied(context, chart), *_steps(chart), *_pairs(context, chart), *_guards(chart))
        findings += (*_bounds(chart, types), *_statuses(chart), *_previous(chart, types))
        for finding in findings:
            if finding.span not in reported:
                reported.add(finding.span)
                yield finding
    yield from _numbered(context)


def check_jani(context: PropertiesContext) -> Iterator[Finding]:
    """Report a name that is compared with two similar ones, although there is a name that is similar in the same way:
    `pose_y = goal_x` beside `pose_x = goal_x`."""
    for property_ in context.properties if context.variables is not None else ():
        compared = [*_compared_in_jani(property_)]
        for (name, other), (earlier_name, earlier_other) in itertools.permutations(compared, 2):
            words = difference(earlier_name.identifier, name.identifier)
            if words is None or other.identifier != earlier_other.identifier or other.origin is None:
                continue
            if not all(len(word) == 1 and word.isalpha() for word in words):
                continue  # two robots can be compared with the place of one of them, but x not with y
            meant = with_word(other.identifier, *words)
            if meant is not None and meant in (context.variables or {}) and earlier_other.origin is not None:
                message = (
                    f"`{name.identifier}` is compared with this, as `{earlier_name.identifier}` is, although there is "
                    f"`{meant}`; did you mean that?"
                )
                related = [Related(earlier_other.origin.span, "the other comparison")]
                yield RULE.at(other.origin.span, message, related=related)


def _compared_in_jani(property_: Property) -> Iterator[tuple[JaniName, JaniName]]:
    for part in walk_formula(property_.expression):
        if not isinstance(part, JaniBinary) or part.operator.signature not in (Signature.EQUALITY, Signature.ORDER):
            continue
        if isinstance(part.left, JaniName) and isinstance(part.right, JaniName):
            yield part.left, part.right
            yield part.right, part.left


def _copied(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    known = {*context.typed.variables.get(chart.scope, {}), *context.machine.declarations_by_handle}
    known |= {s.event.value for s in chart.statements if isinstance(s, Send) and s.event is not None}
    for part, other, name, meant, places in copied_names(chart, known):
        message = (
            f"`{part.name}` uses `{name}`, as `{other.name}` does, although there is `{meant}`; did you mean that?"
        )
        fix = Fix(f"Change to `{meant}`", tuple(TextEdit(span, meant) for _, span in places))
        role, span = places[0]
        yield RULE.at(span, message, fix, related=[Related(other.uses[role, name], f"used for `{other.name}`")])


def _steps(chart: Chart) -> Iterator[Finding]:
    for step, other in steps_from_others(chart):
        message = f"`{step.place}` is computed from `{step.read}`, which is counted, too; did you mean `{step.place}`?"
        related = [Related(other.span, "counted here")]
        yield RULE.at(step.span, message, *replacements(step.span, (step.place,)), related=related)


def _guards(chart: Chart) -> Iterator[Finding]:
    for counted, tested, place, meant in other_guards(chart):
        message = (
            f"`{counted}` is counted under a condition for `{tested}`, while the other conditions here test the "
            f"variable that is counted; did you mean `{meant.name}`?"
        )
        related = [Related(meant.span, f"`{meant.name}`")]
        yield RULE.at(place.span, message, *replacements(place.span, (meant.name,)), related=related)


def _numbered(context: MachineContext) -> Iterator[Finding]:
    name = context.machine.name
    if name is None:
        return
    for tree, meant in numbers_of_others(context):
        fix = Fix(f"Change to `{meant}`", (TextEdit(tree.span, meant),))
        message = f"the machine `{name.value}` uses the number of another one here; did you mean `{meant}`?"
        yield RULE.at(tree.span, message, fix, related=[Related(name.span, "the number of this machine")])


# ------------------------------------------------------------- pairs of names


def _pairs(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    """Comparisons of names that differ in the last word, such as `goal_y > curr_x`, in machines that compare names with
    the same last word, such as `goal_x < curr_x`."""
    comparisons = [
        (node.left, node.right, node.operator)
        for value in context.typed.values
        if value.place.chart is chart and isinstance(value.value, Expression) and not value.value.broken
        for node in walk(value.value.tree)
        if isinstance(node, Binary) and node.operator.kind in COMPARING
        if isinstance(node.left, Name) and isinstance(node.right, Name)
    ]
    written = {(left.name, right.name, operator) for left, right, operator in comparisons}
    split = [(left, right, op, *_split(left.name), *_split(right.name)) for left, right, op in comparisons]
    matching = {(first, second): (left, right) for left, right, _, first, a, second, b in split if a == b}
    types = context.typed.variables.get(chart.scope, {})
    for left, right, operator, first, last, second, other in split:
        pattern = matching.get((first, second))
        if last == other or pattern is None or not (first or second):
            continue
        meant = with_word(right.name, other, last)
        if meant is None or meant not in types or with_word(left.name, last, other) not in types:
            continue
        if (left.name, meant, operator) in written:  # each with each
            continue
        message = f"`{left.name}` is compared with `{right.name}`, although there is `{meant}`; did you mean that?"
        related = [Related(Span(pattern[0].span.start, pattern[1].span.end), "names that belong together")]
        yield RULE.at(right.span, message, *replacements(right.span, (meant,)), related=related)


def _bounds(chart: Chart, types: Mapping[str, Type]) -> Iterator[Finding]:
    """Comparisons of a variable with a constant, although nothing reads a constant with the name of the variable, such
    as `max_tries` for `tries`."""
    fixed = fixed_variables(chart)
    limits = {name: frozenset(words_of(name)) - LIMITS for name in fixed if not LIMITS.isdisjoint(words_of(name))}
    if not limits:
        return
    expressions = [value for value in _expressions(chart) if not value.broken]
    read = {node.name for value in expressions for node in walk(value.tree) if isinstance(node, Name)}
    unread = {name: words for name, words in limits.items() if words and name not in read}
    for value in expressions if unread else ():
        for node in walk(value.tree):
            if not isinstance(node, Binary) or node.operator.kind not in COMPARING:
                continue
            for variable, constant_name in ((node.left, node.right), (node.right, node.left)):
                if not isinstance(variable, Name) or not isinstance(constant_name, Name):
                    continue
                own = frozenset(words_of(variable.name))
                if constant_name.name not in fixed or variable.name in fixed or own & {*words_of(constant_name.name)}:
                    continue
                for meant, words in unread.items():
                    if words <= own and types.get(meant) == types.get(constant_name.name):
                        message = (
                            f"`{variable.name}` is compared with `{constant_name.name}`, and nothing reads `{meant}`; "
                            "did you mean that?"
                        )
                        yield RULE.at(constant_name.span, message, *replacements(constant_name.span, (meant,)))


def _expressions(chart: Chart) -> Iterator[Expression]:
    """The conditions of a chart, and the values that it assigns or sends."""
    yield from (handler.cond for state in chart.states for handler in state.handlers if handler.cond is not None)
    for statement in chart.statements:
        if isinstance(statement, If):
            yield from (branch.cond for branch in statement.branches if branch.cond is not None)
        yield from values_of(statement)


def _split(name: str) -> tuple[tuple[str, ...], str]:
    words = words_of(name)
    return tuple(words[:-1]), words[-1] if words else ""


# ------------------------------------------------------------- statuses


def _statuses(chart: Chart) -> Iterator[Finding]:
    """Handlers of one state that return another status than the one after which the constant in their condition is
    named, as in `_res.status == SKILL_RUNNING`, if another handler returns the status with the name of its constant."""
    for state in chart.states:
        named = [
            (status, returned, returned.value == status)
            for handler in state.handlers
            if (status := _named_status(handler)) is not None and (returned := _returned(handler)) is not None
        ]
        right = {status for status, _, is_right in named if is_right}
        for status, returned, is_right in named:
            if not is_right and returned.value in right:
                message = (
                    f"this returns {returned.value} under a condition for {status}, as another handler does; did you "
                    f"mean {status}?"
                )
                yield RULE.at(returned.span, message, *replacements(returned.span, (status,)))


def _named_status(handler: Handler) -> str | None:
    """The status in the name of the constant with which the condition of a handler compares something."""
    tree = handler.cond.tree if handler.cond is not None and not handler.cond.broken else None
    if not isinstance(tree, Binary) or tree.operator is not Operator.EQUAL:
        return None
    names = [side.name for side in (tree.left, tree.right) if isinstance(side, Name) and side.name.isupper()]
    statuses = [word.upper() for name in names for word in words_of(name)[-1:] if word.upper() in STATUSES]
    return statuses[0] if len(statuses) == 1 else None


def _returned(handler: Handler) -> SyntaxName | None:
    """The only status that a handler returns."""
    found = [s.status for target in handler.targets for s in statements(target.body) if isinstance(s, ReturnStatus)]
    return found[0] if len(found) == 1 else None


# --------------------------------------------------------- previous values

_PREVIOUS = frozenset(("previous", "prev", "old"))
"""The first word of a variable that keeps the last value of another one."""

_CURRENT = frozenset(("current", "curr", "cur", "new", "latest", "actual"))


def _previous(chart: Chart, types: Mapping[str, Type]) -> Iterator[Finding]:
    """Variables that keep the last value of another one, as their names say, and get the value of a third one."""
    varying = {
        statement.location.tree.name
        for statement in chart.statements
        if isinstance(statement, Assign) and statement.location is not None
        if isinstance(statement.location.tree, Name) and not _accumulates(statement, statement.location.tree.name)
    }
    for statement in chart.statements:
        if not isinstance(statement, Assign) or not isinstance(statement.value, Expression) or not statement.location:
            continue
        location, value = statement.location.tree, statement.value.tree
        if not isinstance(location, Name) or not isinstance(value, Name):
            continue
        first, kept = words_of(location.name)[:1], words_of(location.name)[1:]
        if _PREVIOUS.isdisjoint(first) or not kept or set(words_of(value.name)) & set(kept):
            continue
        sources = [
            name
            for name, type_ in types.items()
            if name != location.name and words_of(name)[-len(kept) :] == kept and type_ == types.get(location.name)
            # `max_error` and `sum_error` are no values of which the previous one is kept.
            if name in varying or not _CURRENT.isdisjoint(words_of(name)[:1])
        ]
        if len(sources) == 1:
            message = f"`{location.name}` gets `{value.name}`, although there is `{sources[0]}`; did you mean that?"
            yield RULE.at(value.span, message, *replacements(value.span, sources))


def _accumulates(statement: Assign, name: str) -> bool:
    return isinstance(statement.value, Expression) and name in variables_in((statement.value.tree,))


RULE = Rule(
    "mixed-names",
    Severity.WARNING,
    "A name belongs to a similar part of the machine.",
    machine=check,
    properties=check_jani,
    whole=True,
)
