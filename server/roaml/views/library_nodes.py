# SPDX-License-Identifier: Apache-2.0
"""Nodes of the tree whose behaviour is that of a library or of a mock. Their states are not those of a machine that the
user has written."""

from __future__ import annotations

from roaml.jani.model import Automaton
from roaml.scxml.names import NODE_AUTOMATON


def is_library_node(automaton: Automaton) -> bool:
    """Whether an automaton is a node of the tree whose behaviour is that of a library or of a mock."""
    node = NODE_AUTOMATON.fullmatch(automaton.name)
    return node is not None and (_is_builtin(node[2]) or _is_in_tree(automaton))


def _is_in_tree(automaton: Automaton) -> bool:
    """Whether the behaviour of a node is that of a library: the node has no file of its own, so its origin is its place
    in the tree. In the automaton's name, the name of the node may replace that of its type."""
    return automaton.origin is not None and automaton.origin.path.lower().endswith(".xml")


def _is_builtin(plugin: str) -> bool:
    from roaml.model.system import library_plugins  # noqa: PLC0415 - a JANI model has no tree, and loads faster

    return plugin in library_plugins()
