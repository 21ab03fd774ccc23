# SPDX-License-Identifier: Apache-2.0
"""The version of BehaviorTree.CPP, 3 or 4, for which files of trees are written (docs/spec/lone-trees.md#format).

A program reads all files that include each other with the same version. So a file that does not show its version is
written for the version that the other files show.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.libraries import BEHAVIORTREE_CPP, library
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS, script_ports
from roaml.model.tree import TreeFile, TreeNode, nodes
from roaml.record import Record

VERSION_3 = "3"
"""The value of `BTCPP_format` for version 3."""
_CPP = library(BEHAVIORTREE_CPP)
OLD_ATTRIBUTES = ("__autoremap", "__shared_blackboard")
_OLD_TAGS = (
    *("SubTreePlus", *_CPP.renamed, *(name for name, node in _CPP.nodes.items() if node.until)),
    *(name for name in _CPP.absent if name.startswith("BlackboardCheck") or name == "ManualSelector"),
)


class Signs(Record, frozen=True):
    """What shows the version of a file.

    Attributes:
        format: the value of `BTCPP_format`; "" if it is not given.
        old: the first name of a node or attribute that only version 3 has; "" if there is none.
        new: the first name of a node or attribute that only version 4 has; "" if there is none.
    """

    format: str
    old: str = ""
    new: str = ""

    @property
    def is_version_3(self) -> bool | None:
        """Whether the file is written for version 3; `None` if the file alone does not show it."""
        if self.format:
            return self.format == VERSION_3
        return True if self.old else False if self.new else None


def signs_of(file: TreeFile) -> Signs:
    """What shows the version of a file."""
    inside = tuple(node for tree in file.trees for node in nodes(tree))
    old = next((name for node in inside for name in _old_names(node)), "")
    return Signs(file.format, old, next((name for node in inside for name in _new_names(node)), ""))


def files_of_version_3(signs: Mapping[str, Signs]) -> frozenset[str]:
    """The files that are written for version 3.

    Args:
        signs: path -> what shows the version, for files that are read together.
    """
    stated = {each.format for each in signs.values() if each.format}
    common = stated == {VERSION_3} if stated else any(each.old for each in signs.values())
    own = {path: each.is_version_3 for path, each in signs.items()}
    return frozenset(path for path, is_old in own.items() if (common if is_old is None else is_old))


def _old_names(node: TreeNode) -> Iterator[str]:
    """The names in a node that only version 3 has."""
    name = node.plugin.value if node.plugin else ""
    if name == "Parallel":
        yield from _thresholds(node, of_version_3=True)
    elif node.element.name in _OLD_TAGS:
        yield node.element.name
    elif not node.compact and not node.is_subtree and name in _OLD_TAGS:
        yield name
    if node.is_subtree:
        yield from (attribute for attribute in OLD_ATTRIBUTES if node.element.get(attribute))


def _new_names(node: TreeNode) -> Iterator[str]:
    """The names in a node that only version 4 has, as far as they change what version 3 would execute."""
    name = node.plugin.value if node.plugin else ""
    if name == "Parallel":
        yield from _thresholds(node, of_version_3=False)
    elif name in script_ports():
        yield name
    yield from (attribute for attribute in (*CONDITIONS, *AFTERWARDS) if node.element.get(attribute))


def _thresholds(node: TreeNode, *, of_version_3: bool) -> Iterator[str]:
    """The ports of a `Parallel` that are set and have a name that only one version has."""
    for attribute in node.element.attributes:
        port = _CPP.nodes["Parallel"].port(attribute.name)
        if port is not None and bool(port.alias_of) is of_version_3:
            yield attribute.name
