# SPDX-License-Identifier: Apache-2.0
"""Files of a model, each damaged separately: bytes, pieces, elements, attributes, expressions, JSON."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from random import Random

from fuzz.checked import problems_of_check
from fuzz.corpus import Model, interfaces, snippets, systems
from fuzz.damage import ANY, ways
from fuzz.strategy import Failure, Strategy

MAX_LENGTH = 300_000
"""The maximum number of characters of a file. Larger files may take longer."""


@dataclass
class Damaged:
    """A damaged model.

    Attributes:
        model: the original model.
        texts: all files, damaged or not.
        main: the file that is checked.
        damage: a description of the damage.
    """

    seed: int
    model: Model
    texts: dict[str, str]
    main: str
    damage: list[str] = field(default_factory=list)

    def description(self) -> Iterator[str]:
        yield f"{self.model.name}: check of {self.main}"
        yield from self.damage

    def files(self) -> dict[str, str | bytes]:
        return {path: text for path, text in self.texts.items() if self.model.texts.get(path) != text}

    def run(self) -> Iterator[Failure]:
        return problems_of_check(self.main, self.texts, self.model.ros_paths, Random(self.seed))


def make(seed: int) -> Damaged:
    random = Random(seed)
    model = random.choice(systems() if random.random() < 0.5 else snippets())
    case = Damaged(seed, model, dict(model.texts), model.main)
    others = [
        text for chosen in (random.choice(systems()), random.choice(snippets())) for text in chosen.texts.values()
    ]
    for _ in range(random.choice([1, 1, 2, 4])):
        path = random.choice(list(model.texts))
        if model.ros_paths and random.random() < 0.05 and interfaces():
            path = random.choice(list(interfaces()))
            case.texts.setdefault(path, interfaces()[path])
        way = random.choice(ways(path) if random.random() < 0.95 else ANY)
        case.texts[path] = way(random, case.texts[path], others)[:MAX_LENGTH]
        case.damage.append(f"{way.__name__} in {path}")
    if random.random() < 0.15:
        case.main = random.choice(list(model.texts))
    return case


STRATEGY = Strategy("files", "damages the files of a model one by one", make, share=4)
