# SPDX-License-Identifier: Apache-2.0
"""The report of a comparison on a pull request: its comment is created once and replaced, and pictures are named."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from fake_github import PULL_REQUEST, REPOSITORY, FakeGithub, fake_github

ROOT = Path(__file__).resolve().parents[2]
SPEC = importlib.util.spec_from_file_location("pull_request_report", ROOT / "docs/packaging/pull_request_report.py")
assert SPEC is not None
assert SPEC.loader is not None
pull_request_report = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(pull_request_report)

RUN = "https://github.com/owner/robots/actions/runs/1"
MARKER = "<!-- as2fm-lsp compare: comparison -->\n"
MACHINE = '<ascxml name="Door" version="1.0" initial="open"><state id="open" />{}</ascxml>\n'


@pytest.fixture
def github() -> Iterator[FakeGithub]:
    with fake_github() as server:
        yield server


def comment(github: FakeGithub, report: str) -> None:
    given = {"GITHUB_API_URL": github.address, "GITHUB_REPOSITORY": REPOSITORY, "GITHUB_TOKEN": "token"}
    pull_request_report.comment(given | {"NAME": "comparison", "PULL_REQUEST": PULL_REQUEST}, report)


def test_the_comment_of_the_first_report_is_replaced_by_the_second(github: FakeGithub) -> None:
    for _ in range(150):
        github.add("a remark", "User")
    github.add(f"{MARKER}copied", "User")
    comment(github, "first")
    comment(github, "second")
    assert [c["body"] for c in github.comments[150:]] == [f"{MARKER}copied", f"{MARKER}second"]


def test_a_token_that_cannot_comment_leads_to_a_notice(github: FakeGithub, capsys: pytest.CaptureFixture[str]) -> None:
    github.refusal = 403
    comment(github, "report")
    assert github.comments == []
    output = capsys.readouterr().out
    assert output.startswith("::notice ")
    assert "`pull-requests: write`" in output


@pytest.mark.parametrize("is_stopped", [False, True])
def test_a_failure_of_github_leads_to_a_warning(
    github: FakeGithub, capsys: pytest.CaptureFixture[str], is_stopped: bool
) -> None:
    github.refusal = 502
    if is_stopped:
        github.address = "http://127.0.0.1:1"
    comment(github, "report")
    assert capsys.readouterr().out.startswith("::warning ")


def test_pictures_are_named_instead_of_shown() -> None:
    report = "#### Tree\n\n![tree: 1 added](a%20b/tree.svg)\n\n```diff\n+ node\n```\n"
    sentence = f"Picture of the tree: 1 added: `a b/tree.svg` in the artifact `comparison` of [this run]({RUN})."
    expected = f"#### Tree\n\n{sentence}\n\n```diff\n+ node\n```\n"
    assert pull_request_report.as_comment(report, "comparison", RUN) == expected


def test_a_long_report_ends_before_a_section() -> None:
    section = "\n#### Files\n\n```diff\n" + "+ file\n" * 2000 + "```\n"
    shown = pull_request_report.as_comment("### Models\n" + section * 6, "comparison", RUN)
    assert len(shown) < pull_request_report.MAX_COMMENT + 500
    assert shown.count("```") == 2 * shown.count("#### Files") > 0
    assert shown.endswith(f"`comparison.md` in the artifact `comparison` of [this run]({RUN}).\n")


def git(folder: Path, *arguments: str) -> str:
    author = ("-c", "user.name=Test", "-c", "user.email=test@example.org", "-c", "commit.gpgsign=false")
    command = ["git", "-C", str(folder), *author, *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def run_step(tmp_path: Path, systems: str, base: str) -> subprocess.CompletedProcess[str]:
    environment = {
        "PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin",
        "ARGUMENTS": "",
        "BASE": base,
        "GITHUB_OUTPUT": str(tmp_path / "output"),
        "GITHUB_REPOSITORY": REPOSITORY,
        "GITHUB_RUN_ID": "1",
        "GITHUB_SERVER_URL": "https://github.com",
        "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md"),
        "NAME": "comparison",
        "PULL_REQUEST": "",
        "RUNNER_TEMP": str(tmp_path),
        "SYSTEMS": systems,
    }
    command = [sys.executable, str(ROOT / "docs/packaging/pull_request_report.py")]
    return subprocess.run(
        command, env=environment, cwd=tmp_path / "models", capture_output=True, text=True, check=False
    )


def test_new_files_and_failures_are_reported(tmp_path: Path) -> None:
    """A file that the base does not have has no changes; a comparison that fails is the status, not an exception."""
    models = tmp_path / "models"
    models.mkdir()
    git(models, "init", "--quiet")
    for name in ("door", "broken"):
        (models / f"{name}.ascxml").write_text(MACHINE.format(""))
    git(models, "add", ".")
    git(models, "commit", "--quiet", "--message", "base")
    base = git(models, "rev-parse", "HEAD")
    (models / "door.ascxml").write_text(MACHINE.format('<state id="shut" />'))
    (models / "new.ascxml").write_text(MACHINE.format(""))
    (models / "broken.ascxml").unlink()
    result = run_step(tmp_path, "door.ascxml new.ascxml broken.ascxml", base)
    assert result.returncode == 0, result.stderr
    report = tmp_path / "comparison/comparison.md"
    assert (tmp_path / "output").read_text() == f"comparison={report}\nstatus=1\n"
    text = (tmp_path / "summary.md").read_text()
    assert "+ state `shut`" in text
    assert "### `new.ascxml`\n\nThe base " in text
    assert "### `broken.ascxml`\n\nThe comparison failed" in text


def test_an_event_without_pull_request_has_nothing_to_compare(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    result = run_step(tmp_path, "door.ascxml", "")
    assert result.returncode == 0
    assert result.stdout.startswith("::notice ")
    assert not (tmp_path / "output").exists()
