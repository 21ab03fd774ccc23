# SPDX-License-Identifier: Apache-2.0
"""What an action of a picture returns: an edit, a question to the user, or a refusal."""

from __future__ import annotations

from typing import TypeAlias

from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.record import Record
from roaml.text import Edit


class Option(Record, frozen=True):
    """An answer to choose: its text for the user, the answer itself, and a few words beside the text."""

    label: str
    answer: str
    description: str = ""


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


EditAnswer: TypeAlias = tuple[Edit, ...] | UserQuestion | ActionRefusal
"""The edits of one file, or what is missing for them."""

Answer: TypeAlias = WorkspaceEdit | UserQuestion | ActionRefusal
