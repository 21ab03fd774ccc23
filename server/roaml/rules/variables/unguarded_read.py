# SPDX-License-Identifier: Apache-2.0
"""The rule `unguarded-read`, which unguarded_read.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Boolean, Call, Conditional, Expr, Name
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import Assign, Chart, Handler, If, Statement, bodies, statements, values_of
from roaml.model.syntax import Expression
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.alternatives import guarded_statements, joined
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        guarded = list(guarded_statements(chart))
        if not any(_disjunction(cond) for cond, _ in guarded):
            continue
        data = _data_of_flags(chart)
        for cond, body in guarded:
            flags = _disjunction(cond)
            read = _read(body, frozenset(flag.name for flag in flags)) if flags else frozenset()
            unset = [name for flag in flags for name in sorted(data.get(flag.name, frozenset()) & read)[:1]]
            if len(flags) > 1 and len(unset) == len(flags):
                tree = cond.tree
                assert isinstance(tree, Binary)
                message = (
                    f"this holds if only `{flags[0].name}` is true, and what follows also reads `{unset[1]}`, which is "
                    f"set together with `{flags[1].name}`; did you mean `&&`?"
                )
                edits = tuple(TextEdit(node.operator_span, "&amp;&amp;") for node in _operators(tree))
                fix = Fix("Change to `&&`", edits)
                related = [
                    Related(flag.span, f"says that `{name}` is set") for flag, name in zip(flags, unset, strict=True)
                ]
                yield RULE.at(tree.operator_span, message, fix, related=related)


def _disjunction(cond: Expression) -> Sequence[Name]:
    """The variables that a condition joins with `||`, if it contains nothing else."""
    parts = [] if cond.broken else joined(cond.tree, Operator.OR)
    names = [part for part in parts if isinstance(part, Name)]
    return names if len(names) == len(parts) > 1 else ()


def _operators(tree: Expr) -> Iterator[Binary]:
    if isinstance(tree, Binary) and tree.operator is Operator.OR:
        yield tree
        yield from _operators(tree.left)


def _data_of_flags(chart: Chart) -> Mapping[str, frozenset[str]]:
    """Flag -> the variables that get their only values, which arrive, in the same handler as the flag, which is false
    before and always true afterwards."""
    begin = {data.id.value: data.value for data in chart.data if data.id is not None}
    handlers: dict[str, list[Handler | None]] = {}
    values: dict[str, list[Expr | None]] = {}
    for _, handler, body in bodies(chart):
        for statement in statements(body):
            name = place_of(statement.location.tree) if isinstance(statement, Assign) and statement.location else None
            if name is not None and isinstance(statement, Assign):
                value = statement.value
                handlers.setdefault(name, []).append(handler)
                values.setdefault(name, []).append(value.tree if isinstance(value, Expression) else None)
    received = {
        name
        for name, of_one in values.items()
        if all(v is not None and _is_received(v) for v in of_one) and not _is_marked(begin.get(name))
    }
    data: dict[str, frozenset[str]] = {}
    for name, of_one in values.items():
        start = begin.get(name)
        is_false = isinstance(start, Expression) and isinstance(start.tree, Boolean) and not start.tree.value
        if is_false and len(of_one) == 1 and isinstance(of_one[0], Boolean) and of_one[0].value:
            data[name] = frozenset(other for other in received if handlers[other] == handlers[name] != [None])
    return data


def _is_marked(value: object) -> bool:
    """Whether an initial value is negative: it probably says that there is no value yet."""
    number = constant(value.tree) if isinstance(value, Expression) and not value.broken else None
    return number is not None and number < 0


def _is_received(value: Expr) -> bool:
    return any(name.startswith("_") for name in variables_in((value,)))


def _read(body: Sequence[Statement], flags: frozenset[str]) -> frozenset[str]:
    """The variables that a body assigns, sends or writes to the blackboard, without those of which the flags or the
    values decide which one is used."""
    tested = {
        inner
        for statement in statements(tuple(body))
        if isinstance(statement, If)
        if not flags.isdisjoint(variables_in(b.cond.tree for b in statement.branches if b.cond is not None))
        for inner in statements((statement,))
    }
    read = (statement for statement in statements(tuple(body)) if statement not in tested)
    trees = (value.tree for statement in read for value in values_of(statement))
    return variables_in(tree for tree in trees if not _is_chosen(tree, flags))


def _is_chosen(tree: Expr, flags: frozenset[str]) -> bool:
    """Whether flags or the values decide which one of several values is used: the others may have their initial
    values."""
    match tree:
        case Conditional(test=test):
            return not flags.isdisjoint(variables_in((test,)))
        case Binary(operator=operator):
            return operator is Operator.OR
        case Call(function=function):
            return place_of(function) == "Math.max"
    return False


RULE = Rule(
    "unguarded-read",
    Severity.WARNING,
    "A variable may be read before it is set.",
    machine=check,
    whole=True,
)
