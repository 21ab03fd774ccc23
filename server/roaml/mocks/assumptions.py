# SPDX-License-Identifier: Apache-2.0
"""Assumed behaviour of the leaves of Nav2, for proposed mocks (docs/spec/mocks.md#proposed). The values were not
measured. Each has a reason, and users replace it with what they know about their robot."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from types import MappingProxyType
from typing import TypeAlias

from roaml.record import Record

Constant: TypeAlias = Callable[[str], float | None]
"""Name of a port -> the number to which the tree sets it, or its default; `None` if it is not a constant number."""

TURNING_SPEED = 1.0
"""The assumed speed of a robot that turns on the spot, in rad/s: Nav2's default for `max_rotational_vel`."""
CHECKS_PER_SECOND = 10
"""The assumed number of times per second that a condition is ticked."""
_COMPUTES = "computes from its inputs, and fails only if they are missing"
_NEW_GOAL = "a new goal is rare: in 1 of 100 ticks"
_HELPS = "most errors can be resolved by a recovery"
_PLANS = "a planner usually finds a path, in a fraction of a second"
_PATH_CHECKED = "obstacles make some paths invalid"
_CANCELS = "a server answers a cancellation soon, and rarely refuses it"
_SERVICE = "a service answers soon, and rarely fails"


class Assumption(Record, frozen=True):
    """The assumed behaviour of a leaf.

    Attributes:
        probability: the probability of SUCCESS.
        duration: the time for which an action is RUNNING, in ms.
        reason: why, as a clause without full stop.
    """

    probability: float
    duration: Fraction
    reason: str


def assumption(type_: str, constant: Constant) -> Assumption | None:
    """The assumed behaviour of a leaf of Nav2; `None` if there is no assumption about its type."""
    if type_ in _FROM_PORTS:
        return _FROM_PORTS[type_](constant)
    return _FIXED.get(type_)


def _fixed(probability: float, milliseconds: int, reason: str) -> Assumption:
    return Assumption(probability, Fraction(milliseconds), reason)


def _once_in(seconds: int, what: str) -> Assumption:
    """A condition for what is rare. Guards check it at every tick, so its probability follows from a time."""
    reason = f"{what} once in {seconds} s, at {CHECKS_PER_SECOND} ticks per second"
    return _fixed(1 / (CHECKS_PER_SECOND * seconds), 0, reason)


_FIXED: Mapping[str, Assumption] = MappingProxyType(
    {
        "ComputePathToPose": _fixed(0.95, 200, _PLANS),
        "ComputePathThroughPoses": _fixed(0.95, 300, _PLANS),
        "ComputeRoute": _fixed(0.95, 200, "a route is usually found, in a fraction of a second"),
        "ComputeAndTrackRoute": _fixed(0.9, 10_000, "driving takes seconds, and obstacles stop some attempts"),
        "SmoothPath": _fixed(0.98, 200, "a smoother rarely fails"),
        "FollowPath": _fixed(0.9, 10_000, "driving takes seconds, and obstacles stop some attempts"),
        "FollowObject": _fixed(0.9, 10_000, "an object is sometimes lost"),
        "NavigateToPose": _fixed(0.9, 20_000, "driving takes seconds, and obstacles stop some attempts"),
        "NavigateThroughPoses": _fixed(0.9, 30_000, "driving takes seconds, and obstacles stop some attempts"),
        "DockRobot": _fixed(0.9, 15_000, "docking takes seconds, and some attempts miss the dock"),
        "UndockRobot": _fixed(0.98, 5_000, "leaving a dock rarely fails"),
        "ValidatePath": _fixed(0.9, 0, _PATH_CHECKED),
        "IsPathValid": _fixed(0.9, 0, _PATH_CHECKED),
        "CheckPoseOccupancy": _fixed(0.95, 100, "most poses are free"),
        "CheckStopStatus": _fixed(1, 500, "a robot stops within half a second"),
        "RemovePassedGoals": _fixed(1, 0, _COMPUTES),
        "RemoveInCollisionGoals": _fixed(0.98, 100, _SERVICE),
        "TruncatePath": _fixed(1, 0, _COMPUTES),
        "TruncatePathLocal": _fixed(1, 0, _COMPUTES),
        "GetPoseFromPath": _fixed(1, 0, _COMPUTES),
        "GetCurrentPose": _fixed(1, 0, "fails only if the transform of the robot is missing"),
        "ConcatenatePaths": _fixed(1, 0, _COMPUTES),
        "AppendGoalPoseToGoals": _fixed(1, 0, _COMPUTES),
        "ExtractRouteNodesAsGoals": _fixed(1, 0, _COMPUTES),
        "GetNextFewGoals": _fixed(1, 0, _COMPUTES),
        "ClearEntireCostmap": _fixed(0.99, 100, _SERVICE),
        "ClearCostmapExceptRegion": _fixed(0.99, 100, _SERVICE),
        "ClearCostmapAroundRobot": _fixed(0.99, 100, _SERVICE),
        "ClearCostmapAroundPose": _fixed(0.99, 100, _SERVICE),
        "ReinitializeGlobalLocalization": _fixed(0.99, 100, _SERVICE),
        "ToggleCollisionMonitor": _fixed(0.99, 100, _SERVICE),
        **{
            f"Cancel{action}": _fixed(0.99, 100, _CANCELS)
            for action in ("Control", "BackUp", "DriveOnHeading", "Spin", "AssistedTeleop", "Wait",
                           "ComputeAndTrackRoute", "FollowObject")
        },
        "GoalUpdated": _fixed(0.01, 0, _NEW_GOAL),
        "GlobalUpdatedGoal": _fixed(0.01, 0, _NEW_GOAL),
        "GoalReached": _fixed(0.1, 0, "the goal is reached at one of many checks"),
        "IsStuck": _once_in(100, "a robot is stuck"),
        "IsBatteryLow": _once_in(1000, "a battery becomes low"),
        "IsBatteryCharging": _fixed(0.1, 0, "a robot usually drives without a charger"),
        "TransformAvailable": _fixed(0.99, 0, "transforms are known soon after the start"),
        "InitialPoseReceived": _fixed(0.99, 0, "the pose is known soon after the start"),
        "WouldAControllerRecoveryHelp": _fixed(0.8, 0, _HELPS),
        "WouldAPlannerRecoveryHelp": _fixed(0.8, 0, _HELPS),
        "WouldASmootherRecoveryHelp": _fixed(0.8, 0, _HELPS),
        "WouldARouteRecoveryHelp": _fixed(0.8, 0, _HELPS),
        "AreErrorCodesPresent": _fixed(0.1, 0, "most attempts end without an error"),
        "ArePosesNear": _fixed(0.5, 0, "both outcomes are likely"),
        "IsGoalNearby": _fixed(0.1, 0, "the goal is near only at the end of a path"),
        "IsWithinPathTrackingBounds": _fixed(0.95, 0, "a controller usually stays near its path"),
    }
)  # fmt: skip


def _seconds(value: float) -> Fraction:
    """A time in s as ms, rounded to 10 ms and at least 100 ms."""
    return Fraction(max(100, round(abs(value) * 100) * 10))


def _spin(constant: Constant) -> Assumption:
    angle = constant("spin_dist")
    if angle is None:
        angle = math.pi / 2
    reason = f"turning by {abs(angle):g} rad at {TURNING_SPEED:g} rad/s; a collision check stops some attempts"
    return Assumption(0.95, _seconds(angle / TURNING_SPEED), reason)


def _wait(constant: Constant) -> Assumption:
    time = constant("wait_duration")
    return Assumption(1, _seconds(1 if time is None else time), "waiting does not fail; the time is its port")


def _drive(distance_port: str, speed_port: str) -> Callable[[Constant], Assumption]:
    def drive(constant: Constant) -> Assumption:
        distance, speed = constant(distance_port), constant(speed_port)
        if distance is None or not speed:
            return _fixed(0.9, 3_000, "an obstacle stops some attempts")
        reason = f"{abs(distance):g} m at {abs(speed):g} m/s; an obstacle stops some attempts"
        return Assumption(0.9, _seconds(distance / speed), reason)

    return drive


def _teleoperation(constant: Constant) -> Assumption:
    time = constant("time_allowance")
    return Assumption(0.9, _seconds(10 if time is None else time), "a person usually succeeds; the time is its port")


def _period(constant: Constant) -> Assumption:
    seconds = constant("seconds") or 1.0
    chance = min(1.0, round(1 / (CHECKS_PER_SECOND * max(abs(seconds), 1 / CHECKS_PER_SECOND)), 4))
    return Assumption(chance, Fraction(0), f"once in {seconds:g} s, at {CHECKS_PER_SECOND} ticks per second")


def _travelled(_: Constant) -> Assumption:
    return _fixed(0.1, 0, "once in a second, at 10 ticks per second")


_FROM_PORTS: Mapping[str, Callable[[Constant], Assumption]] = MappingProxyType(
    {
        "Spin": _spin,
        "Wait": _wait,
        "BackUp": _drive("backup_dist", "backup_speed"),
        "DriveOnHeading": _drive("dist_to_travel", "speed"),
        "AssistedTeleop": _teleoperation,
        "TimeExpired": _period,
        "PathExpiringTimer": _period,
        "DistanceTraveled": _travelled,
    }
)
