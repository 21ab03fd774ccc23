# SPDX-License-Identifier: Apache-2.0
"""No two public classes have the same name, unless this module states the reason (docs/STYLE.md#names)."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

SERVER = Path(__file__).resolve().parents[1] / "server"

LANGUAGES = {
    "roaml.expr.operators": "expressions",
    "roaml.expr.tree": "expressions",
    "roaml.interfaces.types": "interface definitions of ROS 2",
    "roaml.jani.expressions": "JANI",
    "roaml.jani.model": "JANI",
    "roaml.jani.node": "JANI",
    "roaml.jani.operators": "JANI",
    "roaml.jani.properties": "JANI",
    "roaml.json_syntax.values": "JSON",
    "roaml.libraries.node": "BehaviorTree.CPP",
    "roaml.model.machine": "HL-SCXML",
    "roaml.model.property_file": "property files in XML",
    "roaml.model.syntax": "HL-SCXML",
    "roaml.observers.notation": "observers",
    "roaml.observers.program": "observers",
    "roaml.observers.properties": "observers",
    "roaml.observers.verdict": "observers",
    "roaml.script.tree": "scripts of BehaviorTree.CPP",
    "roaml.scxml.model": "SCXML",
    "roaml.xml_syntax.tree": "XML",
}
"""Modules whose classes have the names of their language, with the language: `Assign` is an element of SCXML and one of
HL-SCXML. Code that needs two of these classes imports the modules."""

KEPT = {
    "Choice": "what a user of the simulator chooses, and what an observer does",
    "Comparison": "of a result with a number, and of two values in a script of BehaviorTree.CPP",
    "End": "why a trace ends, and how an observer judges it",
    "Expectation": "what the command line expects of a result, and what JANI records",
    "Frame": "a subtree while it is expanded, and while names are looked up in it",
    "Location": "a place in a text, and a state of an automaton of JANI",
    "Notation": "a language of diagrams, and one of properties",
    "Session": "of a client of the server, and of a user of the simulator",
    "System": "the system of a system file, and the composition in JANI",
    "Verdict": "on an expectation, and of an observer",
}


def classes() -> dict[str, list[str]]:
    """Name -> the modules that have a public class of that name."""
    modules: defaultdict[str, list[str]] = defaultdict(list)
    for path in sorted(SERVER.rglob("*.py")):
        module = ".".join(path.relative_to(SERVER).with_suffix("").parts).removesuffix(".__init__")
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                modules[node.name].append(module)
    return modules


def test_names_are_used_once() -> None:
    shared = {name: modules for name, modules in classes().items() if len(modules) > 1}
    unexplained = {
        name: modules
        for name, modules in shared.items()
        if name not in KEPT and not all(module in LANGUAGES for module in modules)
    }
    assert not unexplained, "give each class a name that says which, or say here why they share it"
    assert not KEPT.keys() - shared.keys(), "these names are used once by now"


def test_modules_of_languages_are_there() -> None:
    known = {module for modules in classes().values() for module in modules}
    assert not LANGUAGES.keys() - known
