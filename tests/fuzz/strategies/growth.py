# SPDX-License-Identifier: Apache-2.0
"""Bombs: small inputs with enormous results. Too large ones are rejected; the others take linear time.

The limits are a hundredth of the real ones, so that input just below them takes as long as a case may take.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

from fuzz.checked import problems_of_check
from fuzz.growth import DIMENSIONS, Dimension
from fuzz.strategy import Failure, Strategy
from roaml.model.size import MAX_CELLS, MAX_PARTS, Limits
from roaml.project.settings import Settings

LIMITS = Limits(MAX_CELLS // 100, MAX_PARTS // 100)
SMALLEST = 10


@dataclass(frozen=True)
class Grown:
    dimension: Dimension
    size: int

    def description(self) -> Iterator[str]:
        yield f"{self.dimension.name} of size {self.size:,}"

    def files(self) -> dict[str, str | bytes]:
        return dict(self.dimension.texts(self.size))

    def run(self) -> Iterator[Failure]:
        texts = self.dimension.texts(self.size)
        main = next(path for path in texts if os.path.basename(path) == "main.xml")
        yield from problems_of_check(main, texts, settings=Settings(limits=LIMITS))


def make(seed: int) -> Grown:
    """A size of any order of magnitude."""
    random = Random(seed)
    dimension = random.choice(DIMENSIONS)
    # Half of what is tried at all: a check of a text of 300,000 characters may take as long as a case.
    most = max(SMALLEST, dimension.most // 2)
    return Grown(dimension, int(SMALLEST * (most / SMALLEST) ** random.random()))


STRATEGY = Strategy("growth", "makes small systems that stand for enormous ones", make)
