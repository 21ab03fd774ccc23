# SPDX-License-Identifier: Apache-2.0
"""The numbers that the compiled modules and their callers share. `search` defines the same numbers as C constants and
explains them; a test compares both."""

from __future__ import annotations

COMPLETE, PART, STATES, MEMORY, FAULT, CHOICES = 0, 1, 2, 3, 4, 5
"""The status of a search."""
STATUS, LASTS, FAILS, HOLDS, OPEN, ENDED, GETS_STUCK = 3, 4, 8, 16, 32, 64, 128
"""The bits of the label of a state."""
