# SPDX-License-Identifier: Apache-2.0
"""How the time of a verification grows with the size of a model: `python run.py [SIZE...]`.

A robot on a grid of SIZE × SIZE cells and the behavior tree that brings it to its goal, verified by `as2fm-lsp verify`
(folder `robot`) and by BehaVerify with NuSMV (`grid.tree`). Each row is the wall time of whole commands. Tools that
are not installed are omitted, and the table says so.

    python -m venv behaverify && behaverify/bin/pip install behaverify
    sh nusmv.sh nusmv
    python run.py 10 20 40 80 --behaverify behaverify/bin/behaverify --nusmv nusmv/NuSMV
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

HERE = Path(__file__).resolve().parent
MAX_SIZE = 100
"""The maximum size: `Math.random()` has 100 values in a model, so a random cell is one of at most 100 in a row."""


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sizes", nargs="*", type=int, default=[10, 20, 40, 80], metavar="SIZE")
    parser.add_argument("--as2fm", default=_beside_python("as2fm-lsp"), metavar="COMMAND")
    parser.add_argument("--behaverify", default=shutil.which("behaverify"), metavar="COMMAND")
    parser.add_argument("--nusmv", default=shutil.which("NuSMV"), metavar="COMMAND")
    options = parser.parse_args(arguments)
    if any(not 2 <= size <= MAX_SIZE for size in options.sizes):
        parser.error(f"a size from 2 to {MAX_SIZE} is expected")
    print("| cells | as2fm-lsp: estimate | time | BehaVerify with NuSMV: AF | translation | time |")
    print("| --- | --- | --- | --- | --- | --- |")
    for size in options.sizes:
        with tempfile.TemporaryDirectory() as folder:
            ours = estimated(size, Path(folder), options.as2fm)
            theirs = ["not installed", "", ""]
            if options.behaverify and options.nusmv:
                theirs = model_checked(size, Path(folder), options.behaverify, options.nusmv)
        print("|", " | ".join([f"{size} × {size}", *ours, *theirs]), "|", flush=True)
    return 0


def estimated(size: int, folder: Path, command: str) -> list[str]:
    """The estimate with its interval, and the seconds that it took."""
    shutil.copytree(HERE / "robot", folder / "robot")
    replace(folder / "robot/world.ascxml", '"size" type="int32" expr="10"', f'"size" type="int32" expr="{size}"')
    replace(folder / "robot/main.xml", 'max_time value="30"', f'max_time value="{3 * size}"')
    options = ("--method", "adaptive", "--scheduler", "uniform")
    seconds, said = timed([command, "verify", str(folder / "robot/main.xml"), *options])
    found = re.search(r"^arrives: (.*?) from", said, re.MULTILINE)
    return [found[1] if found else "no answer", seconds]


def model_checked(size: int, folder: Path, behaverify: str, nusmv: str) -> list[str]:
    """The verdict, and the seconds that the translation and the model checker took."""
    tree = folder / "grid.tree"
    shutil.copy(HERE / "grid.tree", tree)
    replace(tree, "last := 9", f"last := {size - 1}")
    translation, _ = timed([behaverify, "nuxmv", str(tree), str(folder / "smv"), "--generate"])
    (model,) = folder.glob("smv/**/*.smv")
    seconds, said = timed([nusmv, str(model)])
    found = re.search(r"^-- specification .* is (true|false)$", said, re.MULTILINE)
    return [found[1] if found else "no answer", translation, seconds]


def replace(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text, f"{path}: {old}"
    path.write_text(text.replace(old, new), encoding="utf-8")


def timed(command: Sequence[str]) -> tuple[str, str]:
    """The wall time of a command, and what it printed."""
    began = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return f"{time.perf_counter() - began:.2f} s", done.stdout + done.stderr


def _beside_python(name: str) -> str:
    """A command of the environment that runs this script, or else one on the path."""
    beside = Path(sys.executable).parent / name
    return str(beside) if beside.exists() else name


if __name__ == "__main__":
    sys.exit(main())
