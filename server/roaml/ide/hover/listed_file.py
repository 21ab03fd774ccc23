# SPDX-License-Identifier: Apache-2.0
"""Hover texts for the files that a system or tree names."""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.ide.describe import describe
from roaml.ide.describe.markdown import code, file, lines, names, paragraphs
from roaml.ide.describe.property_file import formula
from roaml.ide.hover.place import Place
from roaml.ide.json_tree import members
from roaml.json_syntax import JsonArray, JsonObject, JsonString
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.paths import resolve
from roaml.roles import SymbolKind
from roaml.text import Span


def listed_file(place: Place) -> tuple[Span, str] | None:
    """The description of the file whose path is at a place: its kind and its content. `None` if there is no path, or if
    the file cannot be read."""
    analysis, path, offset = place.analysis, place.path, place.offset
    system, tree = analysis.system_file(path), analysis.tree(path)
    written = [entry.src for entry in system.inputs] if system else []
    written += [include.path for include in tree.includes] if tree else []
    named = next((name for name in written if name and name.span.contains(offset)), None)
    if named is None:
        return None
    text = content(analysis, path, resolve(path, named.value))
    return (named.span, text) if text else None


def content(analysis: Analysis, system: str, path: str) -> str:
    """The description of a file of a system: its kind and its content; "" if it cannot be read."""
    if analysis.source(path) is None:
        return ""
    machine, tree = analysis.machine(path), analysis.tree(path)
    match analysis.kind(path):
        case FileKind.MACHINE if machine and machine.name:
            return describe(analysis, Symbol(path, SymbolKind.MACHINE, machine.name.value))
        case FileKind.TREE if tree:
            trees = names(behavior_tree.id.value for behavior_tree in tree.trees if behavior_tree.id)
            return lines(f"Behavior trees {trees}" if trees else "Behavior tree", file(path))
        case FileKind.PROPERTIES:
            return paragraphs(_properties(analysis, path), file(path))
    structs = names(declaration.name.value for declaration in analysis.struct_declarations(path) if declaration.name)
    return (
        lines(f"Structs {structs}", file(path))
        if structs
        else lines(analysis.kind(path).value.capitalize(), file(path))
    )


def _properties(analysis: Analysis, path: str) -> str:
    value = analysis.json(path)
    entries = value[0].get("properties") if value and isinstance(value[0], JsonObject) else None
    rows = []
    for entry in entries.items if isinstance(entries, JsonArray) else ():
        parts = members(entry)
        called, expression = parts.get("name"), parts.get("expression")
        if isinstance(called, JsonString) and expression is not None:
            rows.append(f"{called.value}: {formula(expression)}")
    return code("\n".join(rows)) if rows else "No properties"
