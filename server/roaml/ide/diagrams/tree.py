# SPDX-License-Identifier: Apache-2.0
"""The executed behavior tree with its ports and subtrees, and the variables of the blackboard that connect them.

A tree file that belongs to no system is drawn as well, but the directions of the ports of its plugins are not known.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from roaml.forest.names import entry_of, is_autoremapped
from roaml.forest.ports import ports_of as node_ports
from roaml.ide.diagrams.diagram import (
    Detail,
    DetailKind,
    DiagramEdge,
    DiagramNode,
    DiagramNodeKind,
    EdgeKind,
    Picture,
    TreeNodeTitle,
)
from roaml.libraries import BEHAVIORTREE_CPP, Node, library, node_in_libraries
from roaml.libraries.programs.assembly import reads_world
from roaml.mocks.likeness import needs_likeness
from roaml.mocks.mock import ALL, Mock, likeness_for, mock_for
from roaml.model.expand import (
    Expansion,
    Frame,
    Instance,
    Reference,
    TreeFileOutline,
    TreeUse,
    expand,
    main_tree,
    node_at,
    tree_called,
)
from roaml.model.kinds import FileKind
from roaml.model.system import System, builtin_plugins
from roaml.model.tree import EXPLICIT, TreeFile, TreeNode
from roaml.project.analysis import Analysis
from roaml.project.mock_files import mocks_beside
from roaml.roles import Direction
from roaml.text import Location
from roaml.views.tree import ports_of, title_of

AUTOREMAPPED = "_autoremap"
"""The line in the card of a subtree with automatic remapping: names that the `<SubTree>` does not set refer to the
entries of the surrounding tree."""
_KINDS: Mapping[str, DiagramNodeKind] = {
    "control": DiagramNodeKind.CONTROL,
    "decorator": DiagramNodeKind.DECORATOR,
    "action": DiagramNodeKind.ACTION,
    "condition": DiagramNodeKind.CONDITION,
}


def tree_picture(analysis: Analysis, path: str, mocks: Sequence[Mock] | None = None) -> Picture | None:
    """The diagram of the tree of a system, or of a tree file that belongs to no system; `None` if there is no tree, or
    if the tree is empty. If no tree of such a file is the main one, it is that of the first tree.

    Args:
        path: any file of the system, or the tree file.
        mocks: the mocks of leaves that are not described otherwise. `None`: those in the file beside a tree that
            belongs to no system.
    """
    system = next((owner for s in analysis.systems_of(path) if s and (owner := analysis.system(s))), None)
    if system is not None and (system.tree_paths or analysis.kind(path) is not FileKind.TREE):
        paths, instances, uses = system.tree_paths, system.instances, system.tree_uses
    else:
        paths = analysis.trees_from(path)
        expansion = _expanded(analysis.outlines_from(path))
        instances, uses = expansion.instances, expansion.uses
    if not paths or not instances:
        return None
    if mocks is None:
        mocks = mocks_beside(analysis, paths[0]) if system is None else ()
    drawn = _Tree(analysis, paths, instances, uses, system, mocks)
    title = paths[0].replace("\\", "/").rpartition("/")[2]
    return Picture(title, tuple(drawn.nodes()), tuple(drawn.edges()))


def _expanded(files: tuple[TreeFileOutline, ...]) -> Expansion:
    """The executed tree of files; of several trees none of which is the main one, the first of the first file."""
    if not isinstance(main_tree(files), tuple):
        return expand(files)
    first = (expand(files, tree) for file in files[:1] for tree in file.trees)
    return next((found for found in first if found.instances), Expansion())


class _Tree:
    def __init__(
        self,
        analysis: Analysis,
        paths: tuple[str, ...],
        instances: tuple[Instance, ...],
        uses: tuple[TreeUse, ...],
        system: System | None,
        mocks: Sequence[Mock],
    ) -> None:
        self.instances = instances
        self.uses = uses
        self.use_of = {instance.number: instance.use for instance in instances}
        self.system = system
        self.mocks = mocks
        self.events = [mock for mock in mocks if mock.pattern != ALL]
        self.files: dict[str, TreeFile] = {path: file for path in paths if (file := analysis.tree(path)) is not None}
        self.described = {model.id.value: model.kind for f in self.files.values() for model in f.models if model.id}
        of_system = None if system is None else system.path
        self.forests = {path: analysis.forest(path, of_system) for path in self.files}
        self.written = {instance.number: self.node(instance) for instance in instances}
        self.names: dict[tuple[str, str], set[str]] = {}
        for instance in instances:
            self.names.setdefault((instance.tree, instance.plugin), set()).add(instance.name)

    def node(self, instance: Instance) -> TreeNode | None:
        file = self.files.get(instance.source.path)
        return node_at(file, instance.source) if file else None

    def nodes(self) -> Iterator[DiagramNode]:
        for instance in self.instances:
            yield from map(self.subtree, self.entered(instance))
            node = self.written[instance.number]
            place = Location(instance.source.path, node.element.span) if node else None
            initial = instance.parent is None
            kind = self.kind(instance, node)
            details = (*_ports(instance), *self.mock(instance, kind))
            title = TreeNodeTitle(instance.name, instance.plugin, instance.number)
            yield DiagramNode(str(instance.number), kind, title_of(instance), details, "", initial, place, title)
        variables: dict[str, Location | None] = {}
        for instance, key, variable in self.bound():
            variables.setdefault(variable, self.place(instance, key))
        for variable, place in variables.items():
            yield DiagramNode(f"{{{variable}}}", DiagramNodeKind.VARIABLE, variable, place=place)

    def entered(self, instance: Instance) -> list[int]:
        """The indices of the subtrees that begin between a node and its parent, outermost first."""
        around = self.use_of[instance.parent] if instance.parent is not None else self.root_use(instance)
        entered: list[int] = []
        use: int | None = instance.use
        while use is not None and use != around and use < len(self.uses):
            entered.append(use)
            use = self.uses[use].outer
        return entered[::-1]

    def root_use(self, instance: Instance) -> int | None:
        """The use of the executed tree, which is not drawn if the system has only one tree."""
        if self.system is not None and len(self.system.roots) > 1:
            return None
        use = instance.use
        while use < len(self.uses) and (outer := self.uses[use].outer) is not None:
            use = outer
        return use

    def subtree(self, use: int) -> DiagramNode:
        """The node of the diagram for a subtree: the values that its `<SubTree>` sets, and its conditions and
        scripts."""
        name, tree = self.uses[use].name, self.uses[use].tree
        places = (
            Location(path, written.element.span)
            for path, file in self.files.items()
            if (written := tree_called(file, tree)) is not None
        )
        label = name if name == tree else f"{name} : {tree}"
        scripts = (
            Detail(DetailKind.SCRIPT, f"{attribute} = {text}", attribute) for attribute, text in self.uses[use].scripts
        )
        frame = self.uses[use].frame
        node = self.subtree_node(frame)
        return DiagramNode(
            f"subtree {use}",
            DiagramNodeKind.SUBTREE,
            label,
            (*self.given(node), *scripts),
            place=next(places, None),
            title=TreeNodeTitle(name, tree),
            use=Location(frame.use.path, node.element.span) if frame.use is not None and node else None,
        )

    def subtree_node(self, frame: Frame) -> TreeNode | None:
        """The `<SubTree>` of a frame; `None` for the executed tree."""
        file = self.files.get(frame.use.path) if frame.use is not None else None
        return node_at(file, frame.use) if file is not None and frame.use is not None else None

    def given(self, node: TreeNode | None) -> Iterator[Detail]:
        """The names and values that a `<SubTree>` sets, one line for each name."""
        if node is None:
            return
        for setting in node_ports(node):
            key, entry = setting.attribute.name, entry_of(setting)
            if entry is None:
                yield Detail(DetailKind.CONSTANT, f"{key} = {setting.value.value}", key)
            else:
                yield Detail(DetailKind.REFERENCE, f"{key} = {{{entry}}}", key)
        if is_autoremapped(node):
            yield Detail(DetailKind.SCRIPT, AUTOREMAPPED)

    def edges(self) -> Iterator[DiagramEdge]:
        for instance in self.instances:
            ends = [f"subtree {use}" for use in self.entered(instance)] + [str(instance.number)]
            if instance.parent is not None:
                ends.insert(0, str(instance.parent))
            yield from (DiagramEdge(above, below, EdgeKind.CHILD) for above, below in pairwise(ends))
        for instance, key, variable in self.bound():
            node, name = str(instance.number), f"{{{variable}}}"
            place = self.place(instance, key)
            direction = self.direction(instance, key)
            if direction.writes:
                yield DiagramEdge(node, name, EdgeKind.WRITES, (key,), place=place)
            if direction.reads:
                yield DiagramEdge(name, node, EdgeKind.READS, (key,), place=place)

    def bound(self) -> Iterator[tuple[Instance, str, str]]:
        """All ports that are bound to variables, as instance, key of the port, and name of the variable."""
        for instance in self.instances:
            for key, value in instance.ports:
                if isinstance(value, Reference):
                    yield instance, key, value.variable

    def place(self, instance: Instance, key: str) -> Location | None:
        """The place where the node sets a port; `None` if the port has its default value."""
        node = self.written[instance.number]
        setting = next((port for port in node.ports if port.key.value == key), None) if node else None
        return Location(instance.source.path, setting.attribute.span) if setting else None

    def direction(self, instance: Instance, key: str) -> Direction:
        """The direction of a port; `IN` if it is unknown."""
        outline = (
            self.system.plugin(instance.plugin, instance.tree)[1]
            if self.system
            else builtin_plugins().get(instance.plugin)
        )
        port = outline.port(key) if outline else None
        return port.direction if port else Direction.IN

    def kind(self, instance: Instance, node: TreeNode | None) -> DiagramNodeKind:
        written = node.element.name if node else ""
        described = self.described.get(instance.plugin, "") or self.declared(instance)
        if node is not None and node.type is not None and node.type.node and node.type.name not in EXPLICIT:
            word = node.type.node.value
        else:
            word = (written if written in EXPLICIT else described).lower()
        number = len(instance.children)
        unknown = (DiagramNodeKind.ACTION, DiagramNodeKind.DECORATOR)[number] if number < 2 else DiagramNodeKind.CONTROL
        return _KINDS.get(word, unknown)

    def declared(self, instance: Instance) -> str:
        """The kind of a node, if a library or a model declares it; otherwise ""."""
        node = self.declaration(instance)
        return node.kind.value if node is not None else ""

    def declaration(self, instance: Instance) -> Node | None:
        """The declaration of a node in a library or a model."""
        forest = self.forests.get(instance.source.path)
        known = forest.node(instance.plugin) if forest is not None else None
        return None if forest is None or known is None or forest.is_machine(known) else known

    def mock(self, instance: Instance, kind: DiagramNodeKind) -> Iterator[Detail]:
        """The line with the mock of a leaf, of a node that depends on an event of the world, or of a node with children
        that is executed like a node of a library."""
        if not self.mocks or (self.system is not None and self.system.plugin(instance.plugin, instance.tree)[0]):
            return
        known = self.declaration(instance) or node_in_libraries(instance.plugin)
        if reads_world(instance.plugin):
            event = mock_for(self.events, instance.name, instance.plugin, tree=instance.tree)
            if event is not None:
                yield Detail(DetailKind.MOCK, f"mock: event {event.behaviour(is_instant=True)}")
            return
        if instance.children:
            like = self.likeness(instance)
            if like is not None:
                yield Detail(DetailKind.MOCK, f"mock: {like.behaviour()}")
            return
        if instance.plugin in library(BEHAVIORTREE_CPP).nodes:
            return
        succeeds = known is not None and known.succeeds
        # In a system, all nodes of a type in a tree have one plugin.
        is_shared = self.system is not None and len(self.names[instance.tree, instance.plugin]) > 1
        name = instance.plugin if is_shared else instance.name
        mock = mock_for(self.mocks, name, instance.plugin, succeeds, instance.tree)
        if mock is not None:
            is_instant = kind is DiagramNodeKind.CONDITION or (known is not None and known.is_synchronous)
            yield Detail(DetailKind.MOCK, f"mock: {mock.behaviour(is_instant=is_instant)}")

    def likeness(self, instance: Instance) -> Mock | None:
        """The mock that declares like which node of a library a node with children is executed."""
        forest, node = self.forests.get(instance.source.path), self.written[instance.number]
        if self.system is not None or forest is None or node is None or not needs_likeness(forest, node):
            return None
        return likeness_for(self.mocks, instance.name, instance.plugin)


def _ports(instance: Instance) -> Iterator[Detail]:
    scripts = dict(instance.scripts)
    for key, text in ports_of(instance):
        if key in scripts:
            kind = DetailKind.SCRIPT
        else:
            kind = DetailKind.REFERENCE if isinstance(instance.port(key), Reference) else DetailKind.CONSTANT
        yield Detail(kind, text, key)
