# SPDX-License-Identifier: Apache-2.0
"""All requests that the server supports, sent at some places of some conformance models; `sweep.py` sends them at all
places."""

from __future__ import annotations

from random import Random

from lsp_sweep import Sweep, some_places

import conformance

SEED = 4
SYSTEMS = 4
PLACES = 6


def test_sample() -> None:
    for main in sorted(Random(SEED).sample(conformance.systems(), SYSTEMS)):
        sweep = Sweep(main, (str(conformance.INTERFACES),), some_places(SEED, PLACES))
        assert list(sweep.failures()) == [], main
