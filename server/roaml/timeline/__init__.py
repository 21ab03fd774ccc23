# SPDX-License-Identifier: Apache-2.0
"""A run over time: lanes with the states of machines and the statuses of tree nodes, messages, and plots of numbers."""

from roaml.timeline.figure import (
    Axis,
    Mark,
    View,
    draw_legend,
    draw_names,
    draw_timeline,
    extent,
    height_of,
    position_of,
    step_at,
)
from roaml.timeline.record import Lane, LaneKind, Plot, SentMessage, Timeline

__all__ = [
    "Axis",
    "Lane",
    "LaneKind",
    "Mark",
    "Plot",
    "SentMessage",
    "Timeline",
    "View",
    "draw_legend",
    "draw_names",
    "draw_timeline",
    "extent",
    "height_of",
    "position_of",
    "step_at",
]
