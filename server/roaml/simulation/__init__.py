# SPDX-License-Identifier: Apache-2.0
"""Step-by-step simulation of a system, forwards and backwards, in the terms of ROS, SCXML and BehaviorTree.CPP.

A run is a pure function of the model, a seed, the number of its trace and the decisions of the user (`run`). A
`Session` is a position in a run, and can move to other positions. It provides the state (`state`) and the possible next
steps (`choices`) at its position. The package does not depend on files, editors or protocols.
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
