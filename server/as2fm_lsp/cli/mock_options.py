# SPDX-License-Identifier: Apache-2.0
"""The options for mocks in trees without a system and in systems, and for the blackboard entries and the tick rate of
trees without a system."""

from __future__ import annotations

import argparse
from fractions import Fraction

from roaml.disk import UnreadableReason, read
from roaml.model.kinds import FileKind, kind_of
from roaml.text import decode

MAX_RATE = 10_000
"""The maximum tick rate, in Hz."""


def add_mock_options(parser: argparse.ArgumentParser) -> None:
    add = add_mocks(parser).add_argument
    add("--entry", action="append", default=[], metavar="NAME=VALUE", help="the blackboard entry NAME has this "
        "value at the start; may be repeated")  # fmt: skip
    add("--tick-rate", type=_rate, metavar="HZ", help="tick rate of the tree, in Hz (10)")


def add_mocks(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """Add the options that declare mocks, and return their group."""
    group = parser.add_argument_group(
        "mocks", "for trees without a system, and for leaves that have no plugin in a system"
    )
    add = group.add_argument
    add("--mock", action="append", default=[], metavar="'NODE: P in TIME'", help="leaves with this name or type "
        "succeed with probability P; actions are RUNNING for TIME before; `*` in NODE matches any text; may be "
        "repeated")  # fmt: skip
    add("--mocks", metavar="FILE", help="read mocks from a file, one in each line (default without --mock: the file "
        "TREE.mocks beside TREE.xml, if there is one)")  # fmt: skip
    return group


def has_mock_options(options: argparse.Namespace) -> bool:
    return bool(options.mock or options.mocks or options.entry or options.tick_rate)


def names_tree(path: str) -> bool:
    """Whether a path names a file with behavior trees."""
    if path.endswith(".jani"):
        return False
    data = read(path)
    if isinstance(data, UnreadableReason):
        return False  # reported where the file is read
    return kind_of(path, decode(path, data).text) is FileKind.TREE


def _rate(text: str) -> Fraction:
    try:
        rate = Fraction(text)
    except (ValueError, ZeroDivisionError):
        rate = Fraction(0)
    if not 0 < rate <= MAX_RATE:
        raise argparse.ArgumentTypeError(f"expected a number of Hz, greater than 0 and at most {MAX_RATE}")
    return rate
