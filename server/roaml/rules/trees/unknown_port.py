# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-port`, which unknown_port.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.edit.elements import removal
from roaml.forest.forest import Forest
from roaml.forest.ports import probable_ports
from roaml.forest.written_for import OLD_ATTRIBUTES
from roaml.libraries import LIBRARIES, Node, library
from roaml.libraries.node import EVENT_ATTRIBUTE, FormerPort
from roaml.libraries.programs.assembly import reads_world
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS
from roaml.model.system import CHILDREN_COUNT
from roaml.model.tree import PortSetting, TreeNode
from roaml.record import replace
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, TreeContext, did_you_mean, listing, replacements
from roaml.rules.support.forest import probably_meant, trees_of
from roaml.suggest import are_similar
from roaml.xml_syntax.tree import Attribute

MAX_PORTS = 8
"""The maximum number of ports that a message lists."""

_OF_LIBRARY = (*CONDITIONS, *AFTERWARDS, "_autoremap", "_description", "_uid", "_fullpath")


def check(context: TreeContext) -> Iterator[Finding]:
    trees = trees_of(context)
    if trees is None:
        return
    for _, node in trees.own_nodes:
        if trees.system is None:
            yield from _conditions(node)
            yield from _identifier(node)
        known = trees.known_node(node)
        if known is not None and not trees.is_partly_described(known):
            yield from _ports(context, trees, node, known)


def _ports(context: TreeContext, trees: Forest, node: TreeNode, known: Node) -> Iterator[Finding]:
    names = [port.name for port in known.ports if not port.alias_of]
    path = trees.system.plugin(known.name)[0] if trees.system is not None else ""
    related = [Related(Symbol(path, SymbolKind.MACHINE, known.name), "the plugin")] if path else []
    # Only a warning: a model in a file may be older than the node.
    severity = Severity.ERROR if known.library or path else Severity.WARNING
    probable = probable_ports(node, known)
    for setting in trees.port_settings(node):
        attribute = setting.attribute
        drop = Fix(f"Remove `{attribute.name}`", (removal(context.source.text, attribute.span),))
        if trees.system is not None and attribute.name == CHILDREN_COUNT:
            # A plugin that does not declare the port cannot read it, so the value has no effect.
            if CHILDREN_COUNT in names or not path:
                message = f"`{CHILDREN_COUNT}` is set automatically and cannot be set here; remove it"
                yield RULE.at(attribute.name_span, message, drop, related=related)
        elif (former := known.former_port(attribute.name)) is not None:
            yield _former(attribute, known, former, drop)
        elif attribute.name in probable if trees.system is None else not _is_port_in_system(setting, known):
            close = probable.get(attribute.name, ())
            hint = did_you_mean(close) or _known(names)
            # A misspelled port would also be reported as missing.
            fixes = replacements(attribute.name_span, close) if close else (replace(drop, preferred=False),)
            message = f"`{known.name}` has no port `{attribute.name}`{hint}"
            yield RULE.at(attribute.name_span, message, *fixes, severity=severity, related=related)


def _former(attribute: Attribute, known: Node, former: FormerPort, drop: Fix) -> Finding:
    """The finding that only earlier releases of the library have a port: a warning, because the tree may be written for
    such a release."""
    name = known.library
    version = next(other.version for other in map(library, LIBRARIES) if other.name == name)
    message = f"`{known.name}` of {name} {version} has no port `{former.name}`; {name} of ROS 2 {former.release} has it"
    if former.now:
        message += f", and `{former.now}` replaces it"
    # A change would break a tree for the earlier release.
    fixes = replacements(attribute.name_span, (former.now,)) if former.now else (drop,)
    optional = (replace(fix, preferred=False) for fix in fixes)
    return RULE.at(attribute.name_span, message, *optional, severity=Severity.WARNING)


def _is_port_in_system(setting: PortSetting, known: Node) -> bool:
    """Whether a system reads an attribute as a port, which may have the name of an alias, or as a probability."""
    is_event = setting.key.value == EVENT_ATTRIBUTE and bool(known.library) and reads_world(known.name)
    return is_event or known.port(setting.key.value) is not None


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
