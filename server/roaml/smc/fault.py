# SPDX-License-Identifier: Apache-2.0
"""What is wrong with a model or property, found before or while it runs."""

from __future__ import annotations

from typing import Any

from roaml.jani.node import Origin


class FaultError(Exception):
    """A model or property cannot be run, or did something that has no meaning.

    Attributes:
        message: one sentence without a full stop.
        origin: the place of the part that is wrong, as far as it is known.
        trace: the number of the trace in which it happened; None if it was found beforehand.
    """

    def __init__(self, message: str, origin: Origin | None = None, trace: int | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.origin = origin
        self.trace = trace

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.message, self.origin, self.trace)
