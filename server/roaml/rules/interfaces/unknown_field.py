# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-field`, which unknown_field.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import remove
from roaml.expr.infer import UnknownMember
from roaml.expr.types import Struct, Unknown, leaves, unwrap
from roaml.model.machine import Param, RosSend
from roaml.model.value_types import find_handle
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements
from roaml.rules.support.fields import is_ros, part_of, sent_part
from roaml.suggest import MAX_LISTED, alternatives, listing
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, UnknownMember):
                inner, _ = unwrap(problem.owner)
                if isinstance(inner, Struct) and is_ros(inner):
                    close = close_names(problem.name, [name for name, _ in inner.members])
                    message = f"`{inner}` has no field `{problem.name}`{did_you_mean(close)}"
                    yield RULE.at(problem.span, message, *replacements(problem.span, close))
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, RosSend):
                yield from _fields(context, statement)


def _fields(context: MachineContext, statement: RosSend) -> Iterator[Finding]:
    part = sent_part(context, statement)
    if part is None:
        return
    paths = [".".join(path) for path, _ in leaves(part)]
    for field in statement.fields:
        if field.name is None:
            continue
        untyped = field_of_unknown_type(part, field.name.value)
        if untyped:
            message = f"the type of the field `{untyped}` cannot be found, so its value cannot be translated"
            advice = f"check the definition of `{part}`, and add the folders of its packages with `ros-path`"
            yield RULE.at(field.name.span, f"{message}; {advice}")
        elif field.name.value not in paths:
            yield _unknown(context, statement, field, part, paths)


def _renamed(context: MachineContext, statement: RosSend) -> Iterator[Fix]:
    """A fix that names another declaration of the same kind, if only that one has all fields of an element."""
    own = find_handle(context.machine, statement)
    names = {field.name.value for field in statement.fields if field.name is not None}
    fitting = []
    for other in context.machine.declarations:
        part = part_of(context, other, statement) if own and other is not own and other.kind is own.kind else None
        if part is not None and other.handle is not None and names <= {".".join(path) for path, _ in leaves(part)}:
            fitting.append(other.handle.value)
    if len(fitting) == 1 and statement.handle is not None:
        yield Fix(f"Change to `{fitting[0]}`", (TextEdit(statement.handle.span, fitting[0]),))


def _unknown(context: MachineContext, statement: RosSend, field: Param, part: Struct, paths: list[str]) -> Finding:
    assert field.name is not None
    name = field.name.value
    inside = [path for path in paths if path.startswith(f"{name}.")]
    if inside:
        message = f"`{name}` is itself a message; set its fields, such as `{inside[0]}`"
        return RULE.at(field.name.span, message, *replacements(field.name.span, inside[:1]))
    close = close_names(name, paths) or close_names(name.rpartition(".")[2], paths)
    if not close:
        close = tuple(path for path in paths if path.rpartition(".")[2] == name)
    message = f"`{part}` has no field `{name}`{_instead(close, paths)}"
    others = () if close else (*_renamed(context, statement), remove(context.document, field.element))
    return RULE.at(field.name.span, message, *replacements(field.name.span, close), *others)


def _instead(close: tuple[str, ...], fields: list[str]) -> str:
    if not fields:
        return "; it has no fields"
    return alternatives(close, fields, "field") or f"; its first fields are {listing(fields[:MAX_LISTED])}"


def field_of_unknown_type(part: Struct, name: str) -> str:
    """The field of unknown type that `name` is, or that contains it; empty if there is none."""
    unknown = (".".join(path) for path, type_ in leaves(part) if isinstance(unwrap(type_)[0], Unknown))
    return next((path for path in unknown if name == path or name.startswith(f"{path}.")), "")


RULE = Rule("unknown-field", Severity.ERROR, "A ROS type does not have a field that is used.", machine=check)
