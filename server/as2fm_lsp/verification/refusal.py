# SPDX-License-Identifier: Apache-2.0
"""Why a property has no answer, with its place: the others are answered all the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from as2fm_lsp.verification.subject import Subject
from roaml.smc.fault import FaultError


@dataclass(frozen=True, slots=True)
class Refusal:
    """Attributes:
    code: the rule whose document says more.
    path, line, column: where; the path is empty if that is not known.
    """

    code: str
    message: str
    path: str = ""
    line: int = 0
    column: int = 0

    def row(self) -> dict[str, Any]:
        """As a value for JSON."""
        place = {"file": self.path, "line": self.line, "column": self.column} if self.path else {}
        return {**place, "code": self.code, "message": self.message}

    @property
    def text(self) -> str:
        """For people, in one line."""
        place = f"{self.path}:{self.line}:{self.column}: " if self.path else ""
        return f"{place}{self.message} [{self.code}]"


def refusal(fault: FaultError, subject: Subject, seed: int, shown: Callable[[str], str]) -> Refusal:
    """
    Args:
        seed: of the traces.
        shown: path -> as it is shown.
    """
    message = fault.message
    if fault.trace is not None:
        message += f" (in trace {fault.trace} of seed {seed})"
    place = subject.place(fault.origin)
    if place is None:
        return Refusal(fault.code, message)
    path, line, column = place
    return Refusal(fault.code, message, shown(path), line, column)
