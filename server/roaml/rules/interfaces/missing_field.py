# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-field`, which missing_field.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import last_in
from roaml.expr.types import Struct, Type, leaves
from roaml.expr.zero import zero_text
from roaml.model.machine import RosSend
from roaml.rules.rule import MachineContext, Rule, close_names, listing
from roaml.rules.support.fields import sent_part

SHOWN = 6
"""The maximum number of fields that a message names."""


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, RosSend):
                missing = _missing(context, statement)
                if missing:
                    yield _finding(context, statement, missing)


def _missing(context: MachineContext, statement: RosSend) -> list[tuple[str, Type]]:
    """The required fields that a statement does not set, with their types."""
    unset = context.typed.unset.get(statement.element, ())
    part = sent_part(context, statement) if unset else None
    if part is None or any(field.name is None for field in statement.fields):
        return []  # missing-attribute reports a field without a name, which may be the missing field
    # A field that is only misspelled, or set as a whole, is reported as an unknown field.
    names = {field.name.value for field in statement.fields if field.name}
    known = [".".join(path) for path, _ in leaves(part)]
    intended = {path for name in names.difference(known) for path in _misspelled_fields(name, known)}
    return [(path, type_) for path, type_ in unset if path not in intended]


def _misspelled_fields(name: str, known: Iterable[str]) -> tuple[str, ...]:
    """The known fields that a field with the unknown name `name` was probably intended to set."""
    inside = tuple(path for path in known if path.startswith(f"{name}."))
    return inside or close_names(name, known, 1)


def _finding(context: MachineContext, statement: RosSend, missing: list[tuple[str, Type]]) -> Finding:
    element = statement.element
    part = sent_part(context, statement)
    assert isinstance(part, Struct)
    names = _shortened([name for name, _ in missing])
    is_single = len(missing) == 1
    fields = "field" if is_single else "fields"
    new = [f'<field name="{name}" expr="{zero_text(type_)}" />' for name, type_ in missing]
    fix = Fix(f"Add the missing {fields}", (last_in(context.document, element, *new),))
    if context.older:
        defaults = "is not set and gets its ROS default" if is_single else "are not set and get their ROS defaults"
        message = f"the {fields} {names} of `{part}` {defaults}"
        return RULE.at(element.name_span, message, fix, severity=Severity.INFORMATION)
    return RULE.at(element.name_span, f"the {fields} {names} of `{part}` must be set", fix)


def _shortened(names: list[str]) -> str:
    if len(names) <= SHOWN:
        return listing(names)
    return f"{', '.join(f'`{name}`' for name in names[: SHOWN - 1])} and {len(names) - SHOWN + 1} more"


RULE = Rule("missing-field", Severity.ERROR, "A field of a ROS type is not set.", machine=check)
