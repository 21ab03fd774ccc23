# SPDX-License-Identifier: Apache-2.0
"""`python tests/packaging/action_steps.py ACTION PATHS`: run the shell steps of a GitHub action as the runner does.

The environment is that of `RUNNER_TEMP`, in which as2fm-lsp is installed already; the step that installs it is left
out. The steps run in a shallow clone, as for a pull request that changes examples/grid_world; GitHub is a local server.
Inputs have their defaults, except `paths`, `sarif`, `verify` and `compare`. Steps that use another action do not run.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from fake_github import PULL_REQUEST, REPOSITORY, fake_github
from ruamel.yaml import YAML

SYSTEM = "examples/grid_world/main.xml"
_EXPRESSION = re.compile(r"\$\{\{ *(.*?) *\}\}")
_CONDITION = re.compile(r"(\S+) != ''")


def main(action: str, paths: str) -> None:
    definition = YAML(typ="safe").load(Path(action))
    with tempfile.TemporaryDirectory() as name, fake_github() as github:
        folder = Path(name)
        sarif = folder / "findings.sarif"
        checkout, base = pull_request(folder)
        values = {
            "github.action_path": str(Path(action).resolve().parent),
            "github.event.pull_request.base.sha": base,
            "github.event.pull_request.number": PULL_REQUEST,
            "github.token": "token",
        }
        for key, given in definition["inputs"].items():
            values[f"inputs.{key}"] = expanded(str(given.get("default", "")), values)
        values |= {"inputs.paths": paths, "inputs.sarif": str(sarif), "inputs.verify": SYSTEM, "inputs.compare": SYSTEM}
        values["inputs.verify-arguments"] = '--expect "arrives >= 0.9"'
        runner = {
            "GITHUB_API_URL": github.address,
            "GITHUB_OUTPUT": str(folder / "output"),
            "GITHUB_REPOSITORY": REPOSITORY,
            "GITHUB_RUN_ID": "1",
            "GITHUB_SERVER_URL": "https://github.com",
            "GITHUB_STEP_SUMMARY": str(folder / "summary.md"),
        }
        for step in definition["runs"]["steps"]:
            if "run" in step and step["name"] != "Install" and holds(step, values):
                run(step, values, {**os.environ, **runner}, checkout)
        assert '"version": "2.1.0"' in sarif.read_text(encoding="utf-8")
        report = Path(values["steps.compare.outputs.comparison"])
        assert re.search(r"^!\[.*\]\((.*\.svg)\)$", report.read_text(encoding="utf-8"), re.MULTILINE)
        assert list(report.parent.glob("*/*.svg"))
        (comment,) = github.comments
        assert f"`{SYSTEM}`" in comment["body"]
        assert "![" not in comment["body"]
        assert comment["body"].endswith(Path(runner["GITHUB_STEP_SUMMARY"]).read_text(encoding="utf-8"))


def pull_request(folder: Path) -> tuple[Path, str]:
    """A checkout as that of actions/checkout for a pull request, and the commit of its base."""
    origin, checkout = folder / "origin", folder / "checkout"
    shutil.copytree("examples", origin / "examples")

    def git(*arguments: str) -> str:
        author = ("-c", "user.name=Test", "-c", "user.email=test@example.org", "-c", "commit.gpgsign=false")
        command = ["git", "-C", str(origin), *author, *arguments]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()

    git("init", "--quiet")
    git("add", ".")
    git("commit", "--quiet", "--message", "base")
    base = git("rev-parse", "HEAD")
    robot = origin / "examples/grid_world/robot.ascxml"
    text = robot.read_text(encoding="utf-8")
    state = re.search(r"<state id=\"\w+\"", text)
    assert state is not None
    robot.write_text(f'{text[: state.start()]}<state id="added" />{text[state.start() :]}', encoding="utf-8")
    git("commit", "--quiet", "--all", "--message", "change")
    clone = ["git", "clone", "--quiet", "--depth", "1", origin.as_uri(), str(checkout)]
    subprocess.run(clone, check=True)
    return checkout, base


def expanded(text: str, values: dict[str, str]) -> str:
    """The text with the values of its expressions, which are alternatives joined by `||`."""

    def value(expression: re.Match[str]) -> str:
        return next((v for name in expression[1].split(" || ") if (v := values[name])), "")

    return _EXPRESSION.sub(value, text)


def holds(step: dict[str, Any], values: dict[str, str]) -> bool:
    if "if" not in step:
        return True
    condition = _CONDITION.fullmatch(step["if"])
    assert condition is not None, f"{step['if']} is not supported"
    return values.get(condition[1], "") != ""


def run(step: dict[str, Any], values: dict[str, str], environment: dict[str, str], checkout: Path) -> None:
    """Run a step, and add its outputs to the values."""
    env = environment | {name: expanded(text, values) for name, text in step.get("env", {}).items()}
    print(f"-- {step['name']}", flush=True)
    subprocess.run(["bash", "-e", "-o", "pipefail", "-c", step["run"]], env=env, cwd=checkout, check=True)
    output = Path(env["GITHUB_OUTPUT"])
    if "id" in step and output.exists():
        for line in output.read_text(encoding="utf-8").splitlines():
            name, _, value = line.partition("=")
            values[f"steps.{step['id']}.outputs.{name}"] = value


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
