# SPDX-License-Identifier: Apache-2.0
"""A file of trees with the files that belong to it, and the declarations of their nodes.

- In a system, a node is a plugin or a node of a library (`System.plugin`).
- Without a system, its declaration comes from BehaviorTree.CPP, else from a `<TreeNodesModel>`, else from another
  library. A library is used if the settings name it, or if the trees use its nodes (docs/spec/lone-trees.md#models).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property

from roaml.forest.cpp_types import normal
from roaml.forest.ports import ports_of
from roaml.forest.settings import TreeSettings
from roaml.forest.written_for import Signs, files_of_version_3, signs_of
from roaml.libraries import BEHAVIORTREE_CPP, LIBRARIES, Absent, Library, Node, Port, library, library_node
from roaml.libraries.version import first_patch
from roaml.model.kinds import PROJECT_EXTENSION
from roaml.model.outline import MachineOutline
from roaml.model.system import CHILDREN_COUNT, System, library_plugins
from roaml.model.tree import NodeModel, PortSetting, Tree, TreeFile, TreeNode, nodes
from roaml.record import Record, replace
from roaml.roles import UNBOUNDED, Direction, NodeKind
from roaml.suggest import close_names

CPP = library(BEHAVIORTREE_CPP)

_COMMON_NAMES = frozenset(
    (
        *("Wait", "Spin", "BackUp", "IsStuck", "IsBatteryLow", "IsBatteryCharging", "GoalReached", "TimeExpired"),
        *("FollowPath", "FollowObject", "DockRobot", "UndockRobot", "GetCurrentPose", "NavigateToPose", "RoundRobin"),
        *("GoalUpdated", "InitialPoseReceived"),
    )
)
"""Names of library nodes that are also common in other programs: one leaf with such a name does not show that the
library is used."""


class Forest(Record, frozen=True, eq=False, dict=True):
    """A file of behavior trees together with the files that belong to it.

    Attributes:
        path: the file that is analysed.
        files: (path, file) pairs of that file, the files that include it, the files that it includes, the projects that
            list it, and the files of models. The files that include it come first.
        beside: the names of the trees in all files of the folder, because a program may load these files together.
        complete: whether all included files could be read.
        models_beside: the models in other files of the folder. A node that they describe is not the node of that name
            in a library, unless they describe that one.
        system: the system that the trees belong to; `None` for trees without a system.
    """

    path: str
    files: tuple[tuple[str, TreeFile], ...]
    settings: TreeSettings
    beside: frozenset[str] = frozenset()
    complete: bool = True
    models_beside: tuple[NodeModel, ...] = ()
    system: System | None = None

    @cached_property
    def file(self) -> TreeFile:
        return next(file for path, file in self.files if path == self.path)

    @property
    def is_included(self) -> bool:
        """Whether another file includes the file that is analysed."""
        return self.files[0][0] != self.path

    @property
    def main(self) -> str | None:
        """The name of the tree that is executed; `None` if the first file does not name it."""
        main = self.files[0][1].main
        return main.value if main else None

    @property
    def is_version_3(self) -> bool:
        """Whether the file that is analysed is written for version 3; `False` in a system."""
        return self.path in self.files_of_version_3

    @cached_property
    def files_of_version_3(self) -> frozenset[str]:
        """The files that are written for version 3; those of systems may have the names of both versions."""
        return frozenset() if self.system is not None else files_of_version_3(self.signs)

    @cached_property
    def signs(self) -> Mapping[str, Signs]:
        """Path -> what shows the version, for each file with trees, except files of models that the settings name."""
        return {
            path: signs_of(file)
            for path, file in self.files
            if file.trees and (path == self.path or path not in self.settings.models)
        }

    @cached_property
    def _nodes_of_version_3(self) -> frozenset[TreeNode]:
        """The nodes in `files_of_version_3`."""
        files = self.files_of_version_3
        return frozenset(node for path, _, node in self.all_nodes if path in files) if files else frozenset()

    def is_of_version_3(self, node: TreeNode) -> bool:
        """Whether the file of a node is written for version 3."""
        return node in self._nodes_of_version_3

    @cached_property
    def trees(self) -> Mapping[str, tuple[str, Tree]]:
        """Name -> path of the file, and tree. If several trees have the same name, the first is used."""
        trees: dict[str, tuple[str, Tree]] = {}
        for path, file in self.files:
            for tree in file.trees:
                if tree.id is not None:
                    trees.setdefault(tree.id.value, (path, tree))
        return trees

    @cached_property
    def subtrees(self) -> Mapping[str, frozenset[str]]:
        """The name of each tree -> the names of the trees that it uses, including unknown ones, and those whose names a
        system does not accept as elements."""
        return {
            name: frozenset(
                node.plugin.value
                for node in nodes(tree)
                if node.plugin is not None and (node.is_subtree or (node.compact and node.plugin.value in self.trees))
            )
            for name, (_, tree) in self.trees.items()
        }

    def reached(self, start: str) -> frozenset[str]:
        """The names of the tree `start` and of all trees that it contains as subtrees."""
        reached, pending = {start}, [start]
        while pending:
            for name in self.subtrees.get(pending.pop(), frozenset()) - reached:
                reached.add(name)
                pending.append(name)
        return frozenset(reached)

    @cached_property
    def executed(self) -> frozenset[str]:
        """The names of the trees that are executed: the main tree and its subtrees, or all trees if the first file
        names no main tree."""
        if self.main is not None and self.main in self.trees:
            return self.reached(self.main)
        return frozenset((*self.trees, ""))

    @cached_property
    def models(self) -> Mapping[str, Node]:
        """The nodes that models in the files describe, by name, without subtrees. If several models have the same name,
        the first is used."""
        models: dict[str, Node] = {}
        for _, file in self.files:
            for model in file.models:
                if model.id is not None and not model.is_subtree:
                    models.setdefault(model.id.value, node_of(model))
        return models

    def is_partly_described(self, node: Node) -> bool:
        """Whether an error in the model or machine of a node may hide some of its ports."""
        if self.system is not None:
            outline = self.system.plugin(node.name)[1]
            return outline is not None and not outline.all_ports
        return node.name in self._unclear_models and not node.library

    @cached_property
    def _unclear_models(self) -> frozenset[str]:
        models = (model for _, file in self.files for model in file.models)
        return frozenset(model.id.value for model in models if model.id is not None and not _is_clear(model))

    @cached_property
    def subtree_models(self) -> Mapping[str, Node]:
        models: dict[str, Node] = {}
        for _, file in self.files:
            for model in file.models:
                if model.id is not None and model.is_subtree:
                    models.setdefault(model.id.value, node_of(model))
        return models

    @cached_property
    def libraries(self) -> tuple[Library, ...]:
        """The libraries that are used in addition to BehaviorTree.CPP."""
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
                    if entry is None or name in self.trees:
                        continue
                    if name in self.models and not is_model_of(self.models[name], entry):
                        continue
                    if name not in _COMMON_NAMES:
                        return True
                    if all(entry.port(setting.attribute.name) for setting in ports_of(node)):
                        if node.children and entry.children[1]:
                            return True  # programs seldom have own nodes with children
                        names.add(name)
        return len(names) > 1

    def node(self, name: str, *, version_3: bool | None = None) -> Node | None:
        """The declaration of the node type `name`; `None` if there is none. In a file of version 3, the names of
        version 3 are known, too.

        Args:
            version_3: whether the file is written for version 3; by default, as the file that is analysed.
        """
        is_old = self.is_version_3 if version_3 is None else version_3
        if self.system is not None:
            path, outline = self.system.plugin(name)
            declared = None if outline is None else node_of_machine(outline) if path else library_node(name)
            return None if declared is None else self._with_defaults(declared)
        renamed = CPP.renamed.get(name) if is_old else None
        declaration = CPP.nodes.get(renamed.now if renamed else name)
        is_known = declaration is not None and (is_old or not declaration.until)
        if declaration is not None and is_known and not self.is_newer_than_used(declaration):
            return declaration
        declaration = self._described.get(name)
        if declaration is not None:
            return declaration
        known = next((known.nodes[name] for known in self.libraries if name in known.nodes), None)
        return None if known is None or self._is_own(known) else known

    def _with_defaults(self, node: Node) -> Node:
        """A node of a system, whose ports need not be set if models give them defaults."""
        defaults = self.defaults.get(node.name, {})
        ports = (replace(port, required=port.required and port.name not in defaults) for port in node.ports)
        return replace(node, ports=tuple(ports)) if defaults else node

    @cached_property
    def defaults(self) -> Mapping[str, Mapping[str, str]]:
        """Type of a node, or name of a tree -> port -> its default in a model. If several models have the same name,
        the first is used."""
        defaults: dict[str, dict[str, str]] = {}
        for model in (model for _, file in self.files for model in file.models if model.id is not None):
            for port in model.ports:
                if model.id is not None and port.name is not None and port.default is not None:
                    defaults.setdefault(model.id.value, {}).setdefault(port.name.value, port.default)
        return defaults

    def _is_own(self, node: Node) -> bool:
        """Whether the program has a node of its own with the name of a node of a library: a model in another file of
        the folder describes it differently, or its name is common and no attribute of its uses resembles a port of the
        library's node. A library that the settings name is always meant."""
        if node.name not in self._own_nodes:
            beside = [node_of(m) for m in self.models_beside if m.id is not None and m.id.value == node.name]
            is_other = bool(beside) and not any(is_model_of(model, node) for model in beside)
            if not beside and node.name in _COMMON_NAMES:
                uses = [use for _, _, use in self.all_nodes if use.plugin is not None and use.plugin.value == node.name]
                ports = [name for use in uses for name in (setting.attribute.name for setting in ports_of(use))]
                names = tuple(port.name for port in node.ports)
                is_other = bool(ports) and not any(name in names or close_names(name, names) for name in ports)
            named = any(node.library == library(name).name for name in self.settings.libraries)
            self._own_nodes[node.name] = is_other and not named
        return self._own_nodes[node.name]

    @cached_property
    def _own_nodes(self) -> dict[str, bool]:
        """The results of `_is_own`."""
        return {}

    @cached_property
    def _described(self) -> Mapping[str, Node]:
        """The nodes in models. Groot2 also writes models of nodes of libraries. A model of this kind determines which
        ports the node has; the library determines the behaviour of the node, and the types and defaults that the model
        does not state."""
        described = dict(self.models)
        for known in self.libraries:
            for name, model in self.models.items():
                entry = known.nodes.get(name)
                if entry is not None and is_model_of(model, entry):
                    described[name] = replace(
                        model,
                        ports=tuple(_completed(port, entry) for port in model.ports),
                        children=entry.children,
                        running=entry.running,
                        succeeds=entry.succeeds,
                        behaviour=known.name,
                    )
        return described

    def is_machine(self, node: Node) -> bool:
        """Whether a declared node is a machine of the system."""
        return self.system is not None and not node.library

    def is_newer_than_used(self, node: Node) -> bool:
        """Whether the node is newer than the version of BehaviorTree.CPP in the settings."""
        return bool(node.since) and first_patch(node.since) > self.settings.version

    def absent(self, name: str) -> Absent | None:
        """What is known about a name that is not the name of a node; `None` if nothing is known about it."""
        return None if name in self.models else CPP.absent.get(name)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of all declared nodes, in a system those of the plugins and of the nodes that can be executed."""
        if self.system is not None:
            current = (name for name in library_plugins() if name not in CPP.renamed)
            return (*(outline.name for _, outline in self.system.plugins), *current)
        own = (name for name, node in CPP.nodes.items() if not node.until)
        others = (node for known in self.libraries for node in known.nodes.values())
        return (*own, *self.models, *(node.name for node in others if not self._is_own(node)))

    @cached_property
    def has_own_models(self) -> bool:
        """Whether models describe nodes that BehaviorTree.CPP does not have."""
        return any(name not in CPP.nodes for name in self.models)

    @property
    def has_all_models(self) -> bool:
        """Whether all nodes are assumed to have models, because models describe nodes that BehaviorTree.CPP does not
        have and are listed in a Groot2 project or in the settings."""
        is_project = any(path.endswith(PROJECT_EXTENSION) for path, _ in self.files)
        return self.has_own_models and (is_project or bool(self.settings.models))

    @cached_property
    def host_entries(self) -> frozenset[str]:
        """The blackboard entries set by the program that executes the trees."""
        known = self.libraries if self.system is None else tuple(library(name) for name in LIBRARIES)
        return frozenset(entry for library_ in known for entry in library_.entries)

    @cached_property
    def all_nodes(self) -> tuple[tuple[str, Tree, TreeNode], ...]:
        """The nodes of all files, each with the path of its file and its tree."""
        return tuple((path, tree, node) for path, file in self.files for tree in file.trees for node in nodes(tree))

    @cached_property
    def own_nodes(self) -> tuple[tuple[Tree, TreeNode], ...]:
        """The nodes of the file that is analysed."""
        return tuple((tree, node) for path, tree, node in self.all_nodes if path == self.path)

    def is_condition(self, node: TreeNode) -> bool:
        """Whether a node is written or declared as a condition."""
        known = self.known_node(node)
        return node.element.name == "Condition" or (known is not None and known.kind is NodeKind.CONDITION)

    def known_node(self, node: TreeNode) -> Node | None:
        """The declaration of the type of a node; `None` for subtrees and for types without a declaration."""
        if node not in self._known_nodes:
            is_tree = node.plugin is None or self.calls_tree(node)
            self._known_nodes[node] = (
                None
                if is_tree or node.plugin is None
                else self.node(node.plugin.value, version_3=self.is_of_version_3(node))
            )
        return self._known_nodes[node]

    @cached_property
    def _known_nodes(self) -> dict[TreeNode, Node | None]:
        """The results of `known_node`, which many rules need."""
        return {}

    def declaration(self, node: TreeNode) -> Node | None:
        """The declaration of the type of a node; for a subtree, its description in a model. `None` if there is none."""
        if node.plugin is not None and self.calls_tree(node):
            return self.subtree_models.get(node.plugin.value)
        return self.known_node(node)

    def port_settings(self, node: TreeNode) -> Iterable[PortSetting]:
        """The attributes of a node that set ports. Plugins of a system may have ports that begin with `_`."""
        return ports_of(node) if self.system is None else node.ports

    def is_unknown(self, node: TreeNode) -> bool:
        """Whether a node has a type without a declaration."""
        return node.plugin is not None and not self.calls_tree(node) and self.known_node(node) is None

    def calls_tree(self, node: TreeNode) -> bool:
        """Whether a node executes a tree: a `<SubTree>`, and without a system also an element with the name of a
        tree."""
        named = node.plugin.value if node.compact and node.plugin is not None and self.system is None else None
        return node.is_subtree or named in self.trees


def is_model_of(model: Node, node: Node) -> bool:
    """Whether a model describes a node of a library: its kind is the same, and the library has all its ports."""
    return model.kind is node.kind and all(node.port(port.name) is not None for port in model.ports)


def _completed(port: Port, node: Node) -> Port:
    """A port of a model of a node of a library, with the type and default of the library if the model has none."""
    known = node.port_by_name[port.name]
    default = known.default if port.default is None else port.default
    return replace(port, type=port.type or known.type, default=default, text=port.text or known.text)


def _is_clear(model: NodeModel) -> bool:
    """Whether all ports of a model have names, no two have the same name, and all elements with names in the model are
    ports."""
    names = [port.name.value if port.name else "" for port in model.ports]
    is_port = all(child.name.endswith("_port") for child in model.element.elements if child.get("name"))
    return "" not in names and len(set(names)) == len(names) and is_port


def node_of(model: NodeModel) -> Node:
    """The declaration of a node from its description in a `<TreeNodesModel>`."""
    assert model.id is not None
    kind = NodeKind(model.kind.lower()) if model.kind.lower() in _KINDS else NodeKind.ACTION
    ports = tuple(
        Port(
            port.name.value,
            port.direction,
            port.type,
            port.default,
            kind is NodeKind.SUBTREE and port.default is None,
            port.text,
        )
        for port in model.ports
        if port.name is not None
    )
    return Node(model.id.value, kind, ports, kind.children, model.text)


def node_of_machine(outline: MachineOutline) -> Node:
    """The declaration of a node that a machine executes, which needs all ports that a tree can set. The number of its
    children is not limited here."""
    ports = tuple(
        Port(
            port.key,
            Direction.IN if port.direction is Direction.IN else Direction.OUT,
            port.type,
            required=port.key != CHILDREN_COUNT,
        )
        for port in outline.ports
    )
    return Node(outline.name, NodeKind.ACTION, ports, (0, UNBOUNDED))


_KINDS = frozenset(kind.value for kind in NodeKind)


def port_type(port: Port | None) -> str:
    """The normal name of the type of a port; `any` if not known."""
    return normal(port.type) if port else "any"
