# SPDX-License-Identifier: Apache-2.0
"""What an action of a picture returns: an edit, a question to the user, or a refusal."""

from __future__ import annotations

from typing import TypeAlias

from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.record import Record


class Option(Record, frozen=True):
    """An answer to choose: its text for the user, and the answer itself."""

    label: str
    answer: str


class UserQuestion(Record, frozen=True):
    """A question whose answer the action needs.

    Attributes:
        text: a noun phrase for the requested answer, such as "The name of the new state".
        options: the answers to choose from; without any, the answer is a text.
        proposal: the text that the user edits.
    """

    text: str
    options: tuple[Option, ...] = ()
    proposal: str = ""


class ActionRefusal(Record, frozen=True):
    """An action that is not possible. `reason` states why, as a clause for the user."""

    reason: str


Answer: TypeAlias = WorkspaceEdit | UserQuestion | ActionRefusal
