# SPDX-License-Identifier: Apache-2.0
"""How large a translation is, is known before it is made, and what is too large is refused where it costs most."""

from __future__ import annotations

import os

import pytest

from fuzz.corpus import NOWHERE, Model, systems
from fuzz.growth import DIMENSIONS, ENORMOUS
from roaml import api
from roaml.jani.expressions import ArrayConstructor, ArrayValue, Expression, Integer
from roaml.jani.model import Model as JaniModel
from roaml.model.expand import MAX_NODES, MAX_SUBTREES
from roaml.model.size import Limits, total
from roaml.project.settings import Settings
from roaml.record import Record

BY_NAME = {dimension.name: dimension for dimension in DIMENSIONS}
MAIN = os.path.join(NOWHERE, "main.xml")

SIZES = {
    "array-bound": 1000,
    "array-dimensions": 100,
    "array-literals": 300,
    "array-comparisons": 100,
    "max-array-size": 500,
    "branches": 200,
    "nested-branches": 40,
    "transitions": 200,
    "targets": 200,
    "states": 200,
    "states-and-events": 900,
    "variables": 100,
    "draws": 1000,
    "many-draws": 2,
    "machines": 30,
    "nodes": 30,
    "chained-subtrees": 20,
    "chained-sequences": 30,
}
GROWN = tuple(Model(name, MAIN, BY_NAME[name].texts(size)) for name, size in SIZES.items())


def cells(model: JaniModel) -> int:
    """The values that the variables of a translated model hold."""

    def count(value: Expression | None) -> int:
        match value:
            case ArrayValue(elements=elements):
                return sum(map(count, elements))
            case ArrayConstructor(length=Integer(value=length), body=body):
                return length * count(body)
        return 1

    variables = (*model.variables, *(v for automaton in model.automata for v in automaton.variables))
    return sum(count(variable.initial_value) for variable in variables)


def parts(model: JaniModel) -> int:
    """The nodes of all edges."""
    count = 0
    stack: list[object] = [automaton.edges for automaton in model.automata]
    while stack:
        part = stack.pop()
        if isinstance(part, tuple):
            stack += part
        elif isinstance(part, Record):
            count += 1
            stack += (getattr(part, name) for name in part.__struct_fields__ if name != "origin")
    return count


@pytest.mark.parametrize("model", [*systems(), *GROWN], ids=lambda model: model.name)
def test_the_size_is_known_beforehand(model: Model) -> None:
    system = api.load(model.main, model.ros_paths, Settings(), model.texts)
    size = system.analysis.size_of_translation(model.main)
    assert size is not None
    translated = api.to_jani(system)
    # The clock and the threads of actions have some variables of their own.
    assert abs(total(size.cells) - cells(translated)) <= 15
    expected, places = total(size.parts), len(translated.automata) * len(translated.system.syncs) // 20
    assert expected <= 4 * (parts(translated) + places) + 1000
    assert parts(translated) + places <= 4 * expected + 1000


CHECKED_LIMITS = Limits(cells=2000, parts=3000)


@pytest.mark.parametrize("dimension", DIMENSIONS, ids=lambda dimension: dimension.name)
@pytest.mark.parametrize("size", [10, 1000, ENORMOUS])
def test_what_is_not_refused_is_small(dimension, size: int) -> None:  # type: ignore[no-untyped-def]
    texts = dimension.texts(min(size, max(10, dimension.most // 10) if dimension.most < ENORMOUS else ENORMOUS))
    result = api.check([MAIN], [], Settings(limits=CHECKED_LIMITS), texts)
    assert not any(d.code == "internal-error" for d in result.diagnostics)
    if any(d.severity.label == "error" for d in result.diagnostics):
        return
    translated = api.to_jani(api.loaded(result.snapshot, MAIN))
    assert cells(translated) <= CHECKED_LIMITS.cells + 15
    assert parts(translated) <= 4 * CHECKED_LIMITS.parts + 1000


def found(name: str, size: int, settings: Settings | None = None) -> list[tuple[str, str, str]]:
    """File, code and message of each error."""
    result = api.check([MAIN], [], settings or Settings(), BY_NAME[name].texts(size))
    errors = (d for d in result.diagnostics if d.severity.label == "error")
    return [(os.path.basename(d.path), d.code, d.message) for d in errors]


def test_an_array_that_is_too_large() -> None:
    [(file, code, message)] = found("array-bound", 200_000_000)
    assert (file, code) == ("main.xml", "model-too-large")
    assert "have 200,000,001 cells, but at most 1,000,000 are translated" in message
    assert "the variable `a` of `M` takes 200,000,001" in message
    result = api.check([MAIN], [], Settings(), BY_NAME["array-bound"].texts(200_000_000))
    [related] = next(d for d in result.diagnostics if d.code == "model-too-large").related
    text = result.source(related.location.path).text
    assert text[related.location.span.start : related.location.span.end] == "a"


def test_the_limit_is_a_setting() -> None:
    assert found("array-bound", 999_999) == []
    assert found("array-bound", 1_000_000) != []
    assert found("array-bound", 1_000_000, Settings(limits=Limits(cells=1_000_001))) == []
    assert found("branches", 100) == []
    assert [code for _, code, _ in found("branches", 100, Settings(limits=Limits(parts=1000)))] == ["model-too-large"]


def test_control_nodes_grow_with_the_square_of_their_children() -> None:
    assert found("nodes", 40) == []
    [(file, code, message)] = found("nodes", 1000)
    assert (file, code) == ("main.xml", "model-too-large")
    assert "`Sequence` takes" in message


def test_subtrees_of_subtrees() -> None:
    [(file, code, message)] = found("subtrees", 10**9)
    assert (file, code) == ("tree.xml", "tree-too-large")
    assert f"the tree has 11,111,111,111 nodes, but at most {MAX_NODES:,} are executed" in message


def test_a_chain_of_subtrees_does_not_exhaust_the_stack() -> None:
    assert found("chained-subtrees", 900) == []
    [(_, code, message)] = found("chained-subtrees", MAX_SUBTREES + 1)
    assert code == "tree-too-large"
    assert f"{MAX_SUBTREES + 1:,} subtrees are nested" in message


def test_structs_of_structs() -> None:
    errors = [(code, message) for _, code, message in found("structs", 10**9)]
    assert len([code for code, _ in errors if code == "struct-declaration"]) == 1
    assert any("has 100,000 fields, but at most 10,000 are read" in message for _, message in errors)


def test_messages_of_messages(tmp_path) -> None:  # type: ignore[no-untyped-def]
    texts = BY_NAME["messages"].texts(10**9, str(tmp_path))
    for path, text in texts.items():
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    result = api.check([str(tmp_path / "main.xml")])
    errors = [d for d in result.diagnostics if d.severity is api.Severity.ERROR]
    assert {d.code for d in errors} == {"unknown-ros-type"}
    assert "it has 10,000,000,000 fields (at most 10,000 are read)" in errors[0].message


def test_messages_that_contain_each_other(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """Each of twenty messages has fields of all others: there are more paths than atoms."""
    texts = BY_NAME["messages"].texts(10, str(tmp_path))
    for number in range(20):
        others = "".join(f"M{i} f{i}\n" for i in range(20) if i != number)
        texts[str(tmp_path / "bomb" / "msg" / f"M{number}.msg")] = others
    for path, text in texts.items():
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    assert not any(d.code == "internal-error" for d in api.check([str(tmp_path / "main.xml")]).diagnostics)
