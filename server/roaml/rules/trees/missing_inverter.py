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

_SUPPLIES = frozenset(("charge", "recharge", "refill"))
_CLEARANCES = frozenset(("clear", "free", "recover", "rescue", "unblock", "unjam"))
_REPAIRS = frozenset(("recover", "repair", "rescue", "reset", "restore"))
_REMEDIES = {
    **dict.fromkeys(("empty", "low"), _SUPPLIES),
    **dict.fromkeys(("blocked", "jammed", "stuck"), _CLEARANCES),
    **dict.fromkeys(("bumped", "collided", "collision", "failed", "fallen", "fell", "lost", "tilted"), _REPAIRS),
    "dropped": _REPAIRS - {"reset"},
}
"""The last words of the names of conditions that hold if something is wrong -> the first words of the names of actions
that correct it."""

_NEGATIONS = frozenset(("no", "not", "never", "without"))
_VERBS = frozenset(("are", "check", "has", "have", "is", "was"))
"""Words before the object of a condition."""


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
                if is_inverted is is_fallback or not _corrects(action, leaf):
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


def _corrects(action: TreeNode, condition: TreeNode) -> bool:
    """Whether the names say that an action corrects what a condition states: the verb is a remedy for this problem, and
    both have the same object, as in `BlockFell` and `RecoverBlock`, or one of them has none."""
    state, deed = words_of(condition.type_name), words_of(action.type_name)
    if condition.children or action.children or not state or not deed or not _NEGATIONS.isdisjoint(state):
        return False
    objects, others = set(state[:-1]) - _VERBS, set(deed[1:])
    return deed[0] in _REMEDIES.get(state[-1], ()) and not (objects and others and objects.isdisjoint(others))


RULE = Rule(
    "missing-inverter",
    Severity.WARNING,
    "A remedy is only executed if nothing is wrong.",
    tree=check,
)
