# SPDX-License-Identifier: Apache-2.0
"""Reading a tree without a system for `verify` and `simulate`."""

from __future__ import annotations

import argparse

from as2fm_lsp.cli.mock_arguments import missing_mocks, mocks_for_tree
from as2fm_lsp.cli.output import complain
from roaml.api.trees import LoadedTree, load_tree
from roaml.mocks.mock import MockError, unused
from roaml.mocks.network import DEFAULT_MAX_TIME, DEFAULT_RATE, MissingMocksError, MockOptions
from roaml.project.settings import Settings


def load_subject(options: argparse.Namespace, settings: Settings, *, counts: bool) -> LoadedTree:
    """The tree that the arguments name, with the mocks that they declare.

    Args:
        counts: whether mocks count their answers, for measurements.

    Raises:
        MockError: an entry or a mock is not valid, or leaves have no mock.
        PathError, ModelError: as `load_tree`.
    """
    entries = {}
    for text in options.entry:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise MockError(f"`{text}` does not set an entry; write it as NAME=VALUE")
        entries[name.strip()] = value.strip()
    mocks = mocks_for_tree(options, options.main)
    rate, max_time = options.tick_rate or DEFAULT_RATE, options.max_time or DEFAULT_MAX_TIME
    chosen = MockOptions(mocks, entries, rate, max_time, counts)
    try:
        tree = load_tree(options.main, chosen, settings)
    except MissingMocksError as missing:
        raise missing_mocks(options.main, [leaf.type for leaf in missing.leaves]) from None
    nodes = [(node.name, node.type) for node in tree.mocked.tree.nodes]
    for mock in unused(mocks, nodes):
        complain(f"the mock `{mock.pattern}` matches no node of the tree")
    return tree
