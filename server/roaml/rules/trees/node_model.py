# SPDX-License-Identifier: Apache-2.0
"""The rule `node-model`, which node_model.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.edit.elements import remove, rename_tag
from roaml.forest.cpp_types import SIMPLE_TYPES, normal
from roaml.forest.forest import CPP
from roaml.libraries import Node, library_node
from roaml.model.outline import MachineOutline
from roaml.model.tree import NodeModel, PortModel
from roaml.roles import Direction, SymbolKind
from roaml.rules.rule import Rule, TreeContext, did_you_mean, listing, replacements
from roaml.rules.support.forest import forest_of, probably_meant
from roaml.suggest import close_names


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is None and forest_of(context) is None:
        return
    for model in context.file.models:
        if model.is_subtree:
            yield from _subtree(context, model)
        for port in model.ports:
            yield from _type(port)
        if model.id is not None and not model.is_subtree:
            yield from _ports(context, model, model.id.value)


def _subtree(context: TreeContext, model: NodeModel) -> Iterator[Finding]:
    trees = [tree.id for file in context.files for tree in file.trees]
    complete = not context.missing_includes and (context.forest is None or context.forest.complete)
    if model.id is None or model.id.value in trees or not complete:
        return
    near = probably_meant(model.id.value, trees)
    described = {other.id.value for other in context.file.models if other.id is not None and other.is_subtree}
    if near is not None and near not in (described if context.forest is None else context.forest.subtree_models):
        message = f"there is no tree `{model.id.value}`{did_you_mean((near,))}"
        yield RULE.at(model.id.span, message, *replacements(model.id.span, (near,)))


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


def _ports(context: TreeContext, model: NodeModel, name: str) -> Iterator[Finding]:
    """Compare a model with the plugin of a system, or with the node of a library."""
    path, plugin = context.system.plugin(name) if context.system is not None else ("", None)
    declared = library_node(name) if context.system is not None else CPP.nodes.get(name)
    if plugin is not None and path:
        related = [Related(Symbol(path, SymbolKind.MACHINE, plugin.name), "the plugin")]
        yield from _compared(context, model, name, _of_plugin(plugin), related, None)
    elif declared is not None and not (declared.until and context.system is None):
        severity = Severity.INFORMATION if context.system is None else None
        yield from _compared(context, model, name, _of_library(declared), (), severity)


def _of_plugin(plugin: MachineOutline) -> dict[str, tuple[Direction, ...]]:
    return {port.key: (port.direction, Direction.INOUT) for port in plugin.ports}


def _of_library(node: Node) -> dict[str, tuple[Direction, ...]]:
    """Port -> the directions that a model may state, the declared one first. An alias has none, which allows any."""
    directions = {port.name: [port.direction, port.system_direction] for port in node.ports if not port.alias_of}
    aliases: dict[str, tuple[Direction, ...]] = {port.name: () for port in node.ports if port.alias_of}
    return aliases | {name: tuple(filter(None, given)) for name, given in directions.items()}


def _compared(
    context: TreeContext,
    model: NodeModel,
    name: str,
    ports: dict[str, tuple[Direction, ...]],
    related: Iterable[Related],
    severity: Severity | None,
) -> Iterator[Finding]:
    names = [port for port, directions in ports.items() if directions]
    for port in model.ports:
        if port.name is None:
            continue
        directions = ports.get(port.name.value)
        if directions is None:
            close = close_names(port.name.value, names)
            hint = did_you_mean(close) or (f"; it has {listing(names)}" if names else "; it has no ports")
            fixes = (*replacements(port.name.span, close), remove(context.document, port.element))
            message = f"`{name}` has no port `{port.name.value}`{hint}"
            yield RULE.at(port.name.span, message, *fixes, severity=severity, related=related)
        elif directions and port.direction not in directions:
            tag = f"{directions[0]}put_port" if directions[0] is not Direction.INOUT else "inout_port"
            message = f"the port `{port.name.value}` of `{name}` is an `<{tag}>`"
            fix = rename_tag(port.element, tag)
            yield RULE.at(port.element.name_span, message, fix, severity=severity, related=related)


RULE = Rule(
    "node-model",
    Severity.WARNING,
    "A model in `<TreeNodesModel>` has an unknown tree or type, or contradicts its node.",
    tree=check,
)
