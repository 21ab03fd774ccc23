# SPDX-License-Identifier: Apache-2.0
"""A part of the corpus gate: generated systems go through every command."""

from __future__ import annotations

from pathlib import Path

from corpus.gate import STEPS, generated, problems


def test_a_small_system_goes_through_every_step(tmp_path: Path) -> None:
    (system,) = generated(tmp_path, {1: 1})
    assert list(problems(system)) == []


def test_many_copies_of_a_machine(tmp_path: Path) -> None:
    (system,) = generated(tmp_path, {4: 12})
    steps = {name: STEPS[name] for name in ("check", "translate", "simulate", "draw", "debug")}
    assert list(problems(system, steps)) == []
