# SPDX-License-Identifier: Apache-2.0
"""A part of the corpus gate: generated systems go through every command."""

from __future__ import annotations

from pathlib import Path

import pytest

from corpus.forest import grow
from corpus.gate import STEPS, composed, generated, lone_trees, problems
from corpus.parts import PARTS, compose
from roaml import api


def test_a_small_system_goes_through_every_step(tmp_path: Path) -> None:
    (system,) = generated(tmp_path, {1: 1})
    assert list(problems(system)) == []


def test_many_copies_of_a_machine(tmp_path: Path) -> None:
    (system,) = generated(tmp_path, {4: 12})
    steps = {name: STEPS[name] for name in ("check", "translate", "simulate", "draw", "debug")}
    assert list(problems(system, steps)) == []


@pytest.mark.parametrize("seed", [0, 1])
def test_services_actions_structs_and_trees(tmp_path: Path, seed: int) -> None:
    (system,) = composed(tmp_path, [seed])
    steps = {name: STEPS[name] for name in ("check", "translate", "simulate", "draw", "debug")}
    assert list(problems(system, steps)) == []


def test_a_tree_without_a_system(tmp_path: Path) -> None:
    (tree,) = lone_trees(tmp_path, [3])
    assert list(problems(tree)) == []


@pytest.mark.parametrize("seeds", [range(start, start + 25) for start in range(0, 100, 25)], ids=str)
def test_public_forms_of_trees_have_no_errors(tmp_path: Path, seeds: range) -> None:
    for seed in seeds:
        main = grow(seed).write(tmp_path / str(seed))
        errors = [d for d in api.check([str(main.parent)]).diagnostics if d.severity is api.Severity.ERROR]
        assert errors == [], seed


def test_composed_systems_contain_what_real_ones_contain() -> None:
    systems = [compose(seed) for seed in range(30)]
    names = {name.split("_")[1] for system in systems for name in system.values}
    assert names == {make.__name__.strip("_") for make in PARTS}
    texts = ["".join(system.files.values()) for system in systems]
    for content in (
        "values[order[at]]",
        "got.points[1].frame == ",
        "_msg.data == ",
        '<elseif cond="word == ',
        'n_threads="3"',
        "<convince_mc_tc>",
        "<BehaviorTree",
        '<ros_time_rate name="slow"',
    ):
        assert any(content in text for text in texts), content
    assert max(text.count("word == '") for text in texts) >= 4
