# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-port`, which unknown_port.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.edit.elements import removal
from roaml.forest.forest import OLD_ATTRIBUTES
from roaml.forest.ports import ports_of, probable_ports
from roaml.libraries import Node
from roaml.libraries.node import EVENT_ATTRIBUTE
from roaml.libraries.programs.assembly import reads_world
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS
from roaml.model.outline import MachineOutline
from roaml.model.system import CHILDREN_COUNT
from roaml.model.tree import TreeNode, nodes
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean, listing, replacements
from roaml.rules.support.forest import forest_of, probably_meant
from roaml.suggest import are_similar


def check(context: TreeContext) -> Iterator[Finding]:
    yield from _alone(context) if context.system is None else _of_system(context)


def _of_system(context: TreeContext) -> Iterator[Finding]:
    assert context.system is not None
    for tree in context.file.trees:
        for node in nodes(tree):
            if not node.is_subtree and node.plugin is not None:
                path, plugin = context.system.plugin(node.plugin.value)
                if plugin is not None:
                    yield from _check(context, node, plugin, path)


def _check(context: TreeContext, node: TreeNode, plugin: MachineOutline, path: str) -> Iterator[Finding]:
    keys = [port.key for port in plugin.ports]
    related = [Related(Symbol(path, SymbolKind.MACHINE, plugin.name), "the plugin")] if path else []
    for setting in node.ports:
        key = setting.key
        edit = removal(context.source.text, setting.attribute.span)
        if key.value == EVENT_ATTRIBUTE and reads_world(plugin.name) and not path:
            continue
        if key.value == CHILDREN_COUNT:
            if CHILDREN_COUNT not in keys and path:
                continue  # no effect: a user's plugin that does not declare the port cannot read it
            message = f"`{CHILDREN_COUNT}` is set automatically and cannot be set here; remove it"
            yield RULE.at(key.span, message, Fix(f"Remove `{key.value}`", (edit,)), related=related)
        elif key.value not in keys and plugin.all_ports:
            given = {other.key.value for other in node.ports}
            free = [k for k in keys if k not in given]
            close = close_names(key.value, free)
            # A misspelled port would also be reported as missing.
            drop = [] if close else [Fix(f"Remove `{key.value}`", (edit,), preferred=False)]
            known = f"; it has {listing(keys)}" if keys else "; it has no ports"
            hint = did_you_mean(close) or known
            message = f"`{plugin.name}` has no port `{key.value}`{hint}"
            yield RULE.at(key.span, message, *replacements(key.span, close), *drop, related=related)


# ------------------------------------------------------------ trees without a system


MAX_PORTS = 8
"""The maximum number of ports that a message lists."""

_OF_LIBRARY = (*CONDITIONS, *AFTERWARDS, "_autoremap", "_description", "_uid", "_fullpath")


def _alone(context: TreeContext) -> Iterator[Finding]:
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


RULE = Rule("unknown-port", Severity.ERROR, "A node sets a port that it does not have.", tree=check)
