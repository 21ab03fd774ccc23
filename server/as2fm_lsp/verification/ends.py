# SPDX-License-Identifier: Apache-2.0
"""Why traces have ended, in every format."""

from __future__ import annotations

from roaml.smc.end import End
from roaml.smc.tally import Tally


def as_line(tally: Tally) -> str:
    """The reasons for which traces have ended, each with its number of traces, as a line for users."""
    return ", ".join(f"{reason.text} {tally.ends[reason].count:,}" for reason in End if reason in tally.ends)


def as_row(tally: Tally) -> dict[str, int]:
    """Every reason for the end of a trace with its number of traces, also if that is 0, as a value for JSON."""
    return {reason.key: tally.ended(reason) for reason in End}
