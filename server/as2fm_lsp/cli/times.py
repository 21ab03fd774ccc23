# SPDX-License-Identifier: Apache-2.0
"""Times on the command line."""

from __future__ import annotations

import argparse

from roaml.model.system_file import duration


def time_of(text: str) -> int:
    """A time such as `100 s`, in nanoseconds.

    Raises:
        argparse.ArgumentTypeError: it is not written so.
    """
    value = duration(text)
    if value is None:
        raise argparse.ArgumentTypeError("a time is written as a whole number and s, ms, us or ns, such as '100 s'")
    return value
