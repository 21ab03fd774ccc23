# SPDX-License-Identifier: Apache-2.0
"""The options for mocks in trees without a system and in systems, and for the blackboard entries and the tick rate of
trees without a system."""

from __future__ import annotations

import argparse
from fractions import Fraction

from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.output import note
from as2fm_lsp.mocked_models import MAX_RATE, MockDeclarations, MockMessages, read_rate
from as2fm_lsp.outputs import InputPath
from roaml.mocks.mock import MockError

MESSAGES = MockMessages(note, shown_path, '--mock "*: 0.9 in 1 s"')
"""Messages about mocks are written to standard error."""


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
        "succeed with probability P; actions are RUNNING for TIME before, such as '2 s' or 'normal(2 s, "
        "300 ms)'; 'NODE: as TYPE(PORT=VALUE)' executes nodes with children like a node of a library; `*` in NODE "
        "matches any text; may be repeated")  # fmt: skip
    add(
        "--mocks",
        type=InputPath,
        metavar="FILE",
        help="read mocks from a file, one in each line (default without --mock: the file TREE.mocks beside TREE.xml, "
        "if there is one)",
    )
    return group


def declared_mocks(options: argparse.Namespace) -> MockDeclarations:
    """The mocks that the options of `add_mocks` declare."""
    return MockDeclarations(tuple(options.mock), options.mocks)


def declarations_in(options: argparse.Namespace) -> MockDeclarations:
    """The declarations in the options of `add_mock_options`.

    Raises:
        MockError: an entry is not written as `NAME=VALUE`.
    """
    entries = {}
    for text in options.entry:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise MockError(f"`{text}` does not set an entry; write it as NAME=VALUE")
        entries[name.strip()] = value.strip()
    return MockDeclarations(tuple(options.mock), options.mocks, entries, options.tick_rate)


def _rate(text: str) -> Fraction:
    rate = read_rate(text)
    if rate is None:
        raise argparse.ArgumentTypeError(f"expected a number of Hz, greater than 0 and at most {MAX_RATE}")
    return rate
