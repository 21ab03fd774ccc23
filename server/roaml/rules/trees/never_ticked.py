# SPDX-License-Identifier: Apache-2.0
"""The rule `never-ticked`, which never_ticked.md describes. `roaml.project.explored_findings` reports it,
because it needs all reachable states of a system."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule


def finding(
    node: TreeNode,
    before: TreeNode,
    status: str,
    related: Iterable[Related],
    *,
    no_run: str,
    is_instant: bool,
    is_missed: bool,
    is_harmless: bool,
) -> Finding:
    """The finding that a node is never ticked, because the sibling before it never returns a status.

    Args:
        no_run: the subject of the statement, such as "no run of this system".
        is_instant: whether this is only known if all machines react at once.
        is_missed: whether the sibling would return the status if it were ticked again while later nodes run.
        is_harmless: whether no action fails nevertheless, so that one check may be enough.
    """
    assumed = " if all machines react at once" if is_instant else ""
    name = before.name.value if before.name is not None else before.type_name
    remedy = "check what decides this status, when it is ticked, and whether an `Inverter` is missing or superfluous"
    if is_missed:
        remedy = (
            "it would if it were ticked again while later nodes are running; use `ReactiveSequence` or "
            "`ReactiveFallback` around it if that matters"
        )
    message = f"{no_run} ticks this node{assumed}: `{name}` before it never returns {status}; {remedy}"
    severity = Severity.INFORMATION if is_harmless else None
    return RULE.at(node.element.name_span, message, severity=severity, related=related)


RULE = Rule("never-ticked", Severity.WARNING, "No run of the system ticks a node of its tree.", whole=True)
