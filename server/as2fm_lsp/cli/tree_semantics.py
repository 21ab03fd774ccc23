# SPDX-License-Identifier: Apache-2.0
"""The option that chooses the meaning of the nodes of behavior trees (docs/spec/nodes.md#semantics). It may also
precede the sub-command."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from roaml.model.parameters import SEMANTICS, TreeSemantics

OPTION = "--tree-semantics"


def add_semantics(parser: argparse._ActionsContainer) -> None:
    """Add the option to a sub-command."""
    help_ = "the meaning of the nodes of BehaviorTree.CPP in systems: that of the library (the default), or of AS2FM"
    parser.add_argument(OPTION, choices=tuple(SEMANTICS), default=None, help=help_)


def semantics_of(options: argparse.Namespace) -> TreeSemantics | None:
    """The semantics that the option chooses; `None` without the option."""
    return SEMANTICS.get(options.tree_semantics or "")


def behind(arguments: Sequence[str]) -> list[str]:
    """The arguments, with the option behind them if they begin with it."""
    first = arguments[0] if arguments else ""
    count = 2 if first == OPTION else 1 if first.startswith(f"{OPTION}=") else 0
    return [*arguments[count:], *arguments[:count]]
