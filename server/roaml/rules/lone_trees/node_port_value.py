# SPDX-License-Identifier: Apache-2.0
"""The rule `node-port-value`, which node_port_value.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Set

from roaml.diagnostics import Finding, Fix, Severity
from roaml.forest.cpp_types import is_converted, mismatch
from roaml.forest.entries import entry_of, names_entry
from roaml.forest.ports import ports_of
from roaml.libraries import Node, Port
from roaml.libraries.scripts import SCRIPT
from roaml.model.tree import PortSetting, TreeNode
from roaml.roles import Direction, NodeKind
from roaml.rules.rule import Rule, TreeContext, replacements
from roaml.rules.support.entries import names_of
from roaml.rules.support.forest import forest_of
from roaml.text import TextEdit

_NAME = re.compile(r"[A-Za-z_][\w.-]*\Z", re.ASCII)


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for tree, node in forest.own_nodes:
        known = forest.declaration(node)
        for setting in ports_of(node):
            port = known.port(setting.attribute.name) if known else None
            if port is not None and port.type == SCRIPT:
                continue
            wrong = list(_reference(setting))
            if not wrong and entry_of(setting) is None:
                names = names_of(forest, tree.id.value if tree.id else "") | forest.host_entries
                wrong = list(_without_braces(node, port, setting, names))
            yield from wrong
            if known is not None and port is not None and not wrong and entry_of(setting) is None:
                yield from _literal(known, port, setting)
    for model in context.file.models:
        for described in model.ports:
            default = described.element.get("default")
            if default is not None and default.value.strip('" ') and not default.value.strip().startswith("{"):
                problem = mismatch(described.type, default.value.strip('" '))
                if problem is not None and not problem.ignored and not _is_code(default.value):
                    name = described.name.value if described.name else ""
                    message = f"the default of the port `{name}` {problem.message}"
                    yield RULE.at(default.value_span, message, severity=Severity.WARNING)


_CODE = re.compile(r".*[(:<]|[\d.]+f\Z", re.DOTALL)


def _is_code(text: str) -> bool:
    """Whether a default is a C++ expression. Models contain these as descriptions for readers; they are not values."""
    return bool(_CODE.match(text))


def _reference(setting: PortSetting) -> Iterator[Finding]:
    value = setting.value.value
    inner = value.strip()
    opens, closes = inner.startswith("{"), inner.endswith("}")
    if opens and closes:
        name = inner[1:-1]
        if not name.strip():
            yield RULE.at(
                setting.value.span, "the braces do not contain the name of a blackboard entry; write `{name}`"
            )
        elif _NAME.match(name.strip("{}")) and name.strip("{}") != name:
            plain = f"{{{name.strip('{}')}}}"
            message = f"`{inner}` has too many braces, which become part of the name of the entry; write `{plain}`"
            yield RULE.at(
                setting.value.span, message, *replacements(setting.value.span, (plain,)), severity=Severity.WARNING
            )
        elif name != name.strip() and "{" not in name:
            plain = f"{{{name.strip()}}}"
            message = f"the spaces in the braces become part of the name of the entry; write `{plain}`"
            yield RULE.at(
                setting.value.span, message, *replacements(setting.value.span, (plain,)), severity=Severity.WARNING
            )
    elif opens != closes and inner.count("{") != inner.count("}"):
        name = inner.strip("{}").strip()
        fixes = replacements(setting.value.span, (f"{{{name}}}",)) if _NAME.match(name) else ()
        message = f"`{inner}` has only one of two braces, so it is a string and not an entry; add the other brace"
        yield RULE.at(setting.value.span, message, *fixes, severity=Severity.WARNING)


_DOLLAR = re.compile(r"[$#%]\{(@?[A-Za-z_][\w.-]*)\}\Z", re.ASCII)


def _without_braces(node: TreeNode, port: Port | None, setting: PortSetting, names: Set[str]) -> Iterator[Finding]:
    """Report a constant that is probably intended to be an entry of the tree: `${name}`; `name` if BehaviorTree.CPP
    cannot convert a text to the type of the port; and `name` if a subtree passes it under another name."""
    text, span = setting.value.value.strip(), setting.value.span
    dollar = _DOLLAR.match(text)
    name = dollar[1] if dollar else text
    is_known = name in names or name.removeprefix("@") in names
    if not is_known or (port is not None and port.direction is Direction.OUT):
        return
    severity = Severity.WARNING
    if dollar is None:
        subtree = node.is_subtree and setting.attribute.name != name
        if not subtree and (port is None or is_converted(port.type)):
            return
        severity = Severity.INFORMATION if subtree else severity
    message = f"`{text}` is a constant; write `{{{name}}}` for the entry `{name}`"
    yield RULE.at(span, message, *replacements(span, (f"{{{name}}}",)), severity=severity)


def _literal(known: Node, port: Port, setting: PortSetting) -> Iterator[Finding]:
    text, span = setting.value.value, setting.value.span
    if port.direction is Direction.OUT:
        name = text.strip()
        fixes = [Fix(f"Change to `{{{name}}}`", (TextEdit(span, f"{{{name}}}"),))] if _NAME.match(name) else []
        reason = f"not the string `{name}`" if name else "not an empty value"
        message = f"`{port.name}` of `{known.name}` is an output port: it needs a blackboard entry in braces, {reason}"
        yield RULE.at(span, message, *fixes, severity=_severity(known))
        return
    if not text.strip() and names_entry(known, port.name):
        yield RULE.at(span, f"`{port.name}` of `{known.name}` needs the name of a blackboard entry")
        return
    problem = mismatch(port.type, text)
    if problem is not None:
        severity = Severity.WARNING if problem.ignored else _severity(known)
        fixes = list(replacements(span, (problem.instead,))) if problem.instead else []
        shown = f"`{text.strip()}`" if text.strip() else "an empty value"
        message = f"`{port.name}` of `{known.name}` {problem.message}, not {shown}"
        if problem.ignored:
            message = f"`{port.name}` of `{known.name}` {problem.message}"
        yield RULE.at(span, message, *fixes, severity=severity)


def _severity(known: Node) -> Severity:
    """The severity of a finding: warning if the node is described by a model in a file, which may differ from the node,
    otherwise error."""
    return Severity.ERROR if known.library or known.kind is NodeKind.SUBTREE else Severity.WARNING


RULE = Rule("node-port-value", Severity.ERROR, "The value of a port is invalid.", tree=check)
