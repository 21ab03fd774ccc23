# SPDX-License-Identifier: Apache-2.0
"""Errors in a model or property, found before or during a run."""

from __future__ import annotations

import enum
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


class FaultCode(enum.IntEnum):
    """The reason why a trace cannot continue."""

    NONE = 0
    OVERFLOW = 1
    DIVISION = 2
    INDEX = 3
    RANGE = 4
    DOMAIN = 5
    PROBABILITY = 6
    EMPTY = 7
    TOO_LARGE = 8
    NEGATIVE = 9


MESSAGES = {
    FaultCode.OVERFLOW: "integer overflow: the result does not fit into 64 bits",
    FaultCode.DIVISION: "division by zero",
    FaultCode.INDEX: "index {value} is outside of the array, whose length is {size}",
    FaultCode.RANGE: "{value} is outside of the bounds of the variable's type",
    FaultCode.DOMAIN: "this function has no value for {value}",
    FaultCode.PROBABILITY: "the probabilities of this edge do not add up to 1, or one is negative",
    FaultCode.EMPTY: "the array has no elements",
    FaultCode.TOO_LARGE: "the result is too large for a real number",
    FaultCode.NEGATIVE: "a reward is negative, so bounds on its sum are not supported",
}
