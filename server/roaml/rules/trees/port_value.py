# SPDX-License-Identifier: Apache-2.0
"""The rule `port-value`, which port_value.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.expr.infer import ADVICE, constant, infer
from roaml.expr.parse import parse
from roaml.expr.types import BASE_TYPES, BOOL, INTEGER_RANGES, ScalarKind, fits, is_kind, is_number
from roaml.model.expand import PortConstant
from roaml.model.outline import MachineOutline, PortOutline
from roaml.model.syntax import Name
from roaml.model.tree import (
    PortModel,
    TreeNode,
    blackboard_variable,
    is_reserved_variable,
    is_variable_name,
    looks_like_reference,
    nodes,
)
from roaml.record import Record
from roaml.roles import Direction, SymbolKind
from roaml.rules.rule import Rule, TreeContext, did_you_mean, replacements
from roaml.rules.support.instances import instances
from roaml.text import Decoded, Span, TextEdit


def check(context: TreeContext) -> Iterator[Finding]:
    """Check ports of trees in systems; BehaviorTree.CPP itself accepts any text."""
    if context.system is None:
        return
    for tree in context.file.trees:
        for node in nodes(tree):
            for setting in node.ports:
                yield from _name(setting.value)
            if not node.is_subtree and node.plugin is not None:
                path, plugin = context.system.plugin(node.plugin.value)
                if plugin is not None:
                    yield from _values(node, plugin, path)
    for model in context.file.models:
        path, plugin = context.system.plugin(model.id.value) if model.id else ("", None)
        for port in model.ports:
            if plugin is not None and not model.is_subtree:
                yield from _default(port, plugin, path)
    yield from _given_by_subtrees(context)


def _name(value: Name) -> Iterator[Finding]:
    """Check that a reference `{name}` has a valid name."""
    variable = blackboard_variable(value.value)
    if variable is None:
        if looks_like_reference(value.value):
            message = (
                f"`{value.value}` is neither a variable nor a constant; a variable is written alone, as `{{name}}`"
            )
            yield RULE.at(value.span, message)
    elif not variable:
        yield RULE.at(value.span, "the braces do not contain the name of a variable; write `{name}`")
    elif is_reserved_variable(variable):
        yield RULE.at(
            value.span, f"`{variable}` is a reserved word of ECMAScript and cannot be the name of a blackboard variable"
        )
    elif not is_variable_name(variable) and variable != "=":
        rule = "it must contain only letters, digits, `_` and `$`, and not begin with a digit"
        message = f"`{variable}` is not a valid name of a blackboard variable: {rule}"
        yield RULE.at(value.span, message)
    elif (plain := f"{{{variable}}}") != value.value.strip():
        # The meaning is clear here, but for BehaviorTree.CPP and the reference translator the spaces are part of the
        # name.
        yield RULE.at(
            value.span,
            f"a variable is written in braces without spaces: `{plain}`",
            *replacements(value.span, (plain,)),
        )


def _values(node: TreeNode, plugin: MachineOutline, path: str) -> Iterator[Finding]:
    for setting in node.ports:
        port = plugin.port(setting.key.value)
        if port is not None and setting.variable is None and not looks_like_reference(setting.value.value):
            yield from _constant(setting.value.value, setting.value.span, port, path)


def _default(model: PortModel, plugin: MachineOutline, path: str) -> Iterator[Finding]:
    """Check a default of `<TreeNodesModel>`, which is the value of every node that does not set the port."""
    port, default = plugin.port(model.name.value) if model.name else None, model.element.get("default")
    if port is not None and default is not None:
        yield from _name(Name(default.value, default.value_span))
        if not looks_like_reference(default.value):
            yield from _constant(default.value, default.value_span, port, path)


def _constant(text: str, span: Span, port: PortOutline, path: str) -> Iterator[Finding]:
    related = [Related(Symbol(path, SymbolKind.PORT, port.key), "declared here")] if path else []
    if port.direction is Direction.OUT:
        name = text.strip()
        fixes = [Fix(f"Change to `{{{name}}}`", (TextEdit(span, f"{{{name}}}"),))] if is_variable_name(name) else []
        message = f"`{port.key}` is an output port; bind it to a blackboard variable, `{{name}}`"
        yield RULE.at(span, message, *fixes, related=related)
        return
    problem = problem_of(text.strip(), port)
    if problem is not None:
        new = problem.replacement
        fixes = [Fix(f"Change to `{new}`", (TextEdit(span, new),))] if new else []
        yield RULE.at(span, problem.message, *fixes, severity=problem.severity, related=related)


def _given_by_subtrees(context: TreeContext) -> Iterator[Finding]:
    """Check a constant that a `<SubTree>` passes for a variable: it becomes the value of the ports bound to that
    variable."""
    for node, automaton in instances(context):
        for setting in node.ports:
            port, value = automaton.outline.port(setting.key.value), automaton.port(setting.key.value)
            if (
                setting.variable is None
                or port is None
                or port.direction is Direction.OUT
                or not isinstance(value, PortConstant)
            ):
                continue
            problem = problem_of(value.text.strip(), port)
            if problem is not None:
                message = f"the `<SubTree>` passes `{value.text}` for `{setting.variable}`, but {problem.message}"
                yield RULE.at(setting.value.span, message, severity=problem.severity)


class ConstantProblem(Record, frozen=True):
    """Why a port cannot hold a constant; `replacement` is the constant that was probably intended, or an empty
    string."""

    message: str
    severity: Severity = Severity.ERROR
    replacement: str = ""


def problem_of(text: str, port: PortOutline) -> ConstantProblem | None:
    """The reason why an input port cannot hold the constant `text`; `None` if it can. A constant is a string or an
    expression of the port's type."""
    type_ = BASE_TYPES.get(port.type)
    if type_ is None or is_kind(type_, ScalarKind.STRING):
        return None
    if not text:
        return ConstantProblem(f"the port `{port.key}` has no value; it needs a value of the type `{port.type}`")
    tree, findings = parse(Decoded(text, 0))
    given, problems = infer(tree, lambda _: None)
    sound = not findings and all(isinstance(problem, ADVICE) for problem in problems)
    if type_ == BOOL:
        if sound and given == BOOL:
            return None
        close = {"1": "true", "0": "false"}.get(text, text.lower())
        known = (close,) if close in ("true", "false") else ()
        message = f"the port `{port.key}` must be `true` or `false`, not `{text}`{did_you_mean(known)}"
        return ConstantProblem(message, replacement="".join(known))
    if not sound or not is_number(given):
        return ConstantProblem(f"the port `{port.key}` must be `{port.type}`, not `{text}`")
    value = constant(tree)
    if not fits(given, type_):
        if value is None or not float(value).is_integer():
            return ConstantProblem(f"the port `{port.key}` must be `{port.type}`, not `{text}`")
        new = str(int(value))
        return ConstantProblem(
            f"the port `{port.key}` is `{port.type}`; write `{new}` instead of `{text}`", Severity.WARNING, new
        )
    low, high = INTEGER_RANGES.get(port.type, (None, None))
    if value is not None and low is not None and high is not None and not low <= value <= high:
        message = f"`{text}` does not fit into the port `{port.key}`: the range of `{port.type}` is {low} to {high}"
        low, high = INTEGER_RANGES["int64"]
        return ConstantProblem(message, Severity.WARNING if low <= value <= high else Severity.ERROR)
    return None


RULE = Rule("port-value", Severity.ERROR, "The value of a port is not valid.", tree=check)
