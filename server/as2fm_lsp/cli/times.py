# SPDX-License-Identifier: Apache-2.0
"""Durations on the command line."""

from __future__ import annotations

import argparse

from roaml.durations import REACTION_TIME, ReactionTime, duration, reaction_time


def time_of(text: str) -> int:
    """A duration such as `100 s`, in ns.

    Raises:
        argparse.ArgumentTypeError: the text is not a duration.
    """
    value = duration(text)
    if value is None:
        raise argparse.ArgumentTypeError("a time must be a whole number and h, min, s, ms, us or ns, such as '100 s'")
    return value


def reaction_time_of(text: str) -> ReactionTime:
    """A reaction time such as `instant` or `20 ms`.

    Raises:
        argparse.ArgumentTypeError: the text is not a reaction time.
    """
    value = reaction_time(text)
    if value is None:
        raise argparse.ArgumentTypeError(REACTION_TIME.replace("`", "'"))
    return value


def add_reaction_time(parser: argparse.ArgumentParser) -> None:
    """Add the option `--reaction-time`."""
    parser.add_argument(
        "--reaction-time",
        type=reaction_time_of,
        metavar="TIME",
        help="how long machines may wait before they take a possible step: any, instant, or a duration such as "
        "'20 ms'; overrides reaction_time of <max_time> in MAIN.xml (any; for a tree with mocks: instant)",
    )
