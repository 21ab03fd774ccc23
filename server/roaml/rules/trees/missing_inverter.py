# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-inverter`, which missing_inverter.md describes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.tree import TreeNode, nodes
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.words import words_of
from roaml.text import TextEdit

_PROBLEMS = frozenset(
    (
        *("blocked", "bumped", "collided", "collision", "dropped", "empty", "failed", "fallen", "fell"),
        *("jammed", "lost", "low", "stuck", "tilted"),
    )
)
"""The last words of the names of conditions that hold if something is wrong."""

_REMEDIES = frozenset(
    (
        *("charge", "clear", "free", "recharge", "recover", "refill"),
        *("repair", "rescue", "reset", "restore", "unblock", "unjam"),
    )
)
"""The first words of the names of actions that correct something."""

_NEGATIONS = frozenset(("no", "not", "never", "without"))


def check(context: TreeContext) -> Iterator[Finding]:
    """Report remedies that are only executed if a condition says that nothing is wrong."""
    for tree in context.file.trees:
        for node in nodes(tree):
            is_fallback = node.type_name in ("Fallback", "ReactiveFallback")
            if not is_fallback and node.type_name not in ("Sequence", "ReactiveSequence"):
                continue
            for condition, action in itertools.pairwise(node.children):
                is_inverted = condition.type_name == "Inverter" and len(condition.children) == 1
                leaf = condition.children[0] if is_inverted else condition
                if is_inverted is is_fallback or not _is_problem(leaf) or not _is_remedy(action):
                    continue
                message = (
                    f"`{action.type_name}` is only ticked if `{leaf.type_name}` "
                    f"{'fails' if is_fallback else 'fails, because it is inverted'}, so not if something is wrong; "
                    f"{'add an `Inverter`' if is_fallback else 'remove the `Inverter`'}"
                )
                span, name = condition.element.span, condition.element.name_span
                inside = context.source.text[leaf.element.span.start : leaf.element.span.end]
                fix = (
                    Fix("Add `Inverter`", (TextEdit(span, f"<Inverter>{inside}</Inverter>"),))
                    if is_fallback
                    else Fix("Remove `Inverter`", (TextEdit(span, inside),))
                )
                yield RULE.at(name, message, fix, related=[Related(action.element.name_span, "the remedy")])


def _is_problem(node: TreeNode) -> bool:
    words = words_of(node.type_name)
    return not node.children and words[-1:] != [] and words[-1] in _PROBLEMS and _NEGATIONS.isdisjoint(words)


def _is_remedy(node: TreeNode) -> bool:
    words = words_of(node.type_name)
    return not node.children and words[:1] != [] and words[0] in _REMEDIES


RULE = Rule(
    "missing-inverter",
    Severity.WARNING,
    "A remedy is only executed if nothing is wrong.",
    tree=check,
)
