# SPDX-License-Identifier: Apache-2.0
"""A file of behavior trees as typed data (docs/spec/trees.md): its content before subtrees are expanded."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cached_property

from roaml.expr.words import RESERVED
from roaml.language import BEHAVIOR_TREE, ElementType
from roaml.model.syntax import Name, name_of
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import Direction, ValueRole
from roaml.suggest import are_similar
from roaml.xml_syntax import Attribute, Document, Element, Text

EXPLICIT = ("Action", "Condition", "Control", "Decorator")
SUBTREES = ("SubTree", "SubTreePlus")

_REFERENCE = regex(r"\s*\{(.*)\}\s*\Z", re.DOTALL)
_VARIABLE = regex(r"@?[A-Za-z_$][\w$]*\Z", re.ASCII)
_BEGINS_LIKE_REFERENCE = regex(r"\s*\{.+\}", re.DOTALL)


class PortSetting(Record, frozen=True, eq=False):
    """An attribute of a node that sets a port. `key` is the main name of the port, even if an alias of it is
    written."""

    attribute: Attribute
    key: Name
    value: Name

    @property
    def variable(self) -> str | None:
        """The name of the blackboard variable to which the value refers; `None` if the value is a constant."""
        return blackboard_variable(self.value.value)


class TreeNode(Record, frozen=True, eq=False):
    """A node of a tree.

    Attributes:
        plugin: the name of its plugin, from `ID` or, in the compact form, from the tag.
        is_subtree: whether it represents the tree named `plugin`.
        type: the grammar of the node if it is a node of BehaviorTree.CPP.
        scripts: the attributes that contain scripts, such as pre- and post-conditions.
        compact: whether it is written as `<X/>` instead of `<Action ID="X"/>`.
    """

    element: Element
    plugin: Name | None
    name: Name | None
    is_subtree: bool
    type: ElementType | None
    ports: tuple[PortSetting, ...]
    scripts: tuple[Attribute, ...]
    children: tuple[TreeNode, ...]
    compact: bool

    @property
    def type_name(self) -> str:
        """The name of the plugin or tree; of a node without one, that of its element."""
        return self.plugin.value if self.plugin is not None else self.element.name


class Tree(Record, frozen=True, eq=False):
    """A `<BehaviorTree>`; `roots` contains one node unless the file is invalid."""

    element: Element
    id: Name | None
    roots: tuple[TreeNode, ...]


class PortModel(Record, frozen=True, eq=False):
    """A port in `<TreeNodesModel>`.

    Attributes:
        default: the default value; `None` if there is none.
        type: the C++ type; "" if it is not given.
        text: the description; "" if there is none.
    """

    element: Element
    name: Name | None
    direction: Direction
    default: str | None
    type: str = ""
    text: str = ""


class NodeModel(Record, frozen=True, eq=False):
    element: Element
    id: Name | None
    kind: str
    ports: tuple[PortModel, ...]
    text: str = ""

    @property
    def is_subtree(self) -> bool:
        return self.kind == "SubTree"

    @property
    def is_condition(self) -> bool:
        return self.kind == "Condition"


class Include(Record, frozen=True, eq=False):
    element: Element
    path: Name | None
    package: Name | None


class TreeFile(Record, frozen=True, eq=False, dict=True):
    """A file of trees.

    Attributes:
        format: the value of `BTCPP_format`; "" if it is not given.
        main: the value of `main_tree_to_execute`.
        models: the nodes in `<TreeNodesModel>`.
    """

    element: Element
    format: str
    main: Name | None
    trees: tuple[Tree, ...]
    models: tuple[NodeModel, ...]
    includes: tuple[Include, ...]

    @cached_property
    def nodes_by_tree(self) -> Mapping[str, tuple[TreeNode, ...]]:
        """ID of a tree -> its nodes, parents before children. If IDs are equal, the first tree is used."""
        return {tree.id.value if tree.id else "": tuple(nodes(tree)) for tree in reversed(self.trees)}


def build_tree_file(document: Document) -> TreeFile | None:
    """The trees in `document`; `None` if its root is not `<root>`."""
    root = document.root
    if root is None or root.name not in BEHAVIOR_TREE.roots:
        return None
    version = root.get("BTCPP_format")
    return TreeFile(
        root,
        version.value.strip() if version else "",
        name_of(root.get("main_tree_to_execute")),
        tuple(
            Tree(child, name_of(child.get("ID")), tuple(_node(node) for node in child.elements))
            for child in root.elements
            if child.name == "BehaviorTree"
        ),
        tuple(_model(model) for child in root.elements if _is_list_of_models(child) for model in child.elements),
        tuple(
            Include(child, name_of(child.get("path")), name_of(child.get("ros_pkg")))
            for child in root.elements
            if child.name == "include"
        ),
    )


def _is_list_of_models(element: Element) -> bool:
    """Whether an element is a `<TreeNodesModel>`, including misspelled names."""
    if element.name == "TreeNodesModel":
        return True
    return element.name not in BEHAVIOR_TREE.elements and are_similar(element.name, "TreeNodesModel")


def _node(element: Element) -> TreeNode:
    explicit = element.name in EXPLICIT
    is_subtree = element.name in SUBTREES
    type_ = None if explicit else BEHAVIOR_TREE.elements.get(element.name)
    plugin = name_of(element.get("ID")) if explicit or is_subtree else Name(element.name, element.name_span)
    if explicit and plugin is not None:
        type_ = BEHAVIOR_TREE.elements.get(plugin.value)
    known = (type_ or BEHAVIOR_TREE.elements["Action"]).attributes
    ports, scripts = [], []
    for attribute in element.attributes:
        name = attribute.name
        if name in known and known[name].value is ValueRole.SCRIPT:
            scripts.append(attribute)
        elif not _is_port(name, explicit or is_subtree):
            continue
        elif name not in known or known[name].port:
            value = Name(attribute.value, attribute.value_span)
            key = Name(port_key(plugin.value if plugin else "", name), attribute.name_span)
            ports.append(PortSetting(attribute, key, value))
    return TreeNode(
        element,
        plugin,
        name_of(element.get("name")),
        is_subtree,
        type_,
        tuple(ports),
        tuple(scripts),
        tuple(_node(child) for child in element.elements),
        not explicit and not is_subtree,
    )


def _is_port(name: str, has_id: bool) -> bool:
    """Whether an attribute can set a port. Attributes that every node may have, and attributes with a namespace,
    cannot."""
    return name != "name" and not (has_id and name == "ID") and name != "xmlns" and ":" not in name


def port_key(plugin: str, name: str) -> str:
    """The main name of the port of a plugin that `name` refers to. Ports of nodes of BehaviorTree.CPP may have an
    alias."""
    type_ = BEHAVIOR_TREE.elements.get(plugin)
    return type_.port_key(name) if type_ else name


_DIRECTIONS = {"input": Direction.IN, "output": Direction.OUT}
"""Beginning of the name of a port element -> its direction. Other names are misspelled, or `<inout_port>`."""


def _model(element: Element) -> NodeModel:
    id_ = name_of(element.get("ID"))
    ports = []
    for child in element.elements:
        prefix, _, kind = child.name.partition("_")
        if kind == "port":
            direction, default = _DIRECTIONS.get(prefix, Direction.INOUT), child.get("default")
            name = name_of(child.get("name"))
            if name and id_:
                name = Name(port_key(id_.value, name.value), name.span)
            type_, text = child.get("type"), _remark(child)
            value = default.value if default else None
            ports.append(PortModel(child, name, direction, value, type_.value if type_ else "", text))
    description = element.find("description")
    return NodeModel(element, id_, element.name, tuple(ports), _remark(description) if description else "")


def _remark(element: Element) -> str:
    """The description of a part of a model, from an attribute or its text."""
    description = element.get("description")
    text = description.value if description else "".join(n.value for n in element.nodes if isinstance(n, Text))
    return " ".join(text.split())


def nodes(tree: Tree) -> Iterator[TreeNode]:
    """All nodes of a tree, parents before children."""
    stack = list(reversed(tree.roots))
    while stack:
        node = stack.pop()
        yield node
        stack.extend(reversed(node.children))


def blackboard_variable(value: str) -> str | None:
    """The name of the variable in a value of the form `{name}`; `None` if the value is a constant. The name may be
    invalid."""
    match = _REFERENCE.match(value)
    return match[1].strip() if match else None


def is_variable_name(name: str) -> bool:
    """Whether `name` is a valid name of a blackboard variable. A leading `@` refers to the blackboard of the executed
    tree."""
    return bool(_VARIABLE.match(name)) and not is_reserved_variable(name)


def is_reserved_variable(name: str) -> bool:
    """Whether the name of a blackboard variable is a reserved word of ECMAScript."""
    return name.removeprefix("@") in RESERVED


def looks_like_reference(value: str) -> bool:
    """Whether a value begins with `{…}`. The reference translator reads such a value as a reference
    (docs/spec/trees.md#port-values)."""
    return bool(_BEGINS_LIKE_REFERENCE.match(value))
