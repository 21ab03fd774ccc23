# SPDX-License-Identifier: Apache-2.0
"""The rule `constant-condition`, which constant_condition.md describes."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from roaml.diagnostics import Finding, Severity
from roaml.expr.operators import Operator, OperatorKind
from roaml.expr.tree import Binary, Expr, Member, walk
from roaml.expr.types import INTEGER_RANGES, Scalar
from roaml.facts import Facts
from roaml.forest.scripts import ScriptUse, parsed, scripts_of
from roaml.model.property_file import WrittenProperty
from roaml.model.property_links import LinkedFile
from roaml.model.syntax import Expression
from roaml.model.tree import TreeNode
from roaml.model.value_types import CONDITIONS
from roaml.model.values.describe import described
from roaml.model.values.domain import FALSE, MAX_LISTED, TRUE, ValueSet
from roaml.model.values.evaluate import compared
from roaml.observers.properties import Pattern
from roaml.rules.rule import MachineContext, PropertiesContext, Rule, TreeContext
from roaml.rules.support import next_child
from roaml.rules.support.compared_numbers import (
    by_type,
    compared_constants,
    comparisons,
    decided_junctions,
    only_ways,
    reached,
    required,
    result_for,
)
from roaml.rules.support.constant_causes import at_step, at_target
from roaml.rules.support.constant_conditions import (
    ConstantPart,
    because,
    constant_conditions,
    find_causes,
    stated_values,
)
from roaml.rules.support.decided_values import decided_values
from roaml.rules.support.entries import entries_of
from roaml.rules.support.enumerations import never_named
from roaml.rules.support.forest import trees_of
from roaml.rules.support.jani_formulas import constant_comparisons
from roaml.rules.support.ranges import always_within, is_validation
from roaml.rules.support.sent_values import never_handled, never_sent
from roaml.rules.support.written import written as text_of
from roaml.script.tree import Comparison
from roaml.script.tree import walk as walk_script
from roaml.text import Decoded, Span


class ConstantCondition(Facts, frozen=True):
    """What a condition always is."""

    is_true: bool


def check(context: MachineContext) -> Iterator[Finding]:
    constant = constant_conditions(context, context.local_values)
    if len(constant) > 1:
        causes = find_causes(context, constant)
        constant = {span: part for span, part in constant.items() if span in causes}
    for span, part in constant.items():
        yield _finding(at_step(context, span) or at_target(context, span) or part)
    yield from map(_finding, always_within(context, constant.keys()))
    unsent = list(never_sent(context, constant.keys()))
    yield from map(_finding, unsent)
    yield from map(_finding, never_named(context, {*constant, *(part.span for part in unsent)}))
    yield from _beyond_type(context, constant.keys())
    yield from map(_finding, decided_values(context))
    yield from _impossible_parts(context)
    yield from map(_finding, never_handled(context, constant.keys()))


def _finding(part: ConstantPart) -> Finding:
    facts = ConstantCondition(part.is_true) if part.is_true is not None else None
    return RULE.at(part.span, part.message, *part.fixes, severity=part.severity, related=part.related, facts=facts)


def _beyond_type(context: MachineContext, reported: Collection[Span]) -> Iterator[Finding]:
    """Report comparisons of a variable with a constant that its type does not have."""
    for value in context.typed.values:
        tree = value.value.tree if isinstance(value.value, Expression) else None
        if tree is None or value.use not in CONDITIONS or value.value.span in reported:
            continue
        types = context.typed.variables.get(value.place.chart.scope, {})
        for node, name, number in comparisons(tree):
            type_ = types.get(name)
            if isinstance(type_, Scalar) and type_.name in INTEGER_RANGES:
                result = by_type(node, name, type_, number)
                if result is not None:
                    yield RULE.at(node.span, result[1])


def _impossible_parts(context: MachineContext) -> Iterator[Finding]:
    """Report comparisons that are only a part of an expression and never hold because of the values of variables that
    change, as in `open_for > 3 || load > most`. `constant-expression` reports what only follows from types."""
    for value in context.typed.values if context.system is not None else ():
        chart = context.local_values.charts.get(value.place.chart.scope)
        if chart is None or not isinstance(value.value, Expression) or value.value.broken:
            continue
        tree = value.value.tree
        for node in walk(tree):
            if not isinstance(node, Binary) or node.operator.kind not in (OperatorKind.EQUALITY, OperatorKind.ORDER):
                continue
            sides = [
                (side, reached(known)) for side in (node.left, node.right) if (known := chart.at(side)) is not None
            ]
            varying = [(side, values) for side, values in sides if values.value is None and values.only != frozenset()]
            # A test of a length often only protects the index behind it.
            is_length = any(isinstance(side, Member) and side.name == "length" for side, _ in sides)
            is_whole = node is tree and value.use in CONDITIONS
            if (
                is_whole
                or is_length
                or len(sides) < 2
                or not varying
                or compared(node.operator, sides[0][1], sides[1][1]) != FALSE
            ):
                continue
            why = stated_values((text_of(context, side), values) for side, values in varying)
            severity = Severity.INFORMATION if is_validation(tree, node, value.place.handler) else None
            yield RULE.at(node.span, f"this comparison is never true{because(why)}", severity=severity)


def check_properties(file: LinkedFile) -> Iterator[Finding]:
    """Report comparisons in conditions of properties whose result is the same for all values of the type, and the
    comparisons with a number that is never sent, in conditions that are expected to hold at some time."""
    types = {variable.id: variable.type for port in file.ports for variable in port.variables}
    for written in file.file.properties:
        pattern = written.pattern.value if written.pattern is not None else ""
        limits = [limit for scope in written.scopes for limit in (scope.event, scope.until) if limit is not None]
        for expression in written.expressions:
            parts = [] if expression.broken else list(required(expression.tree))
            for junction, name, holds in () if expression.broken else decided_junctions(expression.tree):
                yield RULE.at(junction.span, _DECIDED[holds].format(name=name))
            for node, name, value in () if expression.broken else compared_constants(expression.tree):
                type_, known = types.get(name), file.values.get(name)
                of_type = None
                if isinstance(type_, Scalar) and type_.name in INTEGER_RANGES and not isinstance(value, str):
                    of_type = by_type(node, name, type_, value)
                if of_type is not None:
                    holds, message = of_type
                    # As a part, `x >= 0` states a range completely: `x >= 0 && x <= 9`.
                    is_range = holds and node is not expression.tree and value in INTEGER_RANGES[str(type_)]
                    yield RULE.at(node.span, message, severity=Severity.INFORMATION if is_range else None)
                    continue
                if known is None or known.value is not None:
                    continue
                is_required = any(node is part for part in parts)
                if is_required and (
                    pattern in _OCCURRING or expression in limits or _is_part(pattern, expression.tree, node)
                ):
                    result = result_for(node, name, known, value)
                    is_empty = result == TRUE and node is expression.tree and not _decides_at_start(written, expression)
                    if result == FALSE or is_empty:
                        yield _of_sent(node, name, known, result)
                is_only_way = pattern == Pattern.UNIVERSALITY.value and any(
                    n is node for n in only_ways(expression.tree)
                )
                if is_only_way and result_for(node, name, known, value) == FALSE:
                    yield _of_sent(node, name, known, FALSE)


_DECIDED = {
    False: "this is never true: the comparisons of `{name}` contradict each other; did you mean `||`?",
    True: "this is always true: one of the comparisons of `{name}` holds for each value; did you mean `&&`?",
}


def _of_sent(node: Binary, name: str, known: ValueSet, result: ValueSet) -> Finding:
    how = "always" if result == TRUE else "never"
    sent = described(known, most=MAX_LISTED)
    return RULE.at(node.span, f"this comparison is {how} true: the values of `{name}` are {sent}")


def _decides_at_start(written: WrittenProperty, expression: Expression) -> bool:
    """Whether `decided-at-start` reports a condition that always holds."""
    pattern = written.pattern.value if written.pattern is not None else ""
    is_first = bool(written.conditions) and expression is written.conditions[0]
    decisive = pattern == Pattern.EXISTENCE.value or (pattern == Pattern.PRECEDENCE.value and not written.intervals)
    return is_first and decisive


def check_jani(context: PropertiesContext) -> Iterator[Finding]:
    """Report the same in properties in JANI."""
    yield from map(_finding, constant_comparisons(context))


def _is_part(pattern: str, tree: Expr, node: Binary) -> bool:
    """Whether a comparison is only a part of what must be absent. Alone, it may be a number that must not occur; beside
    other parts, it makes these superfluous."""
    return pattern == Pattern.ABSENCE.value and node is not tree and node.operator is Operator.EQUAL


_OCCURRING = frozenset(p.value for p in Pattern) - {Pattern.ABSENCE.value, Pattern.UNIVERSALITY.value}
"""The patterns whose conditions are expected to hold at some time."""


def check_trees(context: TreeContext) -> Iterator[Finding]:
    """Report conditions in scripts whose result is the same for all values that scripts assign to their entries."""
    forest = trees_of(context)
    uses = [use for _, node in forest.own_nodes for use in scripts_of(forest, node)] if forest is not None else []
    conditions = [use for use in uses if use.is_condition]
    if forest is None or not conditions:
        return
    from roaml.forest.script_values import condition_results  # noqa: PLC0415 - few trees contain conditions

    results = condition_results(forest, entries_of(forest))
    above = {child: (node, index) for _, node in forest.own_nodes for index, child in enumerate(node.children)}
    for use in conditions:
        result = results.get((use.node, use.attribute.name))
        if result is None or len(result.truth) != 1 or not result.values:
            continue
        (holds,) = result.truth
        is_setting = all(values.value is not None for values in result.values.values())
        is_of_node = use.attribute.name in _SKIPPING
        skips = _SKIPPING.get(use.attribute.name) is holds
        effect = "the node is never ticked" if skips else "it has no effect"
        if not is_of_node:
            effect = "" if is_setting else _effect_around(use, above, holds=holds)
        elif not skips and (is_setting or not _compares_equal(use)):
            continue
        if effect:
            why = because(stated_values(result.values.items()))
            message = f"this condition is {'always' if holds else 'never'} true{why}, so {effect}"
            yield RULE.at(use.attribute.value_span, message, facts=ConstantCondition(holds))


def _effect_around(use: ScriptUse, above: Mapping[TreeNode, tuple[TreeNode, int]], *, holds: bool) -> str:
    """What a constant condition in a port of a node prevents; "" if it prevents nothing."""
    if use.node.type_name == "Precondition":
        return "" if holds else "the child is never ticked"
    node, succeeds = use.node, holds
    if node.scripts or use.node.type_name != "ScriptCondition":
        return ""
    while node in above:
        parent, index = above[node]
        behind = parent.children[index + 1 :]
        if parent.type_name == "Inverter" and not parent.scripts:
            node, succeeds = parent, not succeeds
            continue
        needed = next_child.needed(parent.type_name)
        if needed == next_child.SUCCEEDS and not succeeds:
            return f"`{behind[0].type_name}` is never ticked" if behind else f"`{parent.type_name}` never succeeds"
        if needed == next_child.FAILS and succeeds and behind:
            return f"`{behind[0].type_name}` is never ticked"
        if parent.type_name in _BRANCHING and index == 0 and len(behind) > succeeds:
            return f"`{behind[1 if succeeds else 0].type_name}` is never ticked"
        return ""
    return ""


def _compares_equal(use: ScriptUse) -> bool:
    """Whether a script compares with `==`. An order that never holds often only excludes impossible values."""
    script, _ = parsed(Decoded(use.attribute.value, 0))
    return any(isinstance(part, Comparison) and "==" in part.operators for part in walk_script(script))


_BRANCHING = ("IfThenElse", "WhileDoElse")
_SKIPPING = {"_skipIf": True, "_failureIf": True, "_successIf": True, "_while": False}
"""Conditions of a node -> the result with which the node is not ticked."""


RULE = Rule(
    "constant-condition",
    Severity.WARNING,
    "A condition is always true or never true.",
    machine=check,
    tree=check_trees,
    properties=check_jani,
    xml_properties=check_properties,
    whole=True,
    facts=ConstantCondition,
)
