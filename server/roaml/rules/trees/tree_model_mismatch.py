# SPDX-License-Identifier: Apache-2.0
"""The rule `tree-model-mismatch`, which tree_model_mismatch.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.edit.elements import remove, rename_tag
from roaml.model.outline import MachineOutline
from roaml.model.tree import NodeModel
from roaml.roles import Direction, SymbolKind
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean, replacements


def check(context: TreeContext) -> Iterator[Finding]:
    """Compare `<TreeNodesModel>` with the plugins."""
    if context.system is None:
        return
    for model in context.file.models:
        if model.id is None or model.is_subtree:
            continue
        path, plugin = context.system.plugin(model.id.value)
        if plugin is not None:
            yield from _check(context, model, plugin, path)


def _check(context: TreeContext, model: NodeModel, plugin: MachineOutline, path: str) -> Iterator[Finding]:
    related = [Related(Symbol(path, SymbolKind.MACHINE, plugin.name), "the plugin")] if path else []
    for port in model.ports:
        if port.name is None:
            continue
        known = plugin.port(port.name.value)
        if known is None:
            drop = remove(context.document, port.element)
            close = close_names(port.name.value, [p.key for p in plugin.ports])
            message = f"the plugin `{plugin.name}` has no port `{port.name.value}`{did_you_mean(close)}"
            yield RULE.at(port.name.span, message, *replacements(port.name.span, close), drop, related=related)
        elif port.direction not in (Direction.INOUT, known.direction):
            message = f"the port `{port.name.value}` of `{plugin.name}` is an {known.direction}put port"
            fix = rename_tag(port.element, f"{known.direction}put_port")
            yield RULE.at(port.element.name_span, message, fix, related=related)


RULE = Rule(
    "tree-model-mismatch",
    Severity.WARNING,
    "`<TreeNodesModel>` contradicts the plugin.",
    tree=check,
)
