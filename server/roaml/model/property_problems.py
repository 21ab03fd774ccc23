# SPDX-License-Identifier: Apache-2.0
"""The problems of property files, as data; a rule reports each kind."""

from __future__ import annotations

import enum

from roaml.record import Record
from roaml.text import Span
from roaml.xml_syntax import Element


class ProblemKind(enum.Enum):
    """The kind of a problem. The value is the code of the rule that reports it."""

    UNKNOWN_PORT = "unknown-property-port"
    PORT_TYPE = "port-type"
    PORT_VARIABLE = "port-variable"
    UNSENT = "unsent-port"
    SEVERAL_CLIENTS = "port-of-several-clients"
    REPEATED_ID = "repeated-property-id"
    CONDITION = "property-condition"
    FORM = "property-form"
    TIME = "property-time"
    BEYOND_END = "beyond-max-time"
    SHORT = "short-time"
    NEVER_TOGETHER = "events-never-together"
    FALSE_AT_START = "event-false-at-start"
    UNUSED = "unused-port-variable"
    MISLEADING = "misleading-handle"


class Remedy(enum.Enum):
    """The change that removes a problem."""

    REMOVE_ELEMENT = "remove the element"
    REMOVE_ATTRIBUTE = "remove the attribute with the value at the span of the problem"
    ADD_SCOPE = "add a scope to the element"


class Problem(Record, frozen=True):
    """A problem of a property file.

    Attributes:
        close: similar names that may be intended at `span`.
        remedy: the change of `element` that removes the problem; `None` if it is not evident.
        harmless: whether the property means the same without the problem, so that it is a warning.
    """

    kind: ProblemKind
    span: Span
    message: str
    close: tuple[str, ...] = ()
    remedy: Remedy | None = None
    element: Element | None = None
    harmless: bool = False
