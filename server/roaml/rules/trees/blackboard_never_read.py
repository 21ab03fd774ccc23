# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-never-read`, which blackboard_never_read.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.gaps import GapAct
from roaml.roles import Direction
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean
from roaml.rules.support.blackboard import described, places, renamings
from roaml.scxml.names import BLACKBOARD_WRITE_PREFIX


def check(context: TreeContext) -> Iterator[Finding]:
    """Report variables that are written but not read. Variables that a property observes are not reported.
    blackboard-never-written reports variables that are neither read nor written."""
    system = context.system
    if system is None:
        return
    board = system.blackboard
    read = [name for name, ports in board.items() if any(bound.port.read for bound in ports)]
    unwritten = [name for name in read if not any(bound.port.written for bound in board[name])]
    for variable, ports in board.items():
        entry = system.entries.get(variable)
        if variable in read or (entry is not None and entry.read) or not any(bound.port.written for bound in ports):
            continue
        if system.is_observed(f"{BLACKBOARD_WRITE_PREFIX}{variable}") or system.may(GapAct.VARIABLE, variable):
            continue
        for bound, span, written in places(context, variable, ports):
            if bound.port.direction is Direction.IN:
                message = f"`{bound.automaton.outline.name}` never reads its port `{bound.port.key}`"
                yield RULE.at(span, message)
            else:
                prefix = bound.automaton.board
                own = variable.removeprefix(prefix)
                close = close_names(own, [name.removeprefix(prefix) for name in unwritten if name.startswith(prefix)])
                message = f"no node reads {described(own, written)}{did_you_mean(close)}"
                yield RULE.at(span, message, *renamings(span, written, own, close))


RULE = Rule("blackboard-never-read", Severity.WARNING, "A blackboard variable is written but never read.", tree=check)
