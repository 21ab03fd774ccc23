# SPDX-License-Identifier: Apache-2.0
"""The hook and the workflows that the project provides: their commands, as far as they can run without network."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from command import Command

import clock

ROOT = Path(__file__).resolve().parents[2]
HOOKS = re.split(r"^(?=- id:)", (ROOT / ".pre-commit-hooks.yaml").read_text(), flags=re.MULTILINE)[1:]
CHECK, FORMAT = HOOKS
GITHUB = (ROOT / "docs/ci/github.yml").read_text()
GITLAB = (ROOT / "docs/ci/gitlab.yml").read_text()
README = (ROOT / "README.md").read_text()


def values(text: str, key: str) -> list[str]:
    """The plain scalars of a key in a simple YAML file."""
    return re.findall(rf"^\s*(?:- )?{key}: (.*?)\s*$", text, re.MULTILINE)


def items(text: str) -> list[str]:
    """The plain scalars that are items of lists."""
    return re.findall(r"^\s*- ([^:\n]*)$", text, re.MULTILINE)


def call(command: Command, line: str) -> int:
    program, *arguments = shlex.split(line)
    assert program == "as2fm-lsp"
    return command(*arguments).status


# ------------------------------------------------------------------ pre-commit


@pytest.mark.parametrize("hook", HOOKS)
def test_the_hooks_are_those_that_the_readme_names(hook: str) -> None:
    (name,) = values(hook, "id")
    assert f"`{name}`" in README
    assert values(hook, "language") == ["python"]


@pytest.mark.parametrize(
    ("name", "concerned"),
    [
        ("main.xml", True),
        ("a/b c.ascxml", True),
        ("x.scxml", True),
        ("p.jani", True),
        ("types.json", True),
        ("m/msg/A.msg", True),
        ("m/srv/A.srv", True),
        ("m/action/A.action", True),
        ("README.md", False),
        ("ascxml", False),
        ("x.ascxml.orig", False),
    ],
)
def test_the_hook_runs_when_a_model_changes(name: str, concerned: bool) -> None:
    (pattern,) = values(CHECK, "files")
    assert bool(re.search(pattern, name)) is concerned


def test_the_hook_finds_what_a_staged_change_breaks_elsewhere(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    git = ["git", "-c", "user.name=n", "-c", "user.email=e@example.com"]
    for arguments in (["init", "-q"], ["add", "."], ["commit", "-qm", "first"]):
        subprocess.run([*git, *arguments], cwd=tmp_path, check=True)
    (entry,) = values(CHECK, "entry")
    names = [] if values(CHECK, "pass_filenames") == ["false"] else ["clock.ascxml"]
    line = shlex.join([*shlex.split(entry), *names])
    assert call(command, line) == 0
    (tmp_path / "clock.ascxml").write_text(clock.CLOCK.replace("/ticks", "/tocks"))
    subprocess.run([*git, "add", "clock.ascxml"], cwd=tmp_path, check=True)
    assert call(command, line) == 1, "properties.jani still names the old topic"


def test_the_hook_with_the_installed_program(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    (entry,) = values(CHECK, "entry")
    program, *arguments = shlex.split(entry)
    done = subprocess.run(
        [Path(sys.executable).parent / program, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (1, "")
    assert done.stdout.startswith("clock.ascxml:9:31: error: ")


@pytest.mark.parametrize(("more", "status", "written"), [([], 0, True), (["--check"], 1, False)], ids=str)
def test_the_hook_that_formats(command: Command, tmp_path: Path, more: list[str], status: int, written: bool) -> None:
    """pre-commit appends the arguments of a hook to its entry, and detects changed files itself."""
    untidy = clock.CLOCK.replace("    <datamodel>", "<datamodel  >")
    clock.write(tmp_path, clock=untidy)
    foreign = tmp_path / "package.xml"
    foreign.write_text("<package  ></package>")
    (entry,) = values(FORMAT, "entry")
    names = [] if values(FORMAT, "pass_filenames") == ["false"] else ["clock.ascxml", "package.xml"]
    assert call(command, shlex.join([*shlex.split(entry), *more, *names])) == status
    assert ((tmp_path / "clock.ascxml").read_text() != untidy) is written
    assert foreign.read_text() == "<package  ></package>"


# ------------------------------------------------------------------- workflows


def test_workflows_install_from_the_repository() -> None:
    """The workflows install from the repository, because the package is on no index."""
    installs = [line for text in (GITHUB, README) for line in values(text, "run") if line.startswith("pip")]
    installs += [line for line in items(GITLAB) if line.startswith("pip")]
    assert set(installs) == {"pip install git+$AS2FM_REPOSITORY"}


def test_the_workflow_of_github(command: Command, tmp_path: Path) -> None:
    check, report = (line for line in values(GITHUB, "run") if not line.startswith("pip"))
    clock.write(tmp_path)
    assert call(command, check) == 0
    clock.write(
        tmp_path, clock=clock.CLOCK.replace("<datamodel>", "<datamodle>").replace("</datamodel>", "</datamodle>")
    )
    assert call(command, check) == 1
    line, _, otherwise = report.partition(" || ")
    assert otherwise == "true", "a finding must not keep the report from being uploaded"
    call(command, line)
    (uploaded,) = values(GITHUB, "sarif_file")
    assert json.loads((tmp_path / uploaded).read_text())["version"] == "2.1.0"


def test_the_workflow_of_gitlab(command: Command, tmp_path: Path) -> None:
    (check,) = (line for line in items(GITLAB) if line.startswith("as2fm-lsp"))
    clock.write(tmp_path)
    assert call(command, check) == 0
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    assert call(command, check) == 1
    (uploaded,) = values(GITLAB, "codequality")
    assert [row["check_name"] for row in json.loads((tmp_path / uploaded).read_text())] == ["undeclared-variable"]
    assert values(GITLAB, "when") == ["always"], "the report is wanted when the check has failed"


def test_the_snippet_in_the_readme(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    lines = [line for line in values(README, "run") if not line.startswith("pip")]
    assert lines
    for line in lines:
        assert call(command, line) == 0
