# SPDX-License-Identifier: Apache-2.0
"""The texts that are damaged: the conformance models, the examples, and the documents and test cases of the rules."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import conformance
from fixture import read_cases, read_marks, split_files
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.text import decode

ROOT = Path(__file__).resolve().parents[2]
EXTENSIONS = (".xml", ".ascxml", ".scxml", ".jani", ".json", ".msg", ".srv", ".action")
NOWHERE = os.path.join(os.sep, "nowhere")
"""The folder of models that exist only in memory."""

_BLOCK = re.compile(r"^```\w*\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Model:
    """Files that belong together. `main` is the file that is checked, with all files that it refers to."""

    name: str
    main: str
    texts: dict[str, str]
    ros_paths: tuple[str, ...] = ()


@cache
def systems() -> tuple[Model, ...]:
    """The conformance models and the examples, always in the same order."""
    systems = [_on_disk(path, (str(conformance.INTERFACES),)) for path in sorted(conformance.systems())]
    return (*systems, *(_on_disk(path, ()) for path in sorted((ROOT / "examples").glob("*/main.xml"))))


@cache
def snippets() -> tuple[Model, ...]:
    """The small models in the documents and test cases of the rules, always in the same order."""
    return tuple(_written())


@cache
def interfaces() -> dict[str, str]:
    """The interface definitions of the conformance models."""
    paths = sorted(path for path in conformance.INTERFACES.rglob("*") if path.suffix in EXTENSIONS)
    return {str(path): decode(str(path), path.read_bytes()).text for path in paths}


def _on_disk(main: Path, ros_paths: tuple[str, ...]) -> Model:
    settings = Settings(ros_paths=ros_paths)
    analysis = Workspace((), settings, [str(main)], packages=[str(main.parent)]).snapshot().analysis
    files = (*analysis.files_of(str(main)), *analysis.interface_files_of(str(main)))
    sources = {path: analysis.source(path) for path in files}
    texts = {path: source.text for path, source in sources.items() if source is not None}
    return Model(f"{main.parent.name}/{main.name}", str(main), texts, ros_paths)


def _written() -> Iterator[Model]:
    for document in sorted((ROOT / "server" / "roaml" / "rules").glob("*/*.md")):
        for number, block in enumerate(_BLOCK.findall(document.read_text(encoding="utf-8"))):
            yield from _in_memory(f"{document.stem}_{number}", block)
    for path in sorted((ROOT / "tests" / "rules" / "cases").glob("*/*.txt")):
        for number, case in enumerate(read_cases(path)):
            yield from _in_memory(f"{path.stem}_case_{number}", case.text)


def _in_memory(name: str, written: str) -> Iterator[Model]:
    files = {n: read_marks(n, text)[0] for n, text in split_files(written).items() if n.endswith(EXTENSIONS)}
    if files:
        folder = os.path.join(NOWHERE, name)
        texts = {os.path.normpath(os.path.join(folder, n)): text for n, text in files.items()}
        main = next((path for path, text in texts.items() if "<roaml" in text), next(iter(texts)))
        yield Model(name, main, texts)
