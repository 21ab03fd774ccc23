# SPDX-License-Identifier: Apache-2.0
"""Durations on the command line."""

from __future__ import annotations

import argparse

from roaml.model.parameters import duration


def time_of(text: str) -> int:
    """A duration such as `100 s`, in ns.

    Raises:
        argparse.ArgumentTypeError: the text is not a duration.
    """
    value = duration(text)
    if value is None:
        raise argparse.ArgumentTypeError("a time must be a whole number and s, ms, us or ns, such as '100 s'")
    return value
