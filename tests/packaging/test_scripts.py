# SPDX-License-Identifier: Apache-2.0
"""The scripts that set up a checkout and run its tests: their messages when a tool is missing or fails."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ("sh", "dirname", "cat", "cksum", "id", "rm", "mktemp", "nice", "sed", "wc", "sleep", "grep", "sort", "date")


def script(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


def run(path: Path, *arguments: str, environment: Mapping[str, str]) -> subprocess.CompletedProcess[str]:
    command = ["sh", str(path), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env={**environment})


@pytest.fixture
def tools(tmp_path: Path) -> Path:
    """A folder for `PATH` with the tools that scripts use, but no Python."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for name in TOOLS:
        tool = shutil.which(name)
        assert tool is not None
        (folder / name).symlink_to(tool)
    return folder


# ------------------------------------------------------------------ environment.sh


def fake_python(version: str) -> str:
    """A program that behaves like Python for the scripts."""
    major, minor, _ = version.split(".")
    return (
        f'case "$2" in *sys.exit*) exit {int((int(major), int(minor)) < (3, 10))};; *print*) echo {version};; '
        "*) mkdir -p .venv/bin; echo made >.venv/made;; esac"
    )


def prepared(tmp_path: Path, tools: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    tree = tmp_path / "tree"
    (tree / "tests").mkdir(parents=True, exist_ok=True)
    shutil.copy(ROOT / "tests/environment.sh", tree / "tests")
    script(tree / "set_up", 'cd "$(dirname "$0")"\n. tests/environment.sh\nfind_python')
    return run(tree / "set_up", environment={"PATH": str(tools), **environment})


def test_an_old_python_is_named(tmp_path: Path, tools: Path) -> None:
    script(tools / "python3", fake_python("3.9.2"))
    done = prepared(tmp_path, tools)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == (
        f"Python 3.9.2 at {tools / 'python3'} is too old; "
        "Python 3.10 or newer is needed: install it, or name it with PYTHON=/path/to/python3\n"
    )


def test_changes_of_all_compiled_modules_are_noticed(tmp_path: Path, tools: Path) -> None:
    tree = tmp_path / "tree"
    (tree / "tests").mkdir(parents=True)
    for name in ["pyproject.toml", "setup.py", "tests/environment.sh"]:
        shutil.copy(ROOT / name, tree / name)
    modules = re.findall(r'"(roaml\.\w+\.\w+)"', (ROOT / "setup.py").read_text())
    files = [tree / f"server/{name.replace('.', '/')}{suffix}" for name in modules for suffix in (".py", ".pxd")]
    files += [tree / f"server/roaml/smc/{name}.py" for name in ("opcodes", "program")]  # `setup.py` reads types there
    for file in files:
        file.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / file.relative_to(tree), file)
    script(tree / "sum_up", 'cd "$(dirname "$0")"\n. tests/environment.sh\ncompiled_from | cksum')
    shown = {run(tree / "sum_up", environment={"PATH": str(tools)}).stdout}
    for file in files:
        file.write_text(file.read_text() + "\n")
        shown.add(run(tree / "sum_up", environment={"PATH": str(tools)}).stdout)
    assert len(modules) > 1
    assert len(shown) == 1 + len(files)


def test_no_python(tmp_path: Path, tools: Path) -> None:
    script(tools / "python3", "exit 127")
    done = prepared(tmp_path, tools)
    assert done.stderr.startswith("Python 3.10 or newer is needed: ")


def test_a_newer_python_is_found_beside_an_old_one(tmp_path: Path, tools: Path) -> None:
    script(tools / "python3", fake_python("3.9.2"))
    script(tools / "python3.12", fake_python("3.12.1"))
    assert prepared(tmp_path, tools).stdout == "python3.12\n"
    script(tools / "mine", fake_python("3.10.0"))
    assert prepared(tmp_path, tools, PYTHON=str(tools / "mine")).stdout == f"{tools / 'mine'}\n"


# ---------------------------------------------------------------------------- run

REPORT = """<testsuites><testsuite><testcase classname="tests.cli.test_a" name="test_x[1]"><failure/></testcase>
<testcase classname="tests.cli.test_a" name="test_y"/><testcase classname="" name="tests/test_b.py"><error/></testcase>
</testsuite></testsuites>"""


@pytest.fixture
def tree(tmp_path: Path, tools: Path) -> Path:
    """A checkout with tools that do nothing."""
    folder = tmp_path / "tree"
    (folder / "tests").mkdir(parents=True)
    for name in ("run", "failed.py"):
        shutil.copy(ROOT / "tests" / name, folder / "tests")
    (folder / "tests/environment.sh").write_text("prepare_ruff() { :; }\nprepare() { :; }\n")
    (folder / "tests/vscode.sh").write_text("[ \"$1\" = --static ] || echo '  ✔ it draws'\n")
    for name in ("ruff", "mypy"):
        script(folder / ".venv/bin" / name, ":")
    script(folder / ".venv/bin/python", f'case "$*" in *pytest*) echo "$*";; *) exec {sys.executable} "$@";; esac')
    return folder


def test_all_passes(tree: Path, tools: Path) -> None:
    done = run(tree / "tests/run", environment=os.environ)
    assert (done.returncode, done.stderr) == (0, "")
    said = [line for line in done.stdout.splitlines() if line.startswith(("==", "  ✔"))]
    assert said == [
        "== Ruff, which is prepared first and alone",
        "== ruff check",
        "== ruff format",
        "== preparation, which takes a minute the first time",
        "== mypy",
        "== tests; meanwhile, those of the VS Code extension",
        "== VS Code extension",
        "  ✔ it draws",
        "== times:",
        "== all passed",
    ]


def test_ruff_is_installed_in_the_version_that_the_project_demands(tmp_path: Path) -> None:
    shutil.copy(ROOT / "tests/environment.sh", tmp_path)
    (tmp_path / "pyproject.toml").write_text('dev = [\n    "ruff==0.17.5",\n]\n')
    script(tmp_path / ".venv/bin/python", 'echo "$*"')
    script(tmp_path / "set_up", 'cd "$(dirname "$0")"\n. ./environment.sh\nprepare_ruff')
    done = run(tmp_path / "set_up", environment=os.environ)
    assert done.stdout.splitlines()[-1].endswith(" ruff==0.17.5")
    script(tmp_path / ".venv/bin/ruff", "echo ruff 0.17.4")
    assert run(tmp_path / "set_up", environment=os.environ).stdout.splitlines()[-1].endswith(" ruff==0.17.5")
    script(tmp_path / ".venv/bin/ruff", "echo ruff 0.17.5")
    assert run(tmp_path / "set_up", environment=os.environ).stdout == ""


def test_the_time_of_each_part_is_reported(tree: Path, tools: Path) -> None:
    done = run(tree / "tests/run", environment=os.environ)
    _, _, end = done.stdout.partition("== times:\n")
    python = ["preparation of Ruff", "ruff check", "ruff format", "preparation", "mypy", "tests"]
    parts = [*python, "VS Code extension, meanwhile"]
    assert re.fullmatch("".join(rf"  {part}: \d+ s\n" for part in parts) + "== all passed\n", end)
    done = run(tree / "tests/run", "tests/cli", environment=os.environ)
    assert re.search(r"== times:\n(  [\w ]+: \d+ s\n)+== all passed\n", done.stdout)


def test_all_that_failed_is_named_at_the_end(tree: Path) -> None:
    script(tree / ".venv/bin/mypy", "exit 1")
    fails = f"for last; do :; done; printf '%s' '{REPORT}' >\"${{last#--junitxml=}}\"; exit 1"
    script(tree / ".venv/bin/python", f'case "$*" in *pytest*) {fails};; *) exec {sys.executable} "$@";; esac')
    (tree / "tests/vscode.sh").write_text(
        "echo '✔ a'; [ \"$1\" = --static ] && exit; echo '  ✖ it draws (3 ms)'; echo 'failed: npm run e2e'; exit 1\n"
    )
    done = run(tree / "tests/run", environment=os.environ)
    assert done.returncode == 1
    assert done.stderr == (
        "== failed:\n  mypy\n  tests/cli/test_a.py::test_x[1]\n  tests/test_b.py\n"
        "  VS Code extension:\n    failed: npm run e2e\n    ✖ it draws (3 ms)\n"
    )
    assert "  ✖ it draws (3 ms)\n" in done.stdout, "it was shown while it ran, too"


def test_without_a_sound_extension_its_end_to_end_tests_do_not_run(tree: Path) -> None:
    (tree / "tests/vscode.sh").write_text("echo \"part $1\"; echo 'failed: npm run lint'; exit 1\n")
    done = run(tree / "tests/run", environment=os.environ)
    assert (done.returncode, done.stderr) == (1, "== failed:\n  VS Code extension:\n    failed: npm run lint\n")
    assert "part --static\n" in done.stdout
    assert "--end-to-end" not in done.stdout


def test_pytest_that_does_not_even_begin(tree: Path) -> None:
    script(tree / ".venv/bin/python", f'case "$*" in *pytest*) exit 4;; *) exec {sys.executable} "$@";; esac')
    done = run(tree / "tests/run", environment=os.environ)
    assert (done.returncode, done.stderr) == (1, "== failed:\n  tests: pytest itself, see above\n")


def test_arguments_go_to_pytest(tree: Path) -> None:
    done = run(tree / "tests/run", "tests/cli", "-x", environment=os.environ)
    assert done.returncode == 0
    assert "-m pytest tests/cli -x\n" in done.stdout
    assert "VS Code" not in done.stdout
