# SPDX-License-Identifier: Apache-2.0
"""duplicate-state: see duplicate_state.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.syntax import Name
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        first: dict[str, Name] = {}
        for state in chart.states:
            if state.id is not None and first.setdefault(state.id.value, state.id) is not state.id:
                related = (Related(first[state.id.value].span, "the first one"),)
                yield RULE.at(state.id.span, f"there are two states `{state.id.value}`", related=related)


RULE = Rule("duplicate-state", Severity.ERROR, "Two states have the same name.", machine=check, plain=True)
