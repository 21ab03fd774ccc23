# SPDX-License-Identifier: Apache-2.0
"""The content of a diagram, independent of its notation."""

from __future__ import annotations

import enum

from roaml.record import Record


class Kind(enum.Enum):
    STATES = "states"
    TREE = "tree"
    NETWORK = "network"


class GraphNode(Record, frozen=True):
    """A node of a diagram. `lines` are the lines of its label; `minor` nodes, which the
    translation added, are drawn in grey."""

    id: str
    lines: tuple[str, ...]
    minor: bool = False


class GraphLink(Record, frozen=True):
    source: str
    target: str
    lines: tuple[str, ...] = ()


class Graph(Record, frozen=True):
    """A diagram. `initial` is the id of the initial node; "" if there is none."""

    kind: Kind
    title: str
    nodes: tuple[GraphNode, ...]
    links: tuple[GraphLink, ...]
    initial: str = ""
