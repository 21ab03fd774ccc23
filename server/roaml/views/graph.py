# SPDX-License-Identifier: Apache-2.0
"""The content of a diagram, independent of its notation."""

from __future__ import annotations

import enum
from dataclasses import dataclass


class Kind(enum.Enum):
    STATES = "states"
    TREE = "tree"
    NETWORK = "network"


@dataclass(frozen=True, slots=True)
class GraphNode:
    """A node of a diagram. `lines` are the lines of its label; `minor` nodes are drawn less prominently."""

    id: str
    lines: tuple[str, ...]
    minor: bool = False


@dataclass(frozen=True, slots=True)
class GraphLink:
    source: str
    target: str
    lines: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Graph:
    """A diagram. `initial` is the initial node; "" if there is none."""

    kind: Kind
    title: str
    nodes: tuple[GraphNode, ...]
    links: tuple[GraphLink, ...]
    initial: str = ""
