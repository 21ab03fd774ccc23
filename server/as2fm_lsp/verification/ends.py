# SPDX-License-Identifier: Apache-2.0
"""Why traces have ended, in every format."""

from __future__ import annotations

from roaml.smc.end import End
from roaml.smc.tally import Tally

_ORDINARY = frozenset({End.DECIDED, End.FINISHED, End.TIME})


def are_ordinary(tally: Tally) -> bool:
    """Whether all traces have ended because the property was decided, the tree has finished, or the time is over."""
    return _ORDINARY.issuperset(tally.ends)


def as_line(tally: Tally) -> str:
    """The reasons for which traces have ended, each with its number of traces, as a line for users."""
    return ", ".join(f"{reason.text} {tally.ends[reason].count:,}" for reason in End if reason in tally.ends)


def as_row(tally: Tally) -> dict[str, int]:
    """Every reason for the end of a trace with its number of traces, also if that is 0, as a value for JSON."""
    return {reason.key: tally.ended(reason) for reason in End}
