# SPDX-License-Identifier: Apache-2.0
"""The dialect in which a machine is written (docs/spec/files.md#dialects)."""

from __future__ import annotations

from roaml.model.machine import Dialect, Machine
from roaml.xml_syntax import Document

_FOREIGN_ATTRIBUTES = ("targetexpr", "eventexpr")


def dialect_of(machine: Machine, document: Document, in_older_system: bool | None) -> Dialect:
    """The dialect of a machine: the dialect of the system that lists it, or the dialect that its root and content show.

    Args:
        in_older_system: whether the system that lists the machine is in the older dialect; `None` if no system lists
            it.
    """
    if in_older_system is not None:
        return Dialect.OLDER if in_older_system else Dialect.CURRENT
    if machine.root == "ascxml":
        return Dialect.CURRENT
    if any(element.name.startswith(("ros_", "bt_")) for element in machine.element.walk()):
        return Dialect.OLDER
    if _is_foreign(machine, document):
        return Dialect.FOREIGN
    return Dialect.PLAIN


def _is_foreign(machine: Machine, document: Document) -> bool:
    if "_event.origin" in document.text:
        return True
    return any(element.get(name) for element in machine.element.walk() for name in _FOREIGN_ATTRIBUTES)
