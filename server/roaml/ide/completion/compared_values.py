# SPDX-License-Identifier: Apache-2.0
"""Completion of the right side of a comparison in a machine: the constants of the interface, and the values that the
machines of the system send."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from roaml.expr.infer import infer
from roaml.expr.parse import parse
from roaml.expr.types import Struct, StructKind, Type
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank
from roaml.ide.completion.request import Request
from roaml.interfaces.registry import NotFound
from roaml.interfaces.types import SECTION_NAMES, Constant, Kind
from roaml.model.machine import Assign
from roaml.model.syntax import Expression
from roaml.model.value_types import GOAL_STATUSES, find_handle
from roaml.model.values.analyse import DataChannel, data_place
from roaml.model.values.domain import Constant as ConstantValue
from roaml.model.values.domain import ValueSet, joined
from roaml.model.values.evaluate import literal
from roaml.regex import regex
from roaml.text import Decoded

_COMPARED = regex(r"((?:[A-Za-z_]\w*\.)*)([A-Za-z_]\w*)\s*[=!]==?\s*\w*\Z", re.ASCII)


def compared_values(request: Request, start: int, scope: Mapping[str, Type]) -> Iterator[CompletionItem]:
    """Values for the right side of a comparison with a field of event data or with a variable. The caret is behind the
    operator.

    Args:
        start: the offset at which the expression begins.
        scope: the types of the variables and of the event variables.
    """
    compared = _COMPARED.search(request.file.document.text[start : request.offset])
    if compared is None:
        return
    owner, name = compared[1][:-1], compared[2]
    if not owner:
        yield from _of_variable(request, name)
        return
    named: dict[ConstantValue | None, str] = {c.value: c.name for c in _constants(request, owner, name, scope)}
    if (owner, name) == ("_wrapped_result", "code"):
        named.update((code, text) for code, text in GOAL_STATUSES.items())
    sent = [value for value in _arriving(request, f"{owner}.{name}").only or () if not isinstance(value, bool)]
    for value in (*named, *sorted((v for v in sent if v not in named), key=str)):
        if value is not None:
            text = f"'{value}'" if isinstance(value, str) else str(value)
            detail = named.get(value, "is sent")
            yield CompletionItem(text, ItemKind.VALUE, detail=detail, rank=Rank.BEST, filter=f"{text} {detail}")


def _of_variable(request: Request, name: str) -> Iterator[CompletionItem]:
    """The constants that a machine assigns to a variable. The condition at the caret is incomplete, so the values that
    follow from all conditions are not known."""
    if request.chart is None:
        return
    given = [data.value for data in request.chart.data if data.id is not None and data.id.value == name]
    for statement in request.chart.statements:
        if isinstance(statement, Assign) and statement.location is not None and statement.location.text.strip() == name:
            given.append(statement.value)
    constants = [dict(literal("", value.tree)).get("") for value in given if isinstance(value, Expression)]
    known = joined(values for values in constants if values is not None)
    for value in sorted((v for v in known.only or () if not isinstance(v, bool)), key=str):
        text = f"'{value}'" if isinstance(value, str) else str(value)
        yield CompletionItem(text, ItemKind.VALUE, detail=f"assigned to {name}", rank=Rank.BEST)


def _constants(request: Request, owner: str, field: str, scope: Mapping[str, Type]) -> Sequence[Constant]:
    """The constants of the interface that `owner` is a part of for its field `field`."""
    tree, findings = parse(Decoded(owner, 0))
    type_ = None if findings else infer(tree, scope.get)[0]
    if not isinstance(type_, Struct) or type_.kind is not StructKind.ROS:
        return []
    full_name, _, part = type_.name.partition(" ")
    kind: Kind = "msg" if not part else "srv" if part in SECTION_NAMES["srv"] else "action"
    definition = request.analysis.registry.resolve(kind, full_name)
    if isinstance(definition, NotFound):
        return []
    return definition.sections[SECTION_NAMES[kind].index(part) if part else 0].named_values(field)


def _arriving(request: Request, place: str) -> ValueSet:
    """The values that the machines of the system send to a place of event data."""
    handler, machine = request.handler, request.machine
    prefix = data_place(handler.trigger) if handler is not None and handler.trigger is not None else None
    if machine is None or handler is None or handler.trigger is None or not prefix:
        return ValueSet()
    declaration = find_handle(machine, handler)
    name = declaration.handle if declaration is not None else handler.event
    channel = DataChannel(handler.trigger, name.value if name is not None else "")
    fields = request.analysis.arriving_at(request.path, request.system_path).get(channel, {})
    return fields.get(place.removeprefix(f"{prefix}."), ValueSet())
