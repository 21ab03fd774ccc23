# SPDX-License-Identifier: Apache-2.0
"""The problems of property files, as data; a rule reports each kind."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from roaml.text import Span


class ProblemKind(enum.Enum):
    """The value is the code of the rule that reports it."""

    UNKNOWN_PORT = "unknown-property-port"
    PORT_TYPE = "port-type"
    PORT_VARIABLE = "port-variable"
    UNSENT = "unsent-port"
    SEVERAL_CLIENTS = "port-of-several-clients"
    REPEATED_ID = "repeated-property-id"
    CONDITION = "property-condition"
    FORM = "property-form"
    TIME = "property-time"
    NEVER_TOGETHER = "events-never-together"
    FALSE_AT_START = "event-false-at-start"
    UNUSED = "unused-port-variable"


@dataclass(frozen=True, slots=True)
class Problem:
    """`close`: similar names that may be intended at `span`."""

    kind: ProblemKind
    span: Span
    message: str
    close: tuple[str, ...] = ()
