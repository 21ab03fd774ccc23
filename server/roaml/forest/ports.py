# SPDX-License-Identifier: Apache-2.0
"""The ports that the attributes of a node set, and the ports that misspelled attributes are probably intended to
set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.libraries import Node, Port
from roaml.model.tree import PortSetting, TreeNode
from roaml.suggest import close_names


def ports_of(node: TreeNode) -> Iterator[PortSetting]:
    """The attributes of a node that set ports, without those that begin with `_`, which BehaviorTree.CPP reserves."""
    return (setting for setting in node.ports if not setting.attribute.name.startswith("_"))


def unknown_names(node: TreeNode, known: Node) -> list[str]:
    """The names of the attributes of a node that do not set any of its ports, including those that use the alias of a
    port."""
    names = (setting.attribute.name for setting in ports_of(node))
    return [name for name in names if (port := known.port(name)) is None or port.alias_of]


def missing_ports(node: TreeNode, known: Node) -> list[Port]:
    """The required ports that the attributes of a node do not set."""
    return [port for port in known.ports if port.required and node.element.get(port.name) is None]


def probable_ports(node: TreeNode, known: Node) -> Mapping[str, tuple[str, ...]]:
    """The unknown attributes of a node, each with the names of the ports that it is probably intended to set, the most
    probable first. These are the port with this alias, the ports with similar names, or the only required port that is
    not set."""
    unknown = unknown_names(node, known)
    if not unknown:
        return {}
    free = [port.name for port in known.ports if not port.alias_of and node.element.get(port.name) is None]
    probable: dict[str, tuple[str, ...]] = {}
    for name in unknown:
        alias = known.port(name)
        probable[name] = (alias.alias_of,) if alias and alias.alias_of in free else close_names(name, free)
    similar = {name for names in probable.values() for name in names}
    rest = [port.name for port in missing_ports(node, known) if port.name not in similar]
    unlike = [name for name in unknown if not probable[name]]
    if len(rest) == len(unlike) == 1:
        probable[unlike[0]] = (rest[0],)
    return probable
