# SPDX-License-Identifier: Apache-2.0
"""Commands on files whose values are replaced: numbers that no variable can have, values of other types, missing parts.
No command ends with an internal error."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random
from typing import Any
from unittest import mock

from as2fm_lsp.cli import main
from as2fm_lsp.cli.exit_status import FAILURE
from as2fm_lsp.cli.init import template
from fuzz import limits
from fuzz.networks import network
from fuzz.strategy import Failure, Strategy

WORDS = (
    *("Infinity", "-Infinity", "NaN", "1e400", "1e308", "-1", "0", "1", "2", "1.5", "-0.0", "0.1", "5e-324"),
    *("9223372036854775807", "9223372036854775808", "-9223372036854775808", "-9223372036854775809"),
    *("18446744073709551616", "1" + "0" * 30, "4294967296", "2147483648", "1000000007"),
    *("true", "null", '""', '"1"', '"x"', "[]", "{}", "[1]", "[[1]]", '{"op": "+"}'),
)
"""What replaces a value in JSON. In XML, the quotes of strings are left out."""

TRACES = ("--max-traces=20", "--max-steps=200", "--jobs=1")
ON_MODELS = (
    ("verify", *TRACES),
    ("verify", *TRACES, "--method=fixed", "--resume=state.json"),
    ("verify", "--exhaustive", "--max-states=500", "--jobs=1", "--explain"),
    ("verify", *TRACES, "--traces=traces", "--traces-limit=1", "--format=json"),
    ("simulate", "--max-steps=50"),
    ("simulate", "--max-steps=50", "--script=run.json"),
    ("simulate", "--max-steps=50", "--csv=-", "--save=saved.json"),
    ("check",),
)
ON_NETWORKS = (*ON_MODELS, ("verify", *TRACES, "--scheduler=lss"))
ON_SYSTEMS = (*ON_MODELS, ("translate",), ("draw",), ("draw", "--machines"), ("draw", "--tree"), ("migrate", "--diff"))


@cache
def originals() -> Mapping[str, Mapping[str, str]]:
    """Kind of model -> the files of a model, with a saved run and the state of a verification: path -> text."""
    systems = {"main.xml": dict(template("delivery_robot"))}
    for seed in (1, 2, 3, 5, 8, 13):
        systems[f"model{seed}.jani"] = {f"model{seed}.jani": json.dumps(network(Random(seed)))}
    for name, files in systems.items():
        with _folder(files) as folder:
            _run(["simulate", name, "--max-steps=50", "--save=run.json"])
            _run(["verify", name, *TRACES, "--method=fixed", "--resume=state.json"])
            files |= {path.name: path.read_text() for path in folder.glob("*.json")}
    return systems


@contextlib.contextmanager
def _folder(files: Mapping[str, str]) -> Iterator[Path]:
    """A folder with files, as the working directory."""
    folder, before = Path(tempfile.mkdtemp(prefix="as2fm-fuzz-")), os.getcwd()
    try:
        for name, text in files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        os.chdir(folder)
        yield folder
    finally:
        os.chdir(before)
        shutil.rmtree(folder, ignore_errors=True)


def _run(arguments: list[str]) -> tuple[int, str]:
    """Exit status and error messages of a command."""
    out, err = (io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2))
    with mock.patch("sys.stdout", out), mock.patch("sys.stderr", err), mock.patch("sys.stdin", io.StringIO()):
        status = main.run(arguments)
    err.flush()
    return status, err.buffer.getvalue().decode()  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Call:
    """A command and its files, of which one is changed."""

    arguments: tuple[str, ...]
    texts: Mapping[str, str]
    change: str

    def description(self) -> Iterator[str]:
        yield f"{' '.join(self.arguments)}: {self.change}"

    def files(self) -> Mapping[str, str | bytes]:
        return dict(self.texts)

    def run(self) -> Iterator[Failure]:
        limits.restart()
        with _folder(self.texts):
            status, messages = _run(list(self.arguments))
        if status >= FAILURE or "Traceback" in messages:
            lines = [line.strip() for line in messages.splitlines() if line.strip()]
            places = [line for line in lines if line.startswith("File ")]
            place = re.sub(r'.*/server/|"', "", places[-1]) if places else ""
            yield Failure(f"status {status}: {lines[-2][:80] if len(lines) > 1 else ''} {place}", messages)


def _values(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all parts of a JSON value."""
    if path:
        yield path
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in parts:
        yield from _values(part, (*path, key))


def _in_json(random: Random, text: str) -> tuple[str, str]:
    value = json.loads(text)
    *path, last = random.choice(list(_values(value)))
    owner = value
    for key in path:
        owner = owner[key]
    if random.random() < 0.1:
        del owner[last]
        return json.dumps(value), f"{path} without {last}"
    owner[last] = "@@"
    word = random.choice(WORDS)
    return json.dumps(value).replace('"@@"', word), f"{[*path, last]} is {word}"


def _in_xml(random: Random, text: str) -> tuple[str, str]:
    numbers = list(re.finditer(r'\d+(?:\.\d+)?|(?<==")[^"]*(?=")', text))
    match = random.choice(numbers)
    word = random.choice(WORDS).strip('"').replace('"', "'")
    return text[: match.start()] + word + text[match.end() :], f"{match[0]} is {word}"


def make(seed: int) -> Call:
    random = Random(seed)
    name = random.choice([*originals(), "main.xml"])
    texts = dict(originals()[name])
    changes = []
    for _ in range(random.choice([1, 1, 2])):
        file = random.choice(list(texts))
        if file.endswith((".json", ".jani")):
            with contextlib.suppress(ValueError):  # a first change has made it invalid
                texts[file], change = _in_json(random, texts[file])
                changes.append(f"{file}: {change}")
        else:
            texts[file], change = _in_xml(random, texts[file])
            changes.append(f"{file}: {change}")
    command, *options = random.choice(ON_SYSTEMS if name == "main.xml" else ON_NETWORKS)
    return Call((command, name, *options), texts, ", ".join(changes))


STRATEGY = Strategy("commands", "replaces values in models, saved runs and saved states, and runs commands", make)
