# SPDX-License-Identifier: Apache-2.0
"""The numbers that the compiled modules and their callers share. `search` defines the same numbers as C constants; a
test compares them."""

from __future__ import annotations

COMPLETE, PART, STATES, MEMORY, FAULT, CHOICES = 0, 1, 2, 3, 4, 5
STATUS, LASTS, FAILS, HOLDS, OPEN, ENDED, GETS_STUCK = 3, 4, 8, 16, 32, 64, 128
