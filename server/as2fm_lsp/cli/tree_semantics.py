# SPDX-License-Identifier: Apache-2.0
"""The option that chooses the meaning of the nodes of behavior trees (docs/spec/nodes.md#semantics)."""

from __future__ import annotations

import argparse

from roaml.model.parameters import SEMANTICS, TreeSemantics

OPTION = "--tree-semantics"


def add_semantics(parser: argparse._ActionsContainer) -> None:
    """Add the option to a sub-command."""
    help_ = "the meaning of the nodes of BehaviorTree.CPP in systems: that of the library (the default), or of AS2FM"
    parser.add_argument(OPTION, choices=tuple(SEMANTICS), default=None, help=help_)


def semantics_of(options: argparse.Namespace) -> TreeSemantics | None:
    """The semantics that the option chooses; `None` without the option."""
    return SEMANTICS.get(options.tree_semantics or "")
