# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-node-port`, which unknown_node_port.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.forest.forest import OLD_ATTRIBUTES
from roaml.forest.ports import ports_of, probable_ports
from roaml.libraries import Node
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext, did_you_mean, listing, replacements
from roaml.rules.support.forest import forest_of, probably_meant
from roaml.suggest import are_similar

MAX_PORTS = 8
"""The maximum number of ports that a message lists."""

_OF_LIBRARY = (*CONDITIONS, *AFTERWARDS, "_autoremap", "_description", "_uid", "_fullpath")


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes:
        yield from _conditions(node)
        yield from _identifier(node)
        known = forest.known_node(node)
        if known is not None and not forest.is_partly_described(known):
            yield from _ports(context, node, known)


def _ports(context: TreeContext, node: TreeNode, known: Node) -> Iterator[Finding]:
    names = [port.name for port in known.ports if not port.alias_of]
    probable = probable_ports(node, known)
    for setting in ports_of(node):
        attribute = setting.attribute
        if attribute.name not in probable:
            continue
        close = probable[attribute.name]
        hint = did_you_mean(close) or _known(names)
        drop = Fix(f"Remove `{attribute.name}`", (removal(context.source.text, attribute.span),), preferred=False)
        fixes = (*replacements(attribute.name_span, close), *(() if close else (drop,)))
        # Only a warning: a model in a file may be older than the node.
        severity = Severity.ERROR if known.library else Severity.WARNING
        message = f"`{known.name}` has no port `{attribute.name}`{hint}"
        yield RULE.at(attribute.name_span, message, *fixes, severity=severity)


def _known(names: list[str]) -> str:
    if not names:
        return "; it has no ports"
    more = " and others" if len(names) > MAX_PORTS else ""
    return f"; it has {listing(names[:MAX_PORTS])}{more}"


def _identifier(node: TreeNode) -> Iterator[Finding]:
    """Report a misspelled `ID`."""
    if node.plugin is None:
        for attribute in node.element.attributes:
            if attribute.name != "ID" and are_similar(attribute.name, "ID"):
                message = f"`<{node.element.name}>` has no attribute `{attribute.name}`; did you mean `ID`?"
                yield RULE.at(attribute.name_span, message, *replacements(attribute.name_span, ("ID",)))


def _conditions(node: TreeNode) -> Iterator[Finding]:
    """Report attributes of subtrees of version 3, and misspelled attributes that begin with `_`; BehaviorTree.CPP
    ignores them."""
    for attribute in node.element.attributes:
        if attribute.name in OLD_ATTRIBUTES and node.is_subtree:
            message = f"`{attribute.name}` is an attribute of version 3 and is ignored; version 4 has `_autoremap`"
            current = () if node.element.get("_autoremap") else ("_autoremap",)
            fixes = replacements(attribute.name_span, current)
            yield RULE.at(attribute.name_span, message, *fixes, severity=Severity.WARNING)
        elif attribute.name.startswith("_") and attribute.name not in _OF_LIBRARY:
            near = probably_meant(attribute.name, _OF_LIBRARY) or _extended(attribute.name)
            if near is not None and node.element.get(near) is None:
                message = f"`{attribute.name}` is ignored; did you mean `{near}`?"
                fixes = replacements(attribute.name_span, (near,))
                yield RULE.at(attribute.name_span, message, *fixes, severity=Severity.WARNING)


def _extended(name: str) -> str | None:
    """The known attribute that begins with `name` or with which `name` begins, for example `_onFailure` for `_onFail`.
    `None` if there is none, or if `name` has fewer than four characters."""
    plain = name.lower()
    return next(
        (other for other in (*CONDITIONS, *AFTERWARDS) if len(plain) > 3 and _is_part(plain, other.lower())), None
    )


def _is_part(one: str, other: str) -> bool:
    return one.startswith(other) or other.startswith(one)


RULE = Rule("unknown-node-port", Severity.ERROR, "A node sets a port that it does not have.", tree=check)
