# SPDX-License-Identifier: Apache-2.0
"""Names that the translation gives to nodes of the tree are explained where they are shown."""

from __future__ import annotations

import pytest

from as2fm_lsp.verification.node_names import explained
from roaml.jani.model import Automaton, Model, ModelType, System
from roaml.text import Location, Span


def model() -> Model:
    names = ("BT_plugin_1000_Sequence", "bt_1000_tick", "BT_plugin_1001_Go_home", "bt_1001_tick", "BT_plugin_1002_Go")
    automata = tuple(
        Automaton(name, (), ("s",), origin=Location("tree.xml", Span(number, number)))
        for number, name in enumerate(names)
    )
    return Model(ModelType.MDP, automata, System(()))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", ""),
        ("Sequence answers", ""),
        ("BT_plugin_1000_Sequence and not_bt_1000 and bt_7", ""),
        ("it reads bt_1000_response__status", "nodes of the behavior tree: bt_1000 is Sequence (tree.xml:1)\n"),
        (
            "Go_home (bt_1001) and Go (bt_1002), and again bt_1001",
            "nodes of the behavior tree: bt_1001 is Go_home (tree.xml:3), bt_1002 is Go\n",
        ),
    ],
)
def test_only_mentioned_nodes(text: str, said: str) -> None:
    assert explained(text, model(), lambda origin: f"{origin.path}:{origin.span.start}") == said
