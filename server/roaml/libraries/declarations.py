# SPDX-License-Identifier: Apache-2.0
"""Reads the declarations of the libraries, for `docs/build.py`, which writes them as tables."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from lxml import etree

from roaml.libraries.node import Absent, FormerPort, Library, Node, Port, PortLimits, Renamed
from roaml.roles import UNBOUNDED, Direction, NodeKind


def read_library(name: str) -> Library:
    """The library that `NAME.xml` of this package declares."""
    root: Any = etree.parse(str(Path(__file__).parent / f"{name}.xml")).getroot()
    nodes: dict[str, Node] = {}
    renamed: dict[str, Renamed] = {}
    absent: dict[str, Absent] = {}
    needs_ports = root.get("needs-ports") == "true"
    groups = {group.get("id"): tuple(_ports(group, needs_ports)) for group in root.iterchildren("ports")}
    for element in root.iterchildren("control", "decorator", "action", "condition"):
        ports = (*_ports(element, needs_ports), *groups.get(element.get("use"), ()))
        node = _node(element, ports, root.get("name"))
        nodes[node.name] = node
    for element in root.iterchildren("renamed"):
        renamed[element.get("id")] = Renamed(element.get("id"), element.get("to"))
    for element in root.iterchildren("absent"):
        name, kind = element.get("id"), NodeKind(element.get("kind"))
        hint = element.get("not-translated", "")
        absent[name] = Absent(name, kind, _text(element), element.get("instead", ""), hint)
    entries = tuple(sorted(element.get("name") for element in root.iterchildren("entry")))
    foreign = {element.get("id"): element.get("to") for element in root.iterchildren("foreign")}
    return Library(root.get("name"), root.get("version"), nodes, renamed, absent, entries, foreign)


def _node(element: Any, ports: tuple[Port, ...], library_name: str) -> Node:
    kind = NodeKind(element.tag)
    running = element.get("running")
    return Node(
        element.get("id"),
        kind,
        ports,
        _children(element.get("children")) or kind.children,
        _text(element),
        library_name,
        element.get("since", ""),
        element.get("until", ""),
        None if running is None else running == "true",
        element.get("program-only") == "true",
        element.get("in-systems", ""),
        element.get("succeeds") == "true",
        library_name,
        tuple(
            FormerPort(port.get("name"), port.get("release"), port.get("now", ""))
            for port in element.iterchildren("former")
        ),
    )


def _ports(element: Any, needs_ports: bool) -> Iterator[Port]:
    """The ports in an element. If `needs_ports`, they are needed unless they have a default, or are only written."""
    for port in element.iterchildren("in", "out", "inout"):
        has_value = port.get("default") is not None or port.get("alias-of") is not None or port.tag == "out"
        yield _port(port, port.get("required") == "true" or (needs_ports and not has_value))


def _port(element: Any, required: bool) -> Port:
    return Port(
        element.get("name"),
        Direction(element.tag),
        element.get("type"),
        element.get("default"),
        required,
        _text(element),
        element.get("alias-of", ""),
        element.get("system-type", ""),
        Direction(direction) if (direction := element.get("system-direction")) else None,
        element.get("system-constant") == "true",
        _limits(element),
        element.get("names-entry") == "true",
        tuple(element.get("written-by", "").split()),
    )


_LIMITS = ("min", "above", "counts-children", "at-most", "less-than", "magnitude", "distance")
"""The attributes of ports that limit numbers."""


def _limits(element: Any) -> PortLimits | None:
    if not any(element.get(attribute) for attribute in _LIMITS):
        return None
    minimum = element.get("min", element.get("above"))
    return PortLimits(
        None if minimum is None else float(minimum),
        element.get("above") is not None,
        frozenset(map(float, element.get("special", "").split())),
        element.get("counts-children") == "true",
        element.get("at-most", ""),
        element.get("less-than", ""),
        None if (magnitude := element.get("magnitude")) is None else float(magnitude),
        element.get("distance", ""),
        element.get("speed", ""),
        element.get("effect", ""),
    )


def _children(text: str | None) -> tuple[int, int] | None:
    """The minimum and maximum number of children in a text such as `2`, `2-3` or `2-`, which means at least two."""
    if text is None:
        return None
    least, dash, most = text.partition("-")
    return int(least), int(most) if most else UNBOUNDED if dash else int(least)


def _text(element: Any) -> str:
    return " ".join((element.text or "").split())
