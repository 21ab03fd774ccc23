# SPDX-License-Identifier: Apache-2.0
"""Errors in a model or property, found before or during a run."""

from __future__ import annotations

from typing import Any

from roaml.jani.node import Origin

MODEL_FAULT = "model-fault"
"""The code of the findings about undefined operations, and about models that cannot be run."""


class FaultError(Exception):
    """A model or property cannot be run, or has executed an undefined operation.

    Attributes:
        message: one sentence without a full stop.
        origin: the position of the invalid part, if known.
        trace: the number of the trace in which the operation was executed; `None` if there was no trace.
        code: the rule that documents the error.
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
