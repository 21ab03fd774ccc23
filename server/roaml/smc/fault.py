# SPDX-License-Identifier: Apache-2.0
"""What is wrong with a model or property, found before or while it runs."""

from __future__ import annotations

from typing import Any

from roaml.jani.node import Origin

MODEL_FAULT = "model-fault"
"""The code of what a model does wrong while it runs, or that the model checker cannot run."""


class FaultError(Exception):
    """A model or property cannot be run, or did something that has no meaning.

    Attributes:
        message: one sentence without a full stop.
        origin: the place of the part that is wrong, as far as it is known.
        trace: the number of the trace in which it happened; None if it was found beforehand.
        code: the rule whose document says more.
    """

    def __init__(
        self, message: str, origin: Origin | None = None, trace: int | None = None, code: str = MODEL_FAULT
    ) -> None:
        super().__init__(message)
        self.message = message
        self.origin = origin
        self.trace = trace
        self.code = code

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.message, self.origin, self.trace, self.code)
