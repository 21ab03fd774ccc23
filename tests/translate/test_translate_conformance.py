# SPDX-License-Identifier: Apache-2.0
"""With the semantics of AS2FM, the translation of every conformance model has the reference's names, types, properties
and sizes.

What differs on purpose is listed in `differences.toml`; everything else of those models is compared.
"""

from __future__ import annotations

import gzip
import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

import conformance
from conformance_systems import load
from roaml import api
from roaml.jani.reader import read_model
from roaml.jani.typecheck import check_model
from roaml.jani.writer import write
from roaml.json_syntax import parse

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

DIFFERENCES = tomllib.loads(Path(__file__).with_name("differences.toml").read_text())["difference"]
Shape = dict[str, object]


def shape(jani: Any) -> Shape:
    """What counts. The variables of an automaton go without names: those of built-in tree nodes are our own."""
    return {
        "variables": named(jani["variables"], "type"),
        "properties": named(jani["properties"], "expression"),
        "automata": sorted(
            (a["name"], len(a["locations"]), len(a["edges"]), sorted(str(v["type"]) for v in a.get("variables", ())))
            for a in jani["automata"]
        ),
        "syncs": len(jani["system"]["syncs"]),
    }


def named(items: Iterable[Any], key: str) -> list[str]:
    return sorted(f"{item['name']} {json.dumps(item[key], sort_keys=True)}" for item in items)


def reference(path: Path) -> Path:
    folder = path.relative_to(conformance.ROOT / "models").parts[0]
    return conformance.ROOT / "reference" / f"{folder}.{path.stem}.jani.gz"


TRANSLATED = [path for path in conformance.systems() if reference(path).exists()]


def test_there_are_references() -> None:
    assert TRANSLATED


@pytest.mark.parametrize("path", TRANSLATED, ids=conformance.label)
def test_shape(path: Path) -> None:
    system = load(path, as_reference=True)
    ours = shape(json.loads("".join(write(api.to_jani(system)))))
    theirs = shape(json.loads(gzip.decompress(reference(path).read_bytes())))
    nodes = {d["node"] for d in DIFFERENCES if path == conformance.ROOT / "models" / d["model"]}
    if nodes:
        assert ours["syncs"] != theirs["syncs"]
        ours, theirs = without(ours, nodes), without(theirs, nodes)
    assert ours == theirs


def without(whole: Shape, nodes: set[str]) -> Shape:
    """A shape without the automata of these tree nodes and without the number of synchronisations."""
    automata = whole["automata"]
    assert isinstance(automata, list)
    kept = [a for a in automata if not any(f"_{node}" in a[0] for node in nodes)]
    assert len(kept) < len(automata)
    return {**whole, "automata": kept, "syncs": None}


@pytest.mark.parametrize("path", conformance.systems(), ids=conformance.label)
def test_sound_and_read_back(path: Path) -> None:
    model = api.to_jani(load(path))
    assert check_model(model) == ()
    text = "".join(write(model))
    again, findings = read_model(parse(text)[0])
    assert findings == ()
    assert again is not None
    assert "".join(write(again)) == text


@pytest.mark.parametrize("path", conformance.systems(), ids=conformance.label)
def test_what_the_checker_takes_for_global_variables(path: Path) -> None:
    """The table by which properties are checked is that of the translation."""
    system = load(path)
    names = {variable.name for variable in api.to_jani(system).variables}
    assert set(system.analysis.globals(system.path)) == names
