# SPDX-License-Identifier: Apache-2.0
"""Creates a plugin for a node without a plugin. The new file is listed in all systems of the tree that contains the
node."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from roaml.expr.types import type_of_text
from roaml.ide.code_actions import new_file
from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.ide.code_actions.inputs import add_input
from roaml.model.system import System
from roaml.model.system_file import SystemSection
from roaml.model.tree import PortSetting, TreeNode
from roaml.project.analysis import Analysis
from roaml.project.paths import folder_of, name_of
from roaml.roles import Direction
from roaml.scxml.names import safe_name


def skeletons(analysis: Analysis, path: str, node: TreeNode) -> Iterator[tuple[str, Callable[[], WorkspaceEdit]]]:
    """The title and the change of the action that creates a plugin for a node. There is no action for a node with
    several children, because the generated plugin could not tick them."""
    systems = analysis.memberships.get(path, ())
    if (
        not systems
        or node.plugin is None
        or len(node.children) > 1
        or safe_name(node.plugin.value) != node.plugin.value
    ):
        return
    name = node.plugin.value
    target = free_path(analysis, systems[0], name)
    yield (
        f"Create the plugin `{name}` in `{name_of(target)}`",
        lambda: _create(analysis, systems, node, target),
    )


def free_path(analysis: Analysis, system: str, name: str) -> str:
    """A path for a new plugin in the folder of the first plugin of the system; in the folder of the system file if the
    system has no plugins."""
    plugins = [
        f.path
        for f in analysis.listed(system)
        if f.input.section is SystemSection.BEHAVIOR_TREE and f.path.endswith("cxml")
    ]
    folder = folder_of(plugins[0] if plugins else system)
    return new_file.free_path(analysis, folder, new_file.file_name(name))


def _create(analysis: Analysis, systems: tuple[str, ...], node: TreeNode, target: str) -> WorkspaceEdit:
    assert node.plugin is not None
    linked = analysis.system(systems[0])
    ports = [(*port_of(linked, setting),) for setting in node.ports]
    text = new_file.plugin(node.plugin.value, ports, child=bool(node.children))
    edits = {s: add_input(analysis, s, SystemSection.BEHAVIOR_TREE, "bt-plugin-ascxml", target) for s in systems}
    return WorkspaceEdit({s: changes for s, changes in edits.items() if changes}, {target: text})


def port_of(system: System | None, setting: PortSetting) -> tuple[Direction, str, str]:
    """The probable direction, key and type of a port that a node sets. A port with a constant, or with a variable that
    another node writes, is an input; a port with any other variable is an output."""
    variable = setting.variable
    if variable is None:
        return Direction.IN, setting.key.value, type_of_text(setting.value.value)
    bound = system.blackboard.get(variable.removeprefix("@"), ()) if system else ()
    types = [use.port.type for use in bound if use.port.type != "any"]
    direction = Direction.IN if any(use.port.written for use in bound) else Direction.OUT
    return direction, setting.key.value, types[0] if types else "int32"
