# SPDX-License-Identifier: Apache-2.0
"""The events with which automata read and write the blackboard (docs/spec/plain-scxml.md#blackboard)."""

from __future__ import annotations

from roaml.scxml.events import EventRole, ScxmlEvent
from roaml.scxml.names import BLACKBOARD_ANSWER, BLACKBOARD_REQUEST, BLACKBOARD_WRITE_PREFIX

REQUEST = ScxmlEvent(BLACKBOARD_REQUEST, EventRole.BLACKBOARD_READ)
ANSWER = ScxmlEvent(BLACKBOARD_ANSWER)


def blackboard_write(variable: str) -> ScxmlEvent:
    return ScxmlEvent(f"{BLACKBOARD_WRITE_PREFIX}{variable}", EventRole.BLACKBOARD_WRITE)
