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
from roaml.forest.forest import Forest
from roaml.forest.names import entry_of
from roaml.libraries import Node, Port
from roaml.libraries.scripts import SCRIPT
from roaml.model.expand import PortConstant
from roaml.model.outline import MachineOutline, PortOutline
from roaml.model.syntax import Name
from roaml.model.system import ANY_TYPE
from roaml.model.tree import (
    NodeModel,
    PortModel,
    PortSetting,
    TreeNode,
    is_reserved_variable,
    is_variable_name,
    looks_like_reference,
)
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import Direction, NodeKind, SymbolKind
from roaml.rules.rule import Rule, TreeContext, replacements
from roaml.rules.support.entries import names_of
from roaml.rules.support.forest import trees_of
from roaml.rules.support.instances import instances
from roaml.text import Decoded, TextEdit

_NAME = regex(r"[A-Za-z_][\w.-]*\Z", re.ASCII)
_DOLLAR = regex(r"[$#%]\{(@?[A-Za-z_][\w.-]*)\}\Z", re.ASCII)
_SYSTEM_STATUSES = ("1", "2", "3")
"""The numbers that trees of systems may use for statuses."""


def check(context: TreeContext) -> Iterator[Finding]:
    trees = trees_of(context)
    if trees is None:
        return
    for tree, node in trees.own_nodes:
        names = names_of(trees, tree.id.value if tree.id else "") | trees.host_entries
        for setting in trees.port_settings(node):
            yield from _setting(trees, names, node, setting)
    for model in context.file.models:
        for port in model.ports:
            default = port.element.get("default")
            if default is not None and port.name is not None and model.id is not None:
                value = Name(default.value, default.value_span)
                yield from _default(trees, model, port, port.name.value, value)
    yield from _given_by_subtrees(context, trees)


def _setting(trees: Forest, names: Set[str], node: TreeNode, setting: PortSetting) -> Iterator[Finding]:
    known = trees.declaration(node)
    port = known.port(setting.key.value) if known is not None else None
    if port is not None and port.type == SCRIPT:
        return
    is_text = node.is_subtree or (port is not None and port.type == "string")
    severity = Severity.WARNING if is_text or trees.system is None else None
    entry = entry_of(setting) if trees.system is None else setting.variable
    wrong = list(_reference(trees, setting.value, severity))
    if not wrong and entry is None:
        wrong = list(_without_braces(node, port, setting, names, severity))
    yield from wrong
    if known is not None and port is not None and not wrong and entry is None:
        yield from _constant(trees, known, port, setting.value)


def _default(trees: Forest, model: NodeModel, port: PortModel, name: str, value: Name) -> Iterator[Finding]:
    """Check a default of `<TreeNodesModel>`. In a system, it is the value of every node that does not set the port."""
    assert model.id is not None
    if trees.system is None:
        text = value.value.strip('" ')
        is_text = not text or value.value.strip().startswith("{") or _CODE.match(value.value)
        problem = None if is_text else _as_library_reads(port.type, text)
        if problem is not None and problem.severity is Severity.ERROR:
            yield RULE.at(value.span, f"`{name}` of `{model.id.value}` {problem.message}", severity=Severity.WARNING)
        return
    known = None if model.is_subtree else trees.node(model.id.value)
    declared = known.port(name) if known is not None else None
    if known is not None and declared is not None:
        yield from _reference(trees, value, None)
        if not looks_like_reference(value.value):
            yield from _constant(trees, known, declared, value)


_CODE = regex(r".*[(:<]|[\d.]+f\Z", re.DOTALL)
"""Matches defaults that are C++ expressions. Models contain these as descriptions for readers; they are not values."""


# ------------------------------------------------------------ references


def _reference(trees: Forest, value: Name, severity: Severity | None) -> Iterator[Finding]:
    """Report braces that do not contain exactly a name, in a system one that the translation can use."""
    wrong = list(_braces(value, severity))
    yield from wrong
    text = value.value.strip()
    if wrong or trees.system is None or not looks_like_reference(text):
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


def _braces(value: Name, severity: Severity | None) -> Iterator[Finding]:
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


# ------------------------------------------------------------ constants


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


def _constant(trees: Forest, known: Node, port: Port, value: Name) -> Iterator[Finding]:
    """Check the constant value of a port."""
    text, span = value.value, value.span
    path, plugin = _plugin(trees, known)
    declared = plugin.port(port.name) if plugin is not None else None
    related = [Related(Symbol(path, SymbolKind.PORT, port.name), "declared here")] if path else []
    # A model in a file may differ from the node.
    is_certain = known.library or plugin is not None or known.kind is NodeKind.SUBTREE
    severity = Severity.ERROR if is_certain else Severity.WARNING
    if (declared or port).direction is Direction.OUT:
        name = text.strip()
        fixes = [Fix(f"Change to `{{{name}}}`", (TextEdit(span, f"{{{name}}}"),))] if _NAME.match(name) else []
        reason = f"not the string `{name}`" if name else "not an empty value"
        message = f"`{port.name}` of `{known.name}` is an output port: it needs a blackboard entry in braces, {reason}"
        yield RULE.at(span, message, *fixes, severity=severity, related=related)
    elif not text.strip() and port.names_entry:
        yield RULE.at(span, f"`{port.name}` of `{known.name}` needs the name of a blackboard entry")
    elif (problem := _problem(trees, known, port, text)) is not None:
        new = (problem.replacement,) if problem.replacement else ()
        message, severity = f"`{port.name}` of `{known.name}` {problem.message}", min(severity, problem.severity)
        yield RULE.at(span, message, *replacements(span, new), severity=severity, related=related)


def _plugin(trees: Forest, known: Node) -> tuple[str, MachineOutline | None]:
    """What executes a node of a system, with the path of its file."""
    is_node = trees.system is not None and known.kind is not NodeKind.SUBTREE
    return trees.system.plugin(known.name) if trees.system is not None and is_node else ("", None)


def _given_by_subtrees(context: TreeContext, trees: Forest) -> Iterator[Finding]:
    """Check a constant that a `<SubTree>` of a system passes for a variable: it becomes the value of the ports bound to
    that variable."""
    for node, automaton in instances(context):
        known = trees.known_node(node)
        for setting in node.ports if known is not None else ():
            port = known.port(setting.key.value) if known is not None else None
            value = automaton.port(setting.key.value)
            if known is None or setting.variable is None or port is None or not isinstance(value, PortConstant):
                continue
            problem = _problem(trees, known, port, value.text)
            if problem is not None:
                message = f"the `<SubTree>` passes `{value.text}` for `{setting.variable}`, but "
                message += f"`{port.name}` of `{known.name}` {problem.message}"
                yield RULE.at(setting.value.span, message, severity=problem.severity)


def _problem(trees: Forest, known: Node, port: Port, text: str) -> ConstantProblem | None:
    """The reason why an input port cannot hold a constant; `None` if it can."""
    _, plugin = _plugin(trees, known)
    declared = plugin.port(port.name) if plugin is not None else None
    if declared is not None and declared.type != ANY_TYPE:
        if declared.direction is Direction.OUT:
            return None
        return problem_of(text.strip(), declared) or _too_long(trees, declared, text)
    if plugin is not None and (known.name.startswith("Switch") or _is_system_status(port, text)):
        return None
    return _as_library_reads(port.type, text)


def _too_long(trees: Forest, port: PortOutline, text: str) -> ConstantProblem | None:
    """The problem that a plugin stores a string with more bytes than a variable can hold; `None` if there is none. The
    name of an interface is not stored."""
    type_ = BASE_TYPES.get(port.type)
    if trees.system is None or not port.stored or type_ is None or not is_kind(type_, ScalarKind.STRING):
        return None
    length, most = len(text.encode("utf-8", "replace")), trees.system.parameters.max_array_size
    if length <= most:
        return None
    return ConstantProblem(f"has {length} bytes, but a string holds at most {most}; increase `max_array_size`")


def _is_system_status(port: Port, text: str) -> bool:
    return port.type == "NodeStatus" and text.strip() in _SYSTEM_STATUSES


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


RULE = Rule("port-value", Severity.ERROR, "The value of a port is not valid.", tree=check)
