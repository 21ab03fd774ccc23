# SPDX-License-Identifier: Apache-2.0
"""The frequency of cyclic garbage collection. The trees of the parsers are large and, like the models and the results
of the analyses, contain no cycles; a test of the keys in an editor checks this."""

from __future__ import annotations

import gc


def spare_the_collector() -> None:
    """Collect garbage rarely, in a process that runs for long. Other commands do not collect it at all.

    With the default thresholds, the collector takes a sixth of the time of a check, more for larger systems, and delays
    every fifth keystroke in an editor by 80 ms. With 50,000 objects instead of 1,000,000, it takes a fifth of the time
    to verify a JANI file of 12 MB, and delays many keys in a machine of 5,000 lines by 300 ms; the maximum memory is
    the same.
    """
    gc.enable()
    gc.set_threshold(1_000_000)
