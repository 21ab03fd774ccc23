# SPDX-License-Identifier: Apache-2.0
"""Runs of a system that are stepped forwards and backwards."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roaml.api.verifying import as_target, checker
from roaml.jani.model import Model

if TYPE_CHECKING:
    from roaml.api.systems import LoadedSystem
    from roaml.simulation.session import SavedSession, Session
    from roaml.verification.target import VerificationTarget


def session(
    subject: VerificationTarget | LoadedSystem | Model,
    property: str | None = None,  # noqa: A002 - JANI's word
    seed: int = 0,
    trace: int = 0,
    saved: SavedSession | None = None,
) -> Session:
    """A run at its start, or at the position of a saved run.

    Args:
        subject: the system or model to run.
        property: the name of the property that is evaluated on the run; if not given, the first property of the model
            that the initial state does not decide, the first one if it decides all of them, or `stuck` if the model has
            none.
        seed, trace: the run is the trace with the number `trace` that `verify` generates with this seed.
        saved: continue this session; its property, seed and trace override the arguments.

    Raises:
        PropertyError: a property does not exist.
        RunError: the saved decisions are not possible in this model.
        FaultError: the model cannot be run, the property cannot be answered, or a saved step executes an undefined
            operation.
    """
    from roaml.simulation.session import Session, default_property  # noqa: PLC0415 - checking and translating start faster without it

    target = as_target(subject)
    name = property if saved is None else saved.property
    ready = checker(target.model, None if name is None else [name])
    if name is not None and name in ready.refused:
        raise ready.refused[name]
    evaluated = (
        default_property(ready, seed, trace) if name is None else next(iter(ready.compiled_properties), ready.stuck)
    )
    return Session(ready, evaluated, seed, trace, target.clock, saved)
