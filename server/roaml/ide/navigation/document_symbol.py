# SPDX-License-Identifier: Apache-2.0
"""The entries of outlines, and their kinds."""

from __future__ import annotations

import enum

from roaml.record import Record
from roaml.text import Span


class DocumentSymbolKind(enum.Enum):
    MACHINE = "machine"
    DATAMODEL = "datamodel"
    VARIABLE = "variable"
    PORT = "port"
    ROS = "ROS interface"
    STATE = "state"
    TRANSITION = "transition"
    THREAD = "action thread"
    TREE = "tree"
    CONTROL = "inner node of a tree"
    LEAF = "leaf of a tree"
    SYSTEM = "system"
    SECTION = "section of a system file"
    INPUT = "file of a system"
    STRUCT = "struct"
    MEMBER = "member of a struct"
    PROPERTY = "property"


class DocumentSymbol(Record, frozen=True):
    """An entry of an outline. `detail` is shown after the name. `name_span` is the part of `span` that is selected when
    the user chooses the entry."""

    name: str
    detail: str
    kind: DocumentSymbolKind
    span: Span
    name_span: Span
    children: tuple[DocumentSymbol, ...] = ()
