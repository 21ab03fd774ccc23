# SPDX-License-Identifier: Apache-2.0
"""Rules on the structure of the code: no import cycles, one module that depends on pygls, no
chains of classes."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from roaml.smc.assemble import ExpressionAssembler
from roaml.smc.assign import AssignmentAssembler
from roaml.smc.cells import CellAssembler
from roaml.smc.operations import OperatorAssembler

SERVER = Path(__file__).resolve().parents[1] / "server"


def modules_below(folder: Path) -> dict[str, Path]:
    """Name -> file of the modules in a folder of the server."""
    return {
        ".".join(path.relative_to(SERVER).with_suffix("").parts).removesuffix(".__init__"): path
        for path in sorted(folder.rglob("*.py"))
        if "templates" not in path.parts
    }


MODULES = modules_below(SERVER / "as2fm_lsp")
TRANSPORT = "as2fm_lsp.transport"
PUBLIC_OF_PYGLS = ("pygls.exceptions", "pygls.uris")
"""Modules with plain values and functions, which every module may import."""


def imported(text: str, known: Mapping[str, object]) -> Iterator[str]:
    """The modules that a module imports: at its start, in its functions, and only for the type checker."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from (name if name in known else node.module for name in names)


def circles(graph: Mapping[str, set[str]]) -> list[set[str]]:
    """The strongly connected components with more than one module, by Tarjan's algorithm."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    components = []

    def visit(module: str) -> None:
        index[module] = low[module] = len(index)
        stack.append(module)
        for other in sorted(graph[module]):
            if other not in index:
                visit(other)
                low[module] = min(low[module], low[other])
            elif other in stack:
                low[module] = min(low[module], index[other])
        if low[module] == index[module]:
            at = stack.index(module)
            components.append(set(stack[at:]))
            del stack[at:]

    for module in graph:
        if module not in index:
            visit(module)
    return [component for component in components if len(component) > 1]


def graph_of(texts: Mapping[str, str]) -> dict[str, set[str]]:
    return {name: {other for other in imported(text, texts) if other in texts} - {name} for name, text in texts.items()}


def test_circles_are_seen() -> None:
    """Cycles of imports for the type checker are also detected."""
    texts = {
        "a.x": "from a import y",
        "a.y": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from a.z import Z",
        "a.z": "def f():\n    import a.x",
        "a.w": "import a.x",
    }
    assert circles(graph_of(texts)) == [{"a.x", "a.y", "a.z"}]


def test_there_is_no_circle() -> None:
    modules = modules_below(SERVER)
    assert circles(graph_of({name: path.read_text(encoding="utf-8") for name, path in modules.items()})) == []


@pytest.mark.parametrize("name", [name for name in MODULES if name != TRANSPORT])
def test_only_the_transport_knows_what_is_private_in_pygls(name: str) -> None:
    text = MODULES[name].read_text(encoding="utf-8")
    assert [m for m in imported(text, {}) if m.partition(".")[0] == "pygls" and not known_to_all(m)] == []
    if "cli" not in name:  # the command line knows no pygls, and argparse has names of this kind
        assert list(private(text)) == []


def known_to_all(module: str) -> bool:
    return module in PUBLIC_OF_PYGLS or module == "pygls"


def private(text: str) -> Iterator[str]:
    """Private names that are used outside their class, except those of `os` and of named tuples."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Attribute) and node.attr.startswith("_") and not node.attr.startswith("__"):
            owner = ast.unparse(node.value)
            if owner not in ("self", "cls") and (owner, node.attr) != ("os", "_exit") and node.attr != "_replace":
                yield f"{owner}.{node.attr}"


def test_private_names_are_seen() -> None:
    assert list(private("server.protocol._send_data(self._x, a._replace(b=1))")) == ["server.protocol._send_data"]


def test_assemblers_hold_each_other() -> None:
    """The parts of the compiler contain each other and write to one tape; they do not inherit from each other."""
    for kind in (AssignmentAssembler, ExpressionAssembler, OperatorAssembler, CellAssembler):
        assert kind.__bases__ == (object,)
