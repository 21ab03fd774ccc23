# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-never-written`, which blackboard_never_written.md describes."""

from __future__ import annotations

import functools
from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.libraries import LIBRARIES, library
from roaml.model.gaps import GapAct
from roaml.roles import Direction
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean
from roaml.rules.support.blackboard import described, places, renamings


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is None:
        return
    board = context.system.blackboard
    set_ = [name for name, ports in board.items() if any(bound.port.written for bound in ports)]
    for variable, ports in board.items():
        entry = context.system.entries.get(variable)
        if variable in set_ or (entry is not None and entry.written) or context.system.may(GapAct.VARIABLE, variable):
            continue
        if variable in _hosted() and not any(bound.automaton.path for bound in ports):
            continue
        close = close_names(variable, set_)
        for bound, span, written in places(context, variable, ports):
            if bound.port.direction is Direction.OUT:
                yield RULE.at(span, f"`{bound.automaton.outline.name}` never writes its port `{bound.port.key}`")
            else:
                message = f"no node writes {described(variable, written)}{did_you_mean(close)}"
                yield RULE.at(span, message, *renamings(span, written, variable, close))


@functools.cache
def _hosted() -> frozenset[str]:
    """The blackboard entries that the programs of libraries set, for example those of Nav2."""
    return frozenset(entry for name in LIBRARIES for entry in library(name).entries)


RULE = Rule("blackboard-never-written", Severity.ERROR, "A blackboard variable is read but never written.", tree=check)
