# SPDX-License-Identifier: Apache-2.0
"""The reason why a property has no answer, with its position. Other properties are still decided."""

from __future__ import annotations

from roaml.record import Record
from roaml.smc.fault import FaultError
from roaml.verification.target import LineColumn, VerificationTarget


class Refusal(Record, frozen=True):
    """The reason why a property has no answer.

    Attributes:
        code: the rule whose document explains the reason.
        place: the position of the cause; `None` if it is unknown.
    """

    code: str
    message: str
    place: LineColumn | None = None


def refusal(fault: FaultError, target: VerificationTarget, seed: int) -> Refusal:
    """The refusal for an error in a model or property.

    Args:
        seed: the seed of the traces.
    """
    return Refusal(fault.code, fault_message(fault, seed), target.place(fault.origin))


def fault_message(fault: FaultError, seed: int) -> str:
    """The message of an error, with the trace that shows it if there is one."""
    return fault.message if fault.trace is None else f"{fault.message} (in trace {fault.trace} of seed {seed})"
