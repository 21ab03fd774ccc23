# SPDX-License-Identifier: Apache-2.0
"""ROS 2 definitions, with their comments, as Markdown."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

from roaml.ide.describe.markdown import code, name, paragraphs
from roaml.interfaces.registry import NotFound, Registry
from roaml.interfaces.types import SECTION_NAMES, Constant, Definition, Field, Kind, Section

LANGUAGE = "rosmsg"
_MAX_LINES = 40
"""The maximum number of lines of a definition; the number of further lines is shown instead."""
_WIDTH = 88
"""The maximum number of characters in a line of a comment."""


def ros_type(registry: Registry, kind: Kind, type_name: str) -> str:
    """The definition of a type, `package/Name`; "" if there is none."""
    resolved = registry.resolve(kind, type_name)
    return "" if isinstance(resolved, NotFound) else definition(resolved)


def definition(ros_definition: Definition) -> str:
    """The description of a message, service or action: its fields and constants with their comments."""
    rows: list[str] = [f"# {ros_definition.full_name}"]
    for title, section in zip(SECTION_NAMES[ros_definition.kind], ros_definition.sections, strict=True):
        if title != SECTION_NAMES[ros_definition.kind][0]:
            rows.append("---")
        rows += _section(section)
    if len(rows) > _MAX_LINES + 1:
        rows = [*rows[:_MAX_LINES], f"# … {len(rows) - _MAX_LINES} more lines"]
    return code("\n".join(rows), LANGUAGE)


def _section(section: Section) -> Iterator[str]:
    yield from _comment(section.comment)
    parts: list[Field | Constant] = sorted((*section.constants, *section.fields), key=lambda member: member.name_span)
    rows = [(_declared(member), member.comment) for member in parts]
    width = max((len(row) for row, comment in rows if _is_short(comment)), default=0)
    for row, comment in rows:
        if _is_short(comment):
            yield f"{row:{width}}  # {comment}" if comment else row
        else:
            yield from _comment(comment)
            yield row


def _is_short(comment: str) -> bool:
    """Whether a comment fits beside its field."""
    return "\n" not in comment and len(comment) < _WIDTH // 2


def _comment(text: str) -> Iterator[str]:
    for line in text.splitlines():
        yield from (f"# {part}" for part in textwrap.wrap(line, _WIDTH) or [""])


def _declared(member: Field | Constant) -> str:
    if isinstance(member, Constant):
        return f"{member.type} {member.name}={member.value_text}"
    return f"{member.type} {member.name} {member.default_text}".rstrip()


def field(registry: Registry, struct: str, field_name: str) -> str:
    """The description of a field of a message, or of a part of a service or action; "" if the field is not found.

    Args:
        registry: resolves definitions.
        struct: the name of the struct in `roaml.model.ros`: `package/Name`, or `package/Name request`.
        field_name: the name of the field, or its dotted path.
    """
    head, _, rest = field_name.partition(".")
    owner, section = definition_and_section(registry, struct)
    known = owner.section(section).field(head) if owner else None
    if owner is None or known is None:
        return ""
    if rest and not known.type.is_primitive:
        return field(registry, known.type.name, rest)
    of = f"of {name(owner.full_name)}" if owner.kind == "msg" else f"in the {section} of {name(owner.full_name)}"
    comment = list(_comment(known.comment))
    nested = registry.resolve("msg", known.type.name) if not known.type.is_primitive else None
    inside = definition(nested) if isinstance(nested, Definition) else ""
    return paragraphs(code("\n".join((*comment, _declared(known))), LANGUAGE), f"Field {of}", inside)


def definition_and_section(registry: Registry, struct: str) -> tuple[Definition | None, str]:
    """The definition and section of a struct of `roaml.model.ros`; see `field`."""
    type_name, _, section = struct.partition(" ")
    section = section or "message"
    kind: Kind = next((kind for kind, sections in SECTION_NAMES.items() if section in sections), "msg")
    resolved = registry.resolve(kind, type_name)
    return (None if isinstance(resolved, NotFound) else resolved), section
