# SPDX-License-Identifier: Apache-2.0
"""A file of trees with the files that it is seen with, and what is known about the nodes in them.

- Knowledge about a node comes from BehaviorTree.CPP first, then from `<TreeNodesModel>` elements, then from further
  libraries.
- A library is chosen by settings, or by itself if the trees use its nodes (docs/spec/lone-trees.md#models).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from roaml.forest.cpp_types import normal
from roaml.libraries import BEHAVIORTREE_CPP, LIBRARIES, Absent, Direction, Library, Node, NodeKind, Port, library
from roaml.model.kinds import PROJECT_EXTENSION
from roaml.model.tree import NodeModel, PortSetting, Tree, TreeFile, TreeNode, nodes

CPP = library(BEHAVIORTREE_CPP)

_COMMON_NAMES = frozenset(
    (
        *("Wait", "Spin", "BackUp", "IsStuck", "IsBatteryLow", "IsBatteryCharging", "GoalReached", "TimeExpired"),
        *("FollowPath", "FollowObject", "DockRobot", "UndockRobot", "GetCurrentPose", "NavigateToPose", "RoundRobin"),
        *("GoalUpdated", "InitialPoseReceived"),
    )
)
"""Names that nodes of other programs have, too: one of them alone does not choose a library."""

_OLD_ATTRIBUTES = ("__autoremap", "__shared_blackboard")
_OLD_TAGS = ("SubTreePlus", *CPP.renamed, *(name for name in CPP.absent if name.startswith("BlackboardCheck")))


@dataclass(frozen=True, slots=True)
class TreeSettings:
    """Attributes:
    models: files with models of nodes, besides those that trees include.
    libraries: the names of libraries whose nodes there are.
    version: of BehaviorTree.CPP, as two numbers; None for the newest.
    """

    models: tuple[str, ...] = ()
    libraries: tuple[str, ...] = ()
    version: tuple[int, int] | None = None


NEWEST = TreeSettings()


@dataclass(frozen=True, eq=False)
class Forest:
    """Attributes:
    path: the file that is looked at.
    files: that file and those that it is seen with, by path: what it includes, projects, models.
    beside: the names of the trees in its folder, whose files a program may load together.
    complete: all includes could be read.
    """

    path: str
    files: tuple[tuple[str, TreeFile], ...]
    settings: TreeSettings
    beside: frozenset[str] = frozenset()
    complete: bool = True

    @property
    def file(self) -> TreeFile:
        return self.files[0][1]

    @cached_property
    def is_version_3(self) -> bool:
        """Whether the file says that it is written for version 3, or, without saying it, uses what only that has."""
        if self.file.format:
            return self.file.format == "3"
        return any(_is_old(node) for tree in self.file.trees for node in nodes(tree))

    @cached_property
    def trees(self) -> Mapping[str, tuple[str, Tree]]:
        """The trees by name, with their files; of equal names the first."""
        found: dict[str, tuple[str, Tree]] = {}
        for path, file in self.files:
            for tree in file.trees:
                if tree.id is not None:
                    found.setdefault(tree.id.value, (path, tree))
        return found

    @cached_property
    def models(self) -> Mapping[str, Node]:
        """The nodes that models of the files describe, subtrees left out; of equal names the first."""
        found: dict[str, Node] = {}
        for _, file in self.files:
            for model in file.models:
                if model.id is not None and model.kind != "SubTree":
                    found.setdefault(model.id.value, node_of(model))
        return found

    @cached_property
    def subtree_models(self) -> Mapping[str, Node]:
        found: dict[str, Node] = {}
        for _, file in self.files:
            for model in file.models:
                if model.id is not None and model.kind == "SubTree":
                    found.setdefault(model.id.value, node_of(model))
        return found

    @cached_property
    def libraries(self) -> tuple[Library, ...]:
        """The libraries beyond BehaviorTree.CPP that are used."""
        return tuple(
            library(name) for name in LIBRARIES if name in self.settings.libraries or self._uses(library(name))
        )

    def _uses(self, known: Library) -> bool:
        names = set()
        for _, file in self.files:
            for tree in file.trees:
                for node in nodes(tree):
                    name = node.plugin.value if node.plugin and not node.is_subtree else ""
                    entry = known.nodes.get(name)
                    if entry is None or name in self.models or name in self.trees:
                        continue
                    if name not in _COMMON_NAMES:
                        return True
                    if all(entry.port(setting.attribute.name) for setting in ports_of(node)):
                        names.add(name)
        return len(names) > 1

    def node(self, name: str) -> Node | None:
        """What is known about the nodes of a name."""
        found = CPP.nodes.get(name)
        if found is not None and not found.until and not self.is_newer_than_used(found):
            return found
        found = self.models.get(name)
        if found is not None:
            return found
        return next((known.nodes[name] for known in self.libraries if name in known.nodes), None)

    def is_newer_than_used(self, node: Node) -> bool:
        """Whether the version of the library that is used does not have a node yet."""
        if self.settings.version is None or not node.since:
            return False
        major, _, minor = node.since.partition(".")
        return (int(major), int(minor or 0)) > self.settings.version

    def absent(self, name: str) -> Absent | None:
        """What a name is that is known to be no node."""
        return None if name in self.models else CPP.absent.get(name)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of all nodes that are known."""
        own = (name for name, node in CPP.nodes.items() if not node.until)
        return (*own, *self.models, *(name for known in self.libraries for name in known.nodes))

    @cached_property
    def has_own_models(self) -> bool:
        """Whether models describe nodes that are not those of BehaviorTree.CPP."""
        return any(name not in CPP.nodes for name in self.models)

    @property
    def has_all_models(self) -> bool:
        """Whether the user has said where all models are: in a project of Groot2 or in settings."""
        is_project = any(path.endswith(PROJECT_EXTENSION) for path, _ in self.files)
        return self.has_own_models and (is_project or bool(self.settings.models))

    @cached_property
    def host_entries(self) -> frozenset[str]:
        """The blackboard entries that the program which runs the trees sets."""
        return frozenset(entry for known in self.libraries for entry in known.entries)

    def all_nodes(self) -> Iterator[tuple[str, Tree, TreeNode]]:
        """The nodes of all files, each with its file and tree."""
        for path, file in self.files:
            for tree in file.trees:
                for node in nodes(tree):
                    yield path, tree, node

    def own_nodes(self) -> Iterator[tuple[Tree, TreeNode]]:
        """The nodes of the file that is looked at."""
        for tree in self.file.trees:
            for node in nodes(tree):
                yield tree, node

    def known_node(self, node: TreeNode) -> Node | None:
        """What is known about a node of a tree; None also for subtrees."""
        if node.is_subtree or node.plugin is None or self.names_tree(node):
            return None
        return self.node(node.plugin.value)

    def names_tree(self, node: TreeNode) -> bool:
        """Whether a node in compact form is written with the name of a tree, which stands for it."""
        return node.compact and node.plugin is not None and node.plugin.value in self.trees


def _is_old(node: TreeNode) -> bool:
    name = node.plugin.value if node.plugin else ""
    return (
        node.element.name in _OLD_TAGS
        or (not node.compact and not node.is_subtree and name in _OLD_TAGS)
        or (node.is_subtree and any(node.element.get(attribute) for attribute in _OLD_ATTRIBUTES))
    )


def node_of(model: NodeModel) -> Node:
    """A node as a `<TreeNodesModel>` describes it."""
    assert model.id is not None
    kind = NodeKind(model.kind.lower()) if model.kind.lower() in _KINDS else NodeKind.ACTION
    ports = tuple(
        Port(
            port.name.value,
            Direction(port.direction) if port.direction in _DIRECTIONS else Direction.INOUT,
            port.type,
            port.default,
            kind is NodeKind.SUBTREE and port.default is None,
            port.text,
        )
        for port in model.ports
        if port.name is not None
    )
    return Node(model.id.value, kind, ports, kind.children, model.text)


_KINDS = frozenset(kind.value for kind in NodeKind)
_DIRECTIONS = frozenset(direction.value for direction in Direction)


def ports_of(node: TreeNode) -> Iterator[PortSetting]:
    """The attributes of a node that set ports; those that begin with `_` belong to the library."""
    return (setting for setting in node.ports if not setting.attribute.name.startswith("_"))


def port_type(port: Port | None) -> str:
    """One name for the spellings of a port's type; `any` if it is not known."""
    return normal(port.type) if port else "any"
