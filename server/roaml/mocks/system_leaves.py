# SPDX-License-Identifier: Apache-2.0
"""The leaves of a system's trees that have no plugin, with the ports that their mocks need
(docs/spec/mocks.md#systems)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import TypeAlias

from roaml.expr.types import BASE_TYPES, type_of_text
from roaml.forest.forest import port_type
from roaml.libraries import Node, node_in_libraries
from roaml.mocks.plugin import MockPort
from roaml.model.expand import Instance, PortConstant, Reference
from roaml.model.system import System
from roaml.record import Record, field
from roaml.scxml.names import safe_name

OPAQUE = "int32"
"""The HL-SCXML type of a port whose C++ type has no equivalent in HL-SCXML and that the tree sets to no constant."""
_VALUES = {"bool": ("false", "true"), "string": ("''",), "float64": ("0.0", "1.0")}
_TYPES = {"double": "float64", "float": "float32", "bool": "bool", "string": "string", "int": "int32",
          "unsigned": "uint32"}  # fmt: skip


class SystemLeaf(Record, frozen=True):
    """A type of leaves without a plugin.

    Attributes:
        names: the name of each tree that has no plugin for the type, with the names of its nodes; a node without a name
            has the name of the type.
        is_shared: whether a plugin for it belongs to all trees, because none has one.
        is_condition: whether the leaves never return RUNNING.
        succeeds: whether a declaration states that the leaves always succeed.
        ports: all ports that nodes of the type set.
        optional: the ports that some of the nodes do not set.
    """

    type: str
    names: tuple[tuple[str, tuple[str, ...]], ...]
    is_shared: bool
    is_condition: bool
    succeeds: bool
    ports: tuple[MockPort, ...]
    optional: frozenset[str]

    @property
    def trees(self) -> frozenset[str]:
        return frozenset(tree for tree, _ in self.names)


_Slot: TypeAlias = tuple[str, str]
"""(type of nodes, port) for a port, or ("", variable) for a variable of the blackboard."""


def leaves_without_plugins(system: System, declared: Callable[[str], Node | None]) -> tuple[SystemLeaf, ...]:
    """The types of leaves without a plugin, in the order of the trees, except types whose names are not valid names of
    machines.

    Args:
        declared: returns the declaration of a type of nodes in `<TreeNodesModel>`; `None` if there is none.
    """
    by_type: dict[str, list[Instance]] = {}
    for instance in system.instances:
        if system.plugin(instance.plugin, instance.tree)[1] is None and safe_name(instance.plugin) == instance.plugin:
            by_type.setdefault(instance.plugin, []).append(instance)
    leaves = {name: nodes for name, nodes in by_type.items() if not any(node.children for node in nodes)}
    known = {name: declared(name) or node_in_libraries(name) for name in leaves}
    types = _Types(system, leaves, known)
    return tuple(
        SystemLeaf(
            name,
            _names(nodes),
            all(outline.name != name for _, outline in system.plugins),
            _is_condition(nodes, known[name]),
            bool((declaration := known[name]) and declaration.succeeds),
            tuple(types.ports(name)),
            frozenset(key for node in nodes for key, _ in node.ports if not all(other.port(key) for other in nodes)),
        )
        for name, nodes in leaves.items()
    )


def _names(nodes: Iterable[Instance]) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """The names of trees, each with the names of its nodes among `nodes`."""
    names: dict[str, dict[str, None]] = {}
    for node in nodes:
        names.setdefault(node.tree, {})[node.name] = None
    return tuple((tree, tuple(own)) for tree, own in names.items())


def _is_condition(nodes: list[Instance], known: Node | None) -> bool:
    return bool(known and known.is_synchronous) or all(node.condition for node in nodes)


class _Types(Record, dict=True):
    """Finds the types of ports: all ports that are bound to one variable have the same type."""

    system: System
    leaves: Mapping[str, list[Instance]]
    known: Mapping[str, Node | None]
    parents: dict[_Slot, _Slot] = field(default_factory=dict)

    def __post_init__(self) -> None:
        slots: dict[_Slot, list[str]] = {}
        for name, nodes in self.leaves.items():
            for key, value in (setting for node in nodes for setting in node.ports):
                slot = (name, key)
                slots.setdefault(slot, [])
                if isinstance(value, Reference):
                    self.join(slot, ("", value.variable))
                    slots.setdefault(("", value.variable), [])
                elif isinstance(value, PortConstant):
                    slots[slot].append(type_of_text(value.text))
        ranks: dict[_Slot, list[tuple[int, str]]] = {}
        for slot, literals in slots.items():
            ranks.setdefault(self.top(slot), []).extend(self.candidates(slot, literals))
        self.types = {top: min(ranked)[1] for top, ranked in ranks.items() if ranked}

    def candidates(self, slot: _Slot, literals: list[str]) -> Iterator[tuple[int, str]]:
        """Possible types of a slot, each with its rank: plugins first, then declarations, then constants."""
        owner, key = slot
        if not owner:
            if any(bound.port.type in BASE_TYPES for bound in self.system.blackboard.get(key, ())):
                yield 0, self.system.variable_type(key)
            return
        known = self.known[owner]
        port = known.port(key) if known is not None else None
        declared = _simple(port_type(port)) if port is not None else None
        if declared is not None:
            yield 1, declared
        elif port is not None and port_type(port) != "any":
            yield 3, OPAQUE
        if literals:
            yield 2, literals[0] if len(set(literals)) == 1 else "string"

    def ports(self, name: str) -> Iterator[MockPort]:
        known = self.known[name]
        keys = dict.fromkeys(key for node in self.leaves[name] for key, _ in node.ports)
        for key in keys:
            port = known.port(key) if known is not None else None
            type_ = self.types.get(self.top((name, key)), "int32")
            bound = [value for node in self.leaves[name] for own, value in node.ports if own == key]
            is_output = port.direction.writes if port is not None else self.is_written(bound)
            variables = [value.variable for value in bound if isinstance(value, Reference)]
            if len(variables) < len(bound):
                is_output = False  # a constant can be given to an input only
            elif not is_output and not all(map(self.has_writer, variables)):
                # The program that runs the tree sets the entry. Mocks read nothing, so any value is valid.
                yield MockPort(key, type_, is_output=True, values=_values(type_)[:1])
                continue
            yield MockPort(key, type_, is_output, _values(type_) if is_output else ())

    def is_written(self, bound: list[PortConstant | Reference]) -> bool:
        """Whether a port that no model describes is treated as an output, because nothing else writes its variable."""
        variables = [value.variable for value in bound if isinstance(value, Reference)]
        return bool(variables) and not any(map(self.has_writer, variables))

    def has_writer(self, variable: str) -> bool:
        """Whether the tree or a leaf writes a variable."""
        return variable in self.written or self.system.writes_variable(variable)

    @cached_property
    def written(self) -> frozenset[str]:
        """The variables that leaves write, as far as their ports are declared."""
        variables = set()
        for name, nodes in self.leaves.items():
            known = self.known[name]
            for key, value in (setting for node in nodes for setting in node.ports):
                port = known.port(key) if known is not None else None
                if isinstance(value, Reference) and port is not None and port.direction.writes:
                    variables.add(value.variable)
        return frozenset(variables)

    def join(self, left: _Slot, right: _Slot) -> None:
        first, second = self.top(left), self.top(right)
        if first != second:
            self.parents[first] = second

    def top(self, slot: _Slot) -> _Slot:
        while slot in self.parents:
            slot = self.parents[slot]
        return slot


def _simple(type_: str) -> str | None:
    """The HL-SCXML type for the normalised name of a C++ type; `None` if there is none."""
    if type_ in _TYPES:
        return _TYPES[type_]
    return type_ if type_ in BASE_TYPES else None


def _values(type_: str) -> tuple[str, ...]:
    return _VALUES.get(type_, ("0.0", "1.0") if type_.startswith("float") else ("0", "1"))
