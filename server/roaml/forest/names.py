# SPDX-License-Identifier: Apache-2.0
"""The names of entries in the attributes of nodes (docs/spec/lone-trees.md#entries); names that read as conditions."""

from __future__ import annotations

import re

from roaml.forest.forest import Forest
from roaml.forest.written_for import OLD_ATTRIBUTES
from roaml.model.tree import PortSetting, TreeNode, blackboard_variable
from roaml.regex import regex

_TRUE = ("1", "true", "True", "TRUE")
NAME = regex(r"@?[A-Za-z_][\w.:-]*\Z", re.ASCII)
"""Matches the names of entries."""
READS_AS_CONDITION = regex(r"(Is|Has|Are|Can)[A-Z_0-9]|(is|has|are|can)_")
"""Matches the beginning of the name of a node that reads as a condition."""


def entry_of(setting: PortSetting) -> str | None:
    """The name of the entry that a port is bound to; `None` if its value is a constant. `{=}` and `=` refer to the
    entry with the name of the port."""
    return entry_named(setting.attribute.name, setting.value.value)


def entry_named(port: str, text: str) -> str | None:
    """The name of the entry to which the value `text` of a port refers; `None` if it is a constant."""
    value = text.strip()
    if value == "=":
        return port
    name = blackboard_variable(value)
    return port if name == "=" else name or None


def is_autoremapped(node: TreeNode, *, version_3: bool = False) -> bool:
    """Whether a `<SubTree>` binds all entries that are not set. `version_3`: whether its file is of version 3."""
    names = ("_autoremap", *OLD_ATTRIBUTES) if version_3 else ("_autoremap",)
    given = (node.element.get(name) for name in names)
    return any(attribute is not None and attribute.value.strip() in _TRUE for attribute in given)


def bound_entry(forest: Forest, node: TreeNode, setting: PortSetting) -> str | None:
    """The name of the entry that an attribute of a subtree is bound to; `None` if it is a constant. In a file of
    version 3, the values of a `SubTree` are names of entries without braces."""
    name = setting.value.value.strip()
    is_name = forest.is_of_version_3(node) and node.element.name == "SubTree" and NAME.match(name)
    return name if is_name else entry_of(setting)
