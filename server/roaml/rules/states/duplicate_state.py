# SPDX-License-Identifier: Apache-2.0
"""The rule `duplicate-state`, which duplicate_state.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.syntax import Name
from roaml.rules.rule import MachineContext, Rule, unused
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        first: dict[str, Name] = {}
        names = {state.id.value for state in chart.states if state.id}
        for state in chart.states:
            if state.id is not None and first.setdefault(state.id.value, state.id) is not state.id:
                related = (Related(first[state.id.value].span, "the first state with this name"),)
                name = unused(state.id.value, names)
                names.add(name)
                rename = Fix(f"Rename this state to `{name}`", (TextEdit(state.id.span, name),), preferred=False)
                message = f"there are two states `{state.id.value}`; rename one of them"
                yield RULE.at(state.id.span, message, rename, related=related)


RULE = Rule("duplicate-state", Severity.ERROR, "Two states have the same name.", machine=check, plain=True)
