# SPDX-License-Identifier: Apache-2.0
"""The rule `tree-semantics`, which tree_semantics.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.instances import instances

CONTINUING = ("Repeat", "RetryUntilSuccessful", "RetryUntilSuccesful", "SequenceWithMemory", "SequenceStar")
"""The nodes that return RUNNING in BehaviorTree.CPP before they continue after a child that has ended at once."""
_CHOICE = 'state `tree-semantics="behaviortree-cpp"` or `"as2fm"` in the system file or in `as2fm.toml`'


def check(context: TreeContext) -> Iterator[Finding]:
    """Report the first node of each kind for which AS2FM has another meaning (docs/spec/nodes.md#as2fm), if nothing
    states which meaning is intended."""
    if context.system is None or context.system.parameters.semantics is not None:
        return
    seen: set[str] = set()
    for node, automaton in instances(context):
        name = automaton.outline.name
        reason = _reason(name, acts=bool(automaton.path) and automaton.outline.plugin.acts_on_first_halt)
        if reason and name not in seen and node.plugin is not None:
            seen.add(name)
            yield RULE.at(node.plugin.span, f"{reason}; {_CHOICE}")


def _reason(name: str, *, acts: bool) -> str:
    """How AS2FM differs; "" if it does not."""
    if name in CONTINUING:
        return (
            f"after a child of `{name}` that ends at once, BehaviorTree.CPP continues at the next tick, and AS2FM in "
            "the same tick"
        )
    if acts:
        return f"`{name}` reacts to a halt before its first tick, which AS2FM sends and BehaviorTree.CPP does not"
    return ""


RULE = Rule(
    "tree-semantics",
    Severity.INFORMATION,
    "A node has another meaning in AS2FM, and nothing states which meaning is intended.",
    tree=check,
)
