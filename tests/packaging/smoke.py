# SPDX-License-Identifier: Apache-2.0
"""`python tests/packaging/smoke.py [--compiled | --plain]`: the main job, with the as2fm-lsp that this Python has.

It writes a system, checks, translates and verifies it, in a folder of its own. With `--compiled` or `--plain`, the
kernel must be compiled or plain Python. It needs only the installed package, so that it can test every artefact.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

EXPECTED_KERNEL = {"--compiled": "kernel: compiled", "--plain": "kernel: plain Python"}


def run(folder: str, *arguments: str) -> str:
    """The output of as2fm-lsp; raises `CalledProcessError` if it fails."""
    command = [sys.executable, "-I", "-m", "as2fm_lsp", *arguments]
    done = subprocess.run(command, cwd=folder, check=True, stdout=subprocess.PIPE, text=True, encoding="utf-8")
    return done.stdout


def main(options: list[str]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        version = run(folder, "--version")
        for option in options:
            assert EXPECTED_KERNEL[option] in version, version
        run(folder, "init", "robot")
        assert "9 files checked: 1 information" in run(folder, "--check", "robot")
        run(folder, "translate", "robot/main.xml", "-o", "robot.jani")
        assert Path(folder, "robot.jani").stat().st_size > 1000
        traces = ("--property", "never_empty", "--method", "fixed", "--max-traces", "5", "--scheduler", "uniform")
        assert run(folder, "verify", "robot/main.xml", *traces).startswith("never_empty: 1 in ")
    print(f"{version.strip()}: init, check, translate and verify work")


if __name__ == "__main__":
    main(sys.argv[1:])
