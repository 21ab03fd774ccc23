# SPDX-License-Identifier: Apache-2.0
"""The examples that tests with hypothesis try, and their number.

By default, each run tries the same examples, so that a failure can be reproduced. With `AS2FM_EXAMPLES=20`, the tests
try 20 times as many, different ones in each run.
"""

from __future__ import annotations

import os

TIMES = int(os.environ.get("AS2FM_EXAMPLES", "0"))
"""The factor of the number of examples; 0 for the default examples."""


def examples(count: int) -> int:
    """The number of examples that a test tries, if `count` are enough for most runs."""
    return count * max(1, TIMES)
