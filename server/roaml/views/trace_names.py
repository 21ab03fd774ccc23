# SPDX-License-Identifier: Apache-2.0
"""The names of traces in sentences for users."""

from __future__ import annotations

from roaml.smc.record import SELECTED, SHORTEST
from roaml.smc.story import Story


def trace_name(story: Story) -> str:
    """The name of a trace in a sentence, such as `trace 20`."""
    number = story.recording.trace
    return {SHORTEST: "the shortest trace", SELECTED: "a trace"}.get(number, f"trace {number}")
