# SPDX-License-Identifier: Apache-2.0
"""Property files in XML and JANI, typed character by character: a part of a file is typed again, at its end or before
the rest of the file, and every text on the way is checked."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from random import Random

from fixture import split_files
from fuzz.checked import problems_of_check
from fuzz.corpus import NOWHERE, Model, snippets, systems
from fuzz.limits import restart
from fuzz.strategy import Failure, Strategy
from property_robot import ROBOT

MAX_TYPED = 8
"""The number of characters that a case types."""
MAX_MODEL = 60_000
"""The number of characters of all files of a model. Each typed character checks all of them."""


@dataclass(frozen=True)
class Typed:
    """
    Attributes:
        path: the property file.
        start: the text before the typed characters.
        typed: the characters that are typed, one after the other.
        rest: the text after them.
    """

    model: Model
    path: str
    start: str
    typed: str
    rest: str

    def description(self) -> Iterator[str]:
        yield f"{self.model.name}: {self.typed!r} is typed into {self.path}"

    def files(self) -> dict[str, str | bytes]:
        return {**self.model.texts, self.path: self.text(len(self.typed))}

    def text(self, count: int) -> str:
        return f"{self.start}{self.typed[:count]}{self.rest}"

    def run(self) -> Iterator[Failure]:
        for count in range(len(self.typed) + 1):
            restart()
            texts = {**self.model.texts, self.path: self.text(count)}
            yield from problems_of_check(self.model.main, texts, self.model.ros_paths)


def make(seed: int) -> Typed:
    random = Random(seed)
    model, path = random.choice(_property_files())
    text = model.texts[path]
    start = random.randrange(len(text))
    end = min(len(text), start + random.randint(1, MAX_TYPED))
    rest = random.choice(("", text[end:], text[random.randrange(end, len(text) + 1) :]))
    return Typed(model, path, text[:start], text[start:end], rest)


@cache
def _property_files() -> tuple[tuple[Model, str], ...]:
    """The property files of small models. Each pair is (model, path)."""
    folder = os.path.join(NOWHERE, "property_robot")
    texts = {os.path.join(folder, name): text for name, text in split_files(ROBOT).items()}
    robot = Model("property_robot", os.path.join(folder, "main.xml"), texts)
    small = [model for model in (robot, *systems(), *snippets()) if sum(map(len, model.texts.values())) <= MAX_MODEL]
    return tuple((model, path) for model in small for path, text in model.texts.items() if _has_properties(path, text))


def _has_properties(path: str, text: str) -> bool:
    return '"properties"' in text if path.endswith(".jani") else "<properties>" in text and "<guarantees>" in text


STRATEGY = Strategy("properties", "types property files character by character", make)
