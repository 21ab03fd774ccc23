# SPDX-License-Identifier: Apache-2.0
"""Names that the translation gives to nodes of the tree are explained where they are shown."""

from __future__ import annotations

import pytest

from as2fm_lsp.verification.node_names import explained
from roaml.jani.model import Automaton, Model, ModelType, System
from roaml.text import Location, Span


def model() -> Model:
    """A control node, whose origin is its place in the tree, and two plugins. The origin of a tick is where a parent
    sends it, or the place of a plugin in the tree."""
    origins = {
        "BT_plugin_1000_Sequence": ("tree.xml", 2),
        "bt_1000_tick": ("tree.xml", 1),
        "BT_plugin_1001_Go_home": ("go_home.ascxml", 7),
        "bt_1001_tick": ("tree.xml", 3),
        "BT_plugin_1002_Go": ("go.ascxml", 7),
    }
    automata = tuple(
        Automaton(name, (), ("s",), origin=Location(path, Span(start, start)))
        for name, (path, start) in origins.items()
    )
    return Model(ModelType.MDP, automata, System(()))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", ""),
        ("Sequence answers", ""),
        ("BT_plugin_1000_Sequence and not_bt_1000 and bt_7", ""),
        ("it reads bt_1000_response__status", "nodes of the behavior tree: bt_1000 is Sequence (tree.xml:2)\n"),
        (
            "Go_home (bt_1001) and Go (bt_1002), and again bt_1001",
            "nodes of the behavior tree: bt_1001 is Go_home (tree.xml:3), bt_1002 is Go\n",
        ),
    ],
)
def test_only_mentioned_nodes(text: str, said: str) -> None:
    assert explained(text, model(), lambda origin: f"{origin.path}:{origin.span.start}") == said
