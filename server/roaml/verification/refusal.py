# SPDX-License-Identifier: Apache-2.0
"""Why a property has no answer, with its position; the other properties are still decided."""

from __future__ import annotations

from dataclasses import dataclass

from roaml.smc.fault import FaultError
from roaml.verification.target import LineColumn, VerificationTarget


@dataclass(frozen=True, slots=True)
class Refusal:
    """Attributes:
    code: the rule whose document explains it.
    place: its place in the files; `None` if unknown.
    """

    code: str
    message: str
    place: LineColumn | None = None


def refusal(fault: FaultError, target: VerificationTarget, seed: int) -> Refusal:
    """
    Args:
        seed: the seed of the traces.
    """
    return Refusal(fault.code, fault_message(fault, seed), target.place(fault.origin))


def fault_message(fault: FaultError, seed: int) -> str:
    """A description of the undefined operation, with the trace that shows it."""
    return fault.message if fault.trace is None else f"{fault.message} (in trace {fault.trace} of seed {seed})"
