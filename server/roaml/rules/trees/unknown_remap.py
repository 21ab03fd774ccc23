# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-remap`, which unknown_remap.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.forest.forest import Forest
from roaml.model.expand import node_at, stray_remaps
from roaml.rules.rule import Rule, TreeContext, did_you_mean, listing, replacements


def check(context: TreeContext) -> Iterator[Finding]:
    if context.missing_includes:
        return
    for stray in stray_remaps(context.files, context.source.path):
        node = node_at(context.file, stray.source)
        setting = next((s for s in node.ports if s.key.value == stray.key), None) if node else None
        if node is None or node.plugin is None or setting is None:
            continue
        if not stray.meant and context.forest is not None and _has_unknown_nodes(context.forest):
            continue  # a node of the program may read the entry
        known = f"; it has {listing(stray.names[:6])}" if stray.names else ""
        message = f"the subtree `{node.plugin.value}` has no variable `{stray.key}`{did_you_mean(stray.meant) or known}"
        drop = (
            []
            if stray.meant
            else [Fix(f"Remove `{stray.key}`", (removal(context.source.text, setting.attribute.span),), False)]
        )
        fixes = replacements(setting.key.span, stray.meant)
        severity = Severity.ERROR if stray.meant else Severity.WARNING
        yield RULE.at(setting.key.span, message, *fixes, *drop, severity=severity)


def _has_unknown_nodes(forest: Forest) -> bool:
    """Whether trees contain nodes that no model describes, which may read any entry of the blackboard."""
    return any(forest.is_unknown(node) for _, _, node in forest.all_nodes)


RULE = Rule("unknown-remap", Severity.ERROR, "A subtree does not have a variable that is passed to it.", tree=check)
