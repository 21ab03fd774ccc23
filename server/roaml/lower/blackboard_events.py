# SPDX-License-Identifier: Apache-2.0
"""The events with which automata read and write the blackboard (docs/spec/plain-scxml.md#blackboard)."""

from __future__ import annotations

from roaml.scxml.events import EventRole, ScxmlEvent
from roaml.scxml.names import BLACKBOARD_WRITE_PREFIX, blackboard_answer, blackboard_request


def request_of(tree: str) -> ScxmlEvent:
    """The event that asks for the values of the blackboard of the tree with the name `tree`."""
    return ScxmlEvent(blackboard_request(tree), EventRole.BLACKBOARD_READ)


def answer_of(tree: str) -> ScxmlEvent:
    """The event with the values of the blackboard of the tree with the name `tree`."""
    return ScxmlEvent(blackboard_answer(tree))


def blackboard_write(variable: str) -> ScxmlEvent:
    return ScxmlEvent(f"{BLACKBOARD_WRITE_PREFIX}{variable}", EventRole.BLACKBOARD_WRITE)
