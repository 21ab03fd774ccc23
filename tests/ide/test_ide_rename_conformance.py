# SPDX-License-Identifier: Apache-2.0
"""Renaming things of the conformance models: a sample; `sweep.py` renames all."""

from __future__ import annotations

import random

from ide_sweep import System

import conformance


def test_sample() -> None:
    chance = random.Random(20240)
    for main in chance.sample(conformance.systems(), 7):
        system = System(str(main), (str(conformance.INTERFACES),))
        cases = list(system.cases())
        for case in chance.sample(cases, min(5, len(cases))):
            assert list(system.failures(case)) == [], (conformance.label(main), case.name)
