# SPDX-License-Identifier: Apache-2.0
"""Runs of a system, one step at a time, forwards and backwards, in the terms of ROS, SCXML and BehaviorTree.CPP.

A run is a pure function of the model, a seed, the number of its trace and the decisions that were taken by hand
(`run`). A `Session` is a position in a run: it shows the state there (`state`) and what can happen next (`choices`),
and moves. Knows nothing of files, editors and protocols.
"""

from roaml.simulation.choices import Choice, Outcome
from roaml.simulation.run import Decision, RunError
from roaml.simulation.session import SavedSession, Session
from roaml.simulation.state import MachineState, NodeState, SystemState

__all__ = [
    "Choice",
    "Decision",
    "MachineState",
    "NodeState",
    "Outcome",
    "RunError",
    "SavedSession",
    "Session",
    "SystemState",
]
