#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds tables about nodes of behavior trees whose meaning no test reads: `python tests/mutants/run.py`.

Each mutant is a copy of the checkout in which one entry of a table has another value: a declaration of a node, a
statement of a program, or a name or number in a table in Python. The tables that follow from the declarations are
written again, so a test that only compares these notices nothing. A mutant that all tests accept is listed, and the
exit status is then 1. The tests of the copy do not find the files beside the checkout (`../shared`). All tests must
pass without a mutant; otherwise nothing is judged, and the exit status is 2.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
SERVER = Path("server", "roaml")

TESTS = (
    ("tests/libraries",),
    ("tests/forest",),
    ("tests/mocks/test_node_effects.py", "tests/mocks/test_trees_in_systems.py"),
    ("tests/mocks/test_mock_library.py",),
    ("tests/rules", "tests/findings/test_valid_trees.py"),
    ("tests/mocks", "tests/script"),
)
"""The tests of one mutant, the fastest first. The first that fails ends them."""

PYTHON = {
    "forest/forest.py": ("_COMMON_NAMES",),
    "libraries/scripts.py": ("CONDITIONS", "AFTERWARDS"),
    "libraries/version.py": (
        *("TAGS_LOOKED_UP_SINCE", "ASYNC_SEQUENCES_REFUSED_SINCE", "NAMES_CHECKED_SINCE"),
        *("SCRIPTS_CHANGED_SINCE", "CONSTANTS_TYPED_SINCE", "CASES_WHOLE_SINCE"),
    ),
    "rules/support/node_calls.py": ("WITHOUT_RESETS",),
    "rules/trees/tree_semantics.py": ("CONTINUING",),
}
"""File -> the tables in it whose names and numbers are changed."""

_DECLARED = (
    (re.compile(r' counts-children="true"'), ""),
    (re.compile(r' (?:since|until)="[^"]*"'), ""),
    (re.compile(r' system-constant="true"'), ""),
    (re.compile(r'(?<=default=")true(?=")'), "false"),
    (re.compile(r'(?<=default=")false(?=")'), "true"),
    (re.compile(r'(?<=default=")SUCCESS(?=")'), "FAILURE"),
    (re.compile(r'(?<=default=")FAILURE(?=")'), "SUCCESS"),
    (re.compile(r'(?<=default=")-?[0-9]+(?=")'), "+1"),
    (re.compile(r'(?<=min=")-?[0-9]+(?=")'), "+1"),
    (re.compile(r'(?<=above=")-?[0-9]+(?=")'), "+1"),
    (re.compile(r'(?<=children=")[0-9]+'), "+1"),
    (re.compile(r' (?:names-entry|program-only|needs-ports|required)="true"'), ""),
    (re.compile(r' use="\w+"'), ""),
    (re.compile(r' special="[^"]*"'), ""),
    (re.compile(r' system-direction="[^"]*"'), ""),
    (re.compile(r'(?<=running=")true(?=")'), "false"),
    (re.compile(r'(?<=running=")false(?=")'), "true"),
    (re.compile(r'(?<=[ -]type=")(?!bool")[^"]*(?=")'), "bool"),
    (re.compile(r'(?<=[ -]type=")bool(?=")'), "int"),
    (re.compile(r'(?<= to=")\w+(?=")'), "Inverter"),
    (re.compile(r'(?<= instead=")\w+(?=")'), "Inverter"),
)
"""Part of a tag in a declaration -> what replaces it. `+1` is the number plus one."""

_DIRECTIONS = (
    (re.compile(r"<in (.*)</in>", re.DOTALL), r"<out \1</out>"),
    (re.compile(r"<out (.*)</out>", re.DOTALL), r"<in \1</in>"),
    (re.compile(r"<inout (.*)</inout>", re.DOTALL), r"<in \1</in>"),
)
"""The declaration of a port -> a declaration with another direction."""

_STATEMENTS = (
    (re.compile(r"\bSUCCESS\b"), "FAILURE"),
    (re.compile(r"\bFAILURE\b"), "SUCCESS"),
    (re.compile(r"\bRUNNING\b"), "SUCCESS"),
    (re.compile(r"\bSKIPPED\b"), "FAILURE"),
    (re.compile(r"\bTrue\b"), "False"),
    (re.compile(r"\bFalse\b"), "True"),
    (re.compile(r"\breset_all\(\)"), "reset(0)"),
    (re.compile(r"(?<= )<(?= )"), "<="),
    (re.compile(r"(?<= )==(?= )"), "!="),
    (re.compile(r"(?<== )0\b"), "1"),
)


class Mutant(NamedTuple):
    """One changed entry: the file, the span of the entry in characters, and the new text."""

    path: Path
    start: int
    end: int
    new: str

    def described(self, text: str) -> str:
        line = text.count("\n", 0, self.start) + 1
        return f"{self.path}:{line}: {text[self.start : self.end].strip()!r} becomes {self.new!r}"

    def changed(self, text: str) -> str:
        return text[: self.start] + self.new + text[self.end :]


def mutants() -> Iterator[Mutant]:
    """All mutants."""
    folder = SERVER / "libraries"
    for name in ("behaviortree_cpp.xml", "nav2.xml"):
        yield from _replaced(folder / name, _DECLARED, re.compile(r"<[^!>]*>"))
        yield from _replaced(folder / name, _DIRECTIONS, re.compile(r"<(in|out|inout) [^<]*</\1>", re.DOTALL))
    for path in sorted((ROOT / folder / "programs" / "definitions").glob("*.txt")):
        yield from _replaced(path.relative_to(ROOT), _STATEMENTS, re.compile(r"^(?!#).*$", re.MULTILINE))
    for name, tables in PYTHON.items():
        yield from _entries(SERVER / name, tables)


def _replaced(path: Path, rules: tuple[tuple[re.Pattern[str], str], ...], part: re.Pattern[str]) -> Iterator[Mutant]:
    text = (ROOT / path).read_text("utf-8")
    for place in part.finditer(text):
        for pattern, new in rules:
            for match in pattern.finditer(text, place.start(), place.end()):
                other = str(int(match[0]) + 1) if new == "+1" else match.expand(new)
                yield Mutant(path, match.start(), match.end(), other)


def _entries(path: Path, tables: tuple[str, ...]) -> Iterator[Mutant]:
    """The names and numbers in tables of a module. A name becomes the next one of its table, which deletes it."""
    text = (ROOT / path).read_text("utf-8")
    assert text.isascii(), path
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for statement in ast.parse(text).body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) in tables:
            constants = [node for node in ast.walk(statement.value) if isinstance(node, ast.Constant)]
            for node, other in zip(constants, (*constants[1:], *constants[:1]), strict=True):
                start = starts[node.lineno - 1] + node.col_offset
                new = repr(node.value + 1) if isinstance(node.value, int) else repr(other.value)
                yield Mutant(path, start, start + len(ast.get_source_segment(text, node) or ""), new)


def copied(folder: Path) -> None:
    """Copy the files of the checkout that git knows, and the compiled modules."""
    known = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True).stdout
    compiled = (str(path.relative_to(ROOT)) for path in (ROOT / "server").rglob("*.so"))
    for name in (*filter(None, known.split("\0")), *compiled):
        if not name.startswith(("vscode-extension", ".github")) and (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)


def fails(folder: Path, *command: str) -> bool:
    """Whether a command of Python fails in a copy of the checkout."""
    environment = {**os.environ, "PYTHONPATH": str(folder / "server"), "PYTHONDONTWRITEBYTECODE": "1"}
    arguments = [sys.executable, *command]
    return subprocess.run(arguments, cwd=folder, env=environment, capture_output=True, check=False).returncode != 0


def failing(folder: Path) -> str:
    """The first of the tests that fail in a copy; "" if none does."""
    return next((tests[0] for tests in TESTS if fails(folder, "-m", "pytest", "-x", "-n", "0", *tests)), "")


def killed_by(folder: Path, mutant: Mutant) -> str:
    """The tests that fail with a mutant; "" if none does."""
    path = folder / mutant.path
    before = path.read_text("utf-8")

    def write(text: str) -> bool:
        path.write_text(text, "utf-8")
        return path.suffix == ".xml" and fails(folder, "docs/build.py")

    try:
        return "docs/build.py" if write(mutant.changed(before)) else failing(folder)
    finally:
        write(before)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=25, help="the number of mutants, drawn at random (25)")
    parser.add_argument("--seed", type=int, default=1, help="the seed of the draw (1)")
    parser.add_argument("--only", default="", metavar="TEXT", help="only mutants whose description contains TEXT")
    parser.add_argument("--list", action="store_true", help="list the mutants and run nothing")
    arguments = parser.parse_args()
    texts = {each.path: (ROOT / each.path).read_text("utf-8") for each in mutants()}
    chosen = [each for each in mutants() if arguments.only in each.described(texts[each.path])]
    # Equal numbers from each table, because most entries are statements of programs.
    by_path = [[each for each in chosen if each.path == path] for path in texts]
    source = random.Random(arguments.seed)
    for group in by_path:
        source.shuffle(group)
    turns = (group[turn] for turn in range(max(map(len, by_path), default=0)) for group in by_path if turn < len(group))
    survivors = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if not arguments.list:
            copied(folder)
            if broken := failing(folder):
                print(f"{broken} fails without a mutant, so it cannot judge one; mend it first", file=sys.stderr)
                return 2
        for mutant, _ in zip(turns, range(arguments.count), strict=False):
            shown = mutant.described(texts[mutant.path])
            if arguments.list:
                print(shown)
                continue
            killer = killed_by(folder, mutant)
            survivors += not killer
            print(f"{'killed by ' + killer if killer else 'SURVIVES'}: {shown}", flush=True)
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
