# SPDX-License-Identifier: Apache-2.0
"""The rule `node-model`, which node_model.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.edit.elements import remove, rename_tag
from roaml.forest.cpp_types import SIMPLE_TYPES, normal
from roaml.forest.forest import Forest
from roaml.libraries import Port
from roaml.model.syntax import Name
from roaml.model.tree import NodeModel, PortModel
from roaml.roles import Direction, SymbolKind
from roaml.rules.rule import Rule, TreeContext, did_you_mean, listing, replacements
from roaml.rules.support.forest import probably_meant, trees_of
from roaml.suggest import close_names


def check(context: TreeContext) -> Iterator[Finding]:
    trees = trees_of(context)
    for model in context.file.models if trees is not None else ():
        assert trees is not None
        for port in model.ports:
            yield from _type(port)
        if model.id is not None and model.is_subtree:
            yield from _subtree(context, trees, model.id)
        elif model.id is not None:
            yield from _ports(context, trees, model, model.id.value)


def _subtree(context: TreeContext, trees: Forest, name: Name) -> Iterator[Finding]:
    if name.value in trees.trees or context.missing_includes or not trees.complete:
        return
    near = probably_meant(name.value, trees.trees)
    if near is not None and near not in trees.subtree_models:
        message = f"there is no tree `{name.value}`{did_you_mean((near,))}"
        yield RULE.at(name.span, message, *replacements(name.span, (near,)))


def _type(port: PortModel) -> Iterator[Finding]:
    """Report a misspelled type. Only names of lower-case letters are checked: other names may be types that a program
    defines."""
    attribute = port.element.get("type")
    written = port.type.strip()
    if attribute is None or not written.isascii() or not written.isalpha() or not written.islower():
        return
    if normal(written) in SIMPLE_TYPES:
        return
    near = probably_meant(written, SIMPLE_TYPES) or _swapped(written)
    if near is not None:
        message = f"unknown type `{written}`{did_you_mean((near,))}"
        yield RULE.at(attribute.value_span, message, *replacements(attribute.value_span, (near,)))


def _swapped(written: str) -> str | None:
    """The simple type with the same letters, such as `int` for `itn`; `None` if there is none."""
    return next((name for name in SIMPLE_TYPES if sorted(name) == sorted(written)), None)


def _ports(context: TreeContext, trees: Forest, model: NodeModel, name: str) -> Iterator[Finding]:
    """Compare a model with the plugin of a system, or with the node of a library."""
    node = trees.node(name)
    if node is None or not (node.library or trees.is_machine(node)):
        return
    path = trees.system.plugin(name)[0] if trees.system is not None else ""
    related = [Related(Symbol(path, SymbolKind.MACHINE, name), "the plugin")] if path else []
    severity = Severity.INFORMATION if trees.system is None else None
    names = [port.name for port in node.ports if not port.alias_of]
    for port in model.ports:
        if port.name is None:
            continue
        known = node.port(port.name.value)
        if known is None:
            close = close_names(port.name.value, names)
            hint = did_you_mean(close) or (f"; it has {listing(names)}" if names else "; it has no ports")
            fixes = (*replacements(port.name.span, close), remove(context.document, port.element))
            message = f"`{name}` has no port `{port.name.value}`{hint}"
            yield RULE.at(port.name.span, message, *fixes, severity=severity, related=related)
        elif not known.alias_of and port.direction not in _directions(known, is_machine=not node.library):
            tag = f"{known.direction}put_port" if known.direction is not Direction.INOUT else "inout_port"
            message = f"the port `{port.name.value}` of `{name}` is an `<{tag}>`"
            fix = rename_tag(port.element, tag)
            yield RULE.at(port.element.name_span, message, fix, severity=severity, related=related)


def _directions(port: Port, *, is_machine: bool) -> tuple[Direction | None, ...]:
    """The directions that a model may state for a port."""
    return port.direction, Direction.INOUT if is_machine else port.system_direction


RULE = Rule(
    "node-model",
    Severity.WARNING,
    "A model in `<TreeNodesModel>` has an unknown tree or type, or contradicts its node.",
    tree=check,
)
