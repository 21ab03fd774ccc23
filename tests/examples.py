# SPDX-License-Identifier: Apache-2.0
"""Which examples the tests of hypothesis try, and how many.

A run of the tests tries the same ones as the last, so that what is found by chance is found when somebody looks for it.
With `AS2FM_EXAMPLES=20` the tests try 20 times as many, different ones in each run.
"""

from __future__ import annotations

import os

TIMES = int(os.environ.get("AS2FM_EXAMPLES", "0"))
"""How many times as many examples as usual; 0 for the usual ones."""


def examples(count: int) -> int:
    """How many examples a test tries of which `count` are enough for most runs."""
    return count * max(1, TIMES)
