# SPDX-License-Identifier: Apache-2.0
"""Diagrams as text for DOT (Graphviz), Mermaid and PlantUML."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator

from roaml.record import Record
from roaml.views.graph import Graph, GraphNode, Kind


class Notation(Record, frozen=True):
    """A language for diagrams: its name in programs, its name for users, the extension of its files, and its writer."""

    name: str
    title: str
    extension: str
    render: Callable[[Graph], str]


def dot(graph: Graph) -> str:
    return _lines(_dot(graph))


def _dot(graph: Graph) -> Iterator[str]:
    yield f"digraph {_quoted(graph.title)} {{"
    yield f"    rankdir={'TB' if graph.kind is Kind.TREE else 'LR'};"
    yield '    node [shape=box, style="rounded", fontname="sans-serif"];'
    yield '    edge [fontname="sans-serif", fontsize=10];'
    if graph.initial:
        yield '    "" [shape=point];'
        yield f'    "" -> {_quoted(graph.initial)};'
    for node in graph.nodes:
        style = ', color="gray50", fontcolor="gray30"' if node.minor else ""
        yield f"    {_quoted(node.id)} [label={_quoted(*node.lines)}{style}];"
    for link in graph.links:
        label = f" [label={_quoted(*link.lines)}]" if link.lines else ""
        yield f"    {_quoted(link.source)} -> {_quoted(link.target)}{label};"
    yield "}"


def _quoted(*lines: str) -> str:
    """A string in DOT. Lines are separated by the two characters `\\n`."""
    return '"' + "\\n".join(line.replace("\\", "\\\\").replace('"', '\\"') for line in lines) + '"'


def mermaid(graph: Graph) -> str:
    return _lines(_mermaid_states(graph) if graph.kind is Kind.STATES else _mermaid_flow(graph))


def _mermaid_states(graph: Graph) -> Iterator[str]:
    names = _names(graph)
    yield from _mermaid_title(graph)
    yield "stateDiagram-v2"
    for node in graph.nodes:
        yield f"    state {_mermaid_text(node.lines)} as {names[node.id]}"
    if graph.initial in names:
        yield f"    [*] --> {names[graph.initial]}"
    for link in graph.links:
        if link.source in names and link.target in names:
            label = f" : {_mermaid_text(link.lines)[1:-1]}" if link.lines else ""
            yield f"    {names[link.source]} --> {names[link.target]}{label}"


def _mermaid_flow(graph: Graph) -> Iterator[str]:
    names = _names(graph)
    yield from _mermaid_title(graph)
    yield f"flowchart {'TD' if graph.kind is Kind.TREE else 'LR'}"
    for node in graph.nodes:
        yield f"    {names[node.id]}[{_mermaid_text(node.lines)}]"
    for link in graph.links:
        label = f"|{_mermaid_text(link.lines)}|" if link.lines else ""
        yield f"    {names[link.source]} -->{label} {names[link.target]}"
    minor = [names[node.id] for node in graph.nodes if node.minor]
    if minor:
        yield "    classDef minor color:#666,stroke:#999"
        yield f"    class {','.join(minor)} minor"


def _mermaid_title(graph: Graph) -> Iterator[str]:
    title = json.dumps(graph.title, ensure_ascii=False).translate({ord(c): f"\\u{ord(c):04x}" for c in "<>&"})
    yield from ("---", f"title: {title}", "---")


_CONTROL = dict.fromkeys(range(32), " ")
"""Names may contain line ends, which would begin another line of the diagram."""
_MERMAID_ENTITIES = {ord(c): f"#{ord(c)};" for c in '"#;:<>{}[]|&%'} | _CONTROL


def _mermaid_text(lines: Iterable[str]) -> str:
    return '"' + "<br/>".join(line.translate(_MERMAID_ENTITIES) for line in lines) + '"'


def plantuml(graph: Graph) -> str:
    return _lines(_plantuml(graph))


def _plantuml(graph: Graph) -> Iterator[str]:
    names = _names(graph)
    element = "state" if graph.kind is Kind.STATES else "rectangle"
    yield "@startuml"
    yield f"title {_plantuml_escaped(graph.title)}"
    if graph.kind is not Kind.TREE:
        yield "left to right direction"
    for node in graph.nodes:
        yield f"{element} {_plantuml_text(node)} as {names[node.id]}{' #line:gray' if node.minor else ''}"
    if graph.initial in names:
        yield f"[*] --> {names[graph.initial]}"
    for link in graph.links:
        if link.source in names and link.target in names:
            label = " : " + "\\n".join(map(_plantuml_escaped, link.lines)) if link.lines else ""
            yield f"{names[link.source]} --> {names[link.target]}{label}"
    yield "@enduml"


def _plantuml_text(node: GraphNode) -> str:
    return '"' + "\\n".join(map(_plantuml_escaped, node.lines)) + '"'


def _plantuml_escaped(line: str) -> str:
    """A text without quotes, which end a string, and without tags, which PlantUML interprets: `<img:…>` reads
    a file."""
    return line.translate({ord(c): f"<U+{ord(c):04X}>" for c in '"<'} | _CONTROL)


def _names(graph: Graph) -> dict[str, str]:
    """An identifier for each node that is valid in every notation, whatever the name of the node is."""
    return {node.id: f"n{i}" for i, node in enumerate(graph.nodes)}


def _lines(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


NOTATIONS = {
    notation.name: notation
    for notation in (
        Notation("dot", "Graphviz DOT", "dot", dot),
        Notation("mermaid", "Mermaid", "mmd", mermaid),
        Notation("plantuml", "PlantUML", "puml", plantuml),
    )
}
