# SPDX-License-Identifier: Apache-2.0
"""The rule `duplicate-data`, which duplicate_data.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.edit.elements import remove
from roaml.expr.types import leaves
from roaml.model.machine import Data
from roaml.model.syntax import Name
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        first: dict[str, Data] = {}
        for data in chart.data:
            if data.id is not None and (before := first.setdefault(data.id.value, data)) is not data:
                assert before.id is not None
                related = (Related(before.id.span, "the first declaration"),)
                same = _written(context, data) == _written(context, before)
                fix = remove(context.document, data.element, "Remove this declaration", preferred=same)
                message = f"there are two variables `{data.id.value}`; remove or rename one of them"
                yield RULE.at(data.id.span, message, fix, related=related)
        yield from _flattened(context, chart.scope, {name: data.id for name, data in first.items() if data.id})


def _written(context: MachineContext, data: Data) -> str:
    return "".join(context.source.text[data.element.span.start : data.element.span.end].split())


def _flattened(context: MachineContext, scope: str, names: dict[str, Name]) -> Iterator[Finding]:
    """Report a variable `p__x` beside a struct `p` with a member `x`: the translation gives both the same name."""
    for name, type_ in context.typed.variables.get(scope, {}).items():
        for path, _ in leaves(type_):
            flat = "__".join((name, *path))
            if path and flat in names:
                related = (Related(names[name].span, "the struct"),)
                message = (
                    f"`{flat}` is also the name of `{'.'.join((name, *path))}` in the translation; rename one of them"
                )
                yield RULE.at(names[flat].span, message, related=related)


RULE = Rule("duplicate-data", Severity.ERROR, "Two variables have the same name.", machine=check, plain=True)
