# SPDX-License-Identifier: Apache-2.0
"""The rule `port-value`, which port_value.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Set

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.expr.infer import ADVICE, constant, infer
from roaml.expr.parse import parse
from roaml.expr.types import BASE_TYPES, BOOL, INTEGER_RANGES, ScalarKind, fits, is_kind, is_number
from roaml.forest.cpp_types import is_converted, mismatch
from roaml.forest.entries import entry_of, names_entry
from roaml.forest.forest import Forest
from roaml.forest.ports import ports_of
from roaml.libraries import Node, Port, library_node
from roaml.libraries.scripts import SCRIPT
from roaml.model.expand import PortConstant
from roaml.model.outline import MachineOutline, PortOutline
from roaml.model.syntax import Name
from roaml.model.system import ANY_TYPE, System
from roaml.model.tree import (
    PortModel,
    PortSetting,
    TreeNode,
    is_reserved_variable,
    is_variable_name,
    looks_like_reference,
    nodes,
)
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import Direction, NodeKind, SymbolKind
from roaml.rules.rule import Rule, TreeContext, replacements
from roaml.rules.support.entries import names_of
from roaml.rules.support.forest import forest_of
from roaml.rules.support.instances import instances
from roaml.text import Decoded, Span, TextEdit

_NAME = regex(r"[A-Za-z_][\w.-]*\Z", re.ASCII)
_DOLLAR = regex(r"[$#%]\{(@?[A-Za-z_][\w.-]*)\}\Z", re.ASCII)
_SYSTEM_STATUSES = ("1", "2", "3")
"""The numbers that trees of systems may use for statuses."""


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is not None:
        yield from _of_system(context, context.system)
    elif (forest := forest_of(context)) is not None:
        yield from _alone(context, forest)


# ------------------------------------------------------------ references, with and without a system


def _reference(value: Name, severity: Severity | None) -> Iterator[Finding]:
    """Report braces that do not contain exactly a name.

    Args:
        severity: the severity if BehaviorTree.CPP accepts the value.
    """
    text, span = value.value.strip(), value.span
    opens, closes = text.startswith("{"), text.endswith("}")
    name = text[1:-1] if opens and closes else text
    plain = name.strip("{}").strip()
    fixes = tuple(replacements(span, (f"{{{plain}}}",))) if _NAME.match(plain) else ()
    if opens and closes:
        if not name.strip():
            yield RULE.at(span, "the braces do not contain the name of a blackboard entry; write `{name}`")
        elif _NAME.match(name.strip("{}")) and plain != name:
            message = f"`{text}` has too many braces, which become part of the name of the entry; write `{{{plain}}}`"
            yield RULE.at(span, message, *fixes, severity=severity)
        elif name != name.strip() and "{" not in name:
            message = f"the spaces in the braces become part of the name of the entry; write `{{{plain}}}`"
            yield RULE.at(span, message, *replacements(span, (f"{{{plain}}}",)), severity=severity)
    elif opens != closes and text.count("{") != text.count("}"):
        message = f"`{text}` has only one of two braces, so it is a string and not an entry; add the other brace"
        yield RULE.at(span, message, *fixes, severity=severity)


def _without_braces(
    node: TreeNode, port: Port | None, setting: PortSetting, names: Set[str], severity: Severity | None
) -> Iterator[Finding]:
    """Report a constant that is probably intended to be an entry of the tree: `${name}`; `name` if BehaviorTree.CPP
    cannot convert a text to the type of the port; and `name` if a subtree passes it under another name."""
    text, span = setting.value.value.strip(), setting.value.span
    dollar = _DOLLAR.match(text)
    name = dollar[1] if dollar else text
    is_known = name in names or name.removeprefix("@") in names
    if not is_known or (port is not None and port.direction is Direction.OUT):
        return
    if dollar is None:
        subtree = node.is_subtree and setting.attribute.name != name
        if not subtree and (port is None or is_converted(port.type)):
            return
        severity = Severity.INFORMATION if subtree else severity
    message = f"`{text}` is a constant; write `{{{name}}}` for the entry `{name}`"
    yield RULE.at(span, message, *replacements(span, (f"{{{name}}}",)), severity=severity)


def _output(port: str, owner: str, text: str, span: Span, related: list[Related], severity: Severity) -> Finding:
    """The finding that an output port is set to a constant."""
    name = text.strip()
    fixes = [Fix(f"Change to `{{{name}}}`", (TextEdit(span, f"{{{name}}}"),))] if _NAME.match(name) else []
    reason = f"not the string `{name}`" if name else "not an empty value"
    message = f"`{port}` of `{owner}` is an output port: it needs a blackboard entry in braces, {reason}"
    return RULE.at(span, message, *fixes, severity=severity, related=related)


class ConstantProblem(Record, frozen=True):
    """Why a port cannot hold a constant, as a phrase after the name of the port; `replacement` is the constant that was
    probably intended, or an empty string."""

    message: str
    severity: Severity = Severity.ERROR
    replacement: str = ""


def _as_library_reads(type_name: str, text: str) -> ConstantProblem | None:
    """Why BehaviorTree.CPP does not read a text as a value of a C++ type; `None` if it does."""
    wrong = mismatch(type_name, text)
    if wrong is None:
        return None
    severity, shown = Severity.WARNING if wrong.ignored else Severity.ERROR, "" if wrong.ignored else _instead_of(text)
    return ConstantProblem(f"{wrong.message}{shown}", severity, wrong.instead)


def _instead_of(text: str) -> str:
    return f", not `{text.strip()}`" if text.strip() else ", not an empty value"


# ------------------------------------------------------------ trees of systems


def _of_system(context: TreeContext, system: System) -> Iterator[Finding]:
    for tree in context.file.trees:
        names = {variable for node in nodes(tree) for setting in node.ports if (variable := setting.variable)}
        for node in nodes(tree):
            path, plugin = system.plugin(node.plugin.value) if node.plugin and not node.is_subtree else ("", None)
            for setting in node.ports:
                port = plugin.port(setting.key.value) if plugin is not None else None
                of_text = node.is_subtree or (port is not None and port.type == "string")
                severity = Severity.WARNING if of_text else None
                wrong = list(_reference_in_system(setting.value, severity))
                if setting.variable is None and not wrong:
                    wrong = list(_without_braces(node, None, setting, names, severity))
                yield from wrong
                if setting.variable is None and not wrong and plugin is not None and port is not None:
                    yield from _constant(setting.value.value, setting.value.span, plugin, port, path)
    for model in context.file.models:
        path, plugin = system.plugin(model.id.value) if model.id and not model.is_subtree else ("", None)
        for model_port in model.ports if plugin is not None else ():
            assert plugin is not None
            yield from _default(model_port, plugin, path)
    yield from _given_by_subtrees(context)


def _reference_in_system(value: Name, severity: Severity | None = None) -> Iterator[Finding]:
    """Check that a reference `{name}` has a name that the translation can use."""
    wrong = list(_reference(value, severity))
    yield from wrong
    text = value.value.strip()
    if wrong or not looks_like_reference(text):
        return
    variable = text[1:-1].strip()
    if not text.endswith("}"):
        message = f"`{value.value}` is neither a variable nor a constant; a variable is written alone, as `{{name}}`"
        yield RULE.at(value.span, message)
    elif is_reserved_variable(variable):
        message = f"`{variable}` is a reserved word of ECMAScript and cannot be the name of a blackboard variable"
        yield RULE.at(value.span, message)
    elif not is_variable_name(variable) and variable != "=":
        rule = "it must contain only letters, digits, `_` and `$`, and not begin with a digit"
        yield RULE.at(value.span, f"`{variable}` is not a valid name of a blackboard variable: {rule}")


def _default(model: PortModel, plugin: MachineOutline, path: str) -> Iterator[Finding]:
    """Check a default of `<TreeNodesModel>`, which is the value of every node that does not set the port."""
    port, default = plugin.port(model.name.value) if model.name else None, model.element.get("default")
    if port is not None and default is not None:
        yield from _reference_in_system(Name(default.value, default.value_span))
        if not looks_like_reference(default.value):
            yield from _constant(default.value, default.value_span, plugin, port, path)


def _constant(text: str, span: Span, plugin: MachineOutline, port: PortOutline, path: str) -> Iterator[Finding]:
    related = [Related(Symbol(path, SymbolKind.PORT, port.key), "declared here")] if path else []
    if port.direction is Direction.OUT:
        yield _output(port.key, plugin.name, text, span, related, Severity.ERROR)
        return
    problem = _problem(text, plugin, port)
    if problem is not None:
        new = (problem.replacement,) if problem.replacement else ()
        message = f"`{port.key}` of `{plugin.name}` {problem.message}"
        yield RULE.at(span, message, *replacements(span, new), severity=problem.severity, related=related)


def _given_by_subtrees(context: TreeContext) -> Iterator[Finding]:
    """Check a constant that a `<SubTree>` passes for a variable: it becomes the value of the ports bound to that
    variable."""
    for node, automaton in instances(context):
        for setting in node.ports:
            port, value = automaton.outline.port(setting.key.value), automaton.port(setting.key.value)
            if setting.variable is None or port is None or not isinstance(value, PortConstant):
                continue
            plugin = automaton.outline
            problem = _problem(value.text, plugin, port) if port.direction is not Direction.OUT else None
            if problem is not None:
                message = f"the `<SubTree>` passes `{value.text}` for `{setting.variable}`, but "
                message += f"`{port.key}` of `{plugin.name}` {problem.message}"
                yield RULE.at(setting.value.span, message, severity=problem.severity)


def _problem(text: str, plugin: MachineOutline, port: PortOutline) -> ConstantProblem | None:
    """The reason why an input port of a system's tree cannot hold a constant; `None` if it can."""
    if port.type != ANY_TYPE:
        return problem_of(text.strip(), port)
    node = library_node(plugin.name)
    declared = node.port(port.key) if node is not None else None
    if node is None or declared is None or declared.type == SCRIPT or plugin.name.startswith("Switch"):
        return None
    if declared.type == "NodeStatus" and text.strip() in _SYSTEM_STATUSES:
        return None
    return _as_library_reads(declared.type, text)


def problem_of(text: str, port: PortOutline) -> ConstantProblem | None:
    """The reason why an input port cannot hold the constant `text`; `None` if it can. A constant is a string or an
    expression of the port's type."""
    type_ = BASE_TYPES.get(port.type)
    if type_ is None or is_kind(type_, ScalarKind.STRING):
        return None
    kind_name = "an integer" if is_kind(type_, ScalarKind.INT) else "a number"
    wrong = ConstantProblem(f"must be {kind_name}{_instead_of(text)}")
    tree, findings = parse(Decoded(text, 0))
    given, problems = infer(tree, lambda _: None)
    sound = bool(text) and not findings and all(isinstance(problem, ADVICE) for problem in problems)
    if type_ == BOOL:
        if sound and given == BOOL:
            return None
        close = {"1": "true", "0": "false"}.get(text, text.lower())
        known = close if close in ("true", "false") else ""
        return ConstantProblem(f"must be `true` or `false`{_instead_of(text)}", replacement=known)
    if not sound or not is_number(given):
        return wrong
    value = constant(tree)
    if not fits(given, type_):
        if value is None or not float(value).is_integer():
            return wrong
        new = str(int(value))
        return ConstantProblem(f"must be an integer; write `{new}` instead of `{text}`", Severity.WARNING, new)
    low, high = INTEGER_RANGES.get(port.type, (None, None))
    if value is not None and low is not None and high is not None and not low <= value <= high:
        limits = "0 or greater" if low == 0 and value < 0 else f"from {low} to {high}"
        low, high = INTEGER_RANGES["int64"]
        severity = Severity.WARNING if low <= value <= high else Severity.ERROR
        return ConstantProblem(f"must be {limits}{_instead_of(text)}", severity)
    return None


# ------------------------------------------------------------ trees without a system


def _alone(context: TreeContext, forest: Forest) -> Iterator[Finding]:
    for tree, node in forest.own_nodes:
        known = forest.declaration(node)
        for setting in ports_of(node):
            port = known.port(setting.attribute.name) if known else None
            if port is not None and port.type == SCRIPT:
                continue
            wrong = list(_reference(setting.value, Severity.WARNING))
            if not wrong and entry_of(setting) is None:
                names = names_of(forest, tree.id.value if tree.id else "") | forest.host_entries
                wrong = list(_without_braces(node, port, setting, names, Severity.WARNING))
            yield from wrong
            if known is not None and port is not None and not wrong and entry_of(setting) is None:
                yield from _literal(known, port, setting)
    for model in context.file.models:
        for described in model.ports:
            default = described.element.get("default")
            text = default.value.strip('" ') if default is not None else ""
            if default is None or not text or default.value.strip().startswith("{") or _CODE.match(default.value):
                continue
            problem = _as_library_reads(described.type, text)
            if problem is not None and problem.severity is Severity.ERROR:
                name = described.name.value if described.name else ""
                message = f"`{name}` of `{model.id.value if model.id else ''}` {problem.message}"
                yield RULE.at(default.value_span, message, severity=Severity.WARNING)


_CODE = regex(r".*[(:<]|[\d.]+f\Z", re.DOTALL)
"""Matches defaults that are C++ expressions. Models contain these as descriptions for readers; they are not values."""


def _literal(known: Node, port: Port, setting: PortSetting) -> Iterator[Finding]:
    text, span = setting.value.value, setting.value.span
    # A model in a file may differ from the node.
    severity = Severity.ERROR if known.library or known.kind is NodeKind.SUBTREE else Severity.WARNING
    if port.direction is Direction.OUT:
        yield _output(port.name, known.name, text, span, [], severity)
        return
    if not text.strip() and names_entry(known, port.name):
        yield RULE.at(span, f"`{port.name}` of `{known.name}` needs the name of a blackboard entry")
        return
    problem = _as_library_reads(port.type, text)
    if problem is not None:
        fixes = replacements(span, (problem.replacement,) if problem.replacement else ())
        message = f"`{port.name}` of `{known.name}` {problem.message}"
        yield RULE.at(span, message, *fixes, severity=min(severity, problem.severity))


RULE = Rule("port-value", Severity.ERROR, "The value of a port is not valid.", tree=check)
