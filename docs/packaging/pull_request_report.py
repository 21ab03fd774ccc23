# SPDX-License-Identifier: Apache-2.0
"""`python docs/packaging/pull_request_report.py`: the step of action.yml that compares models with the base of a pull
request.

Each system of `SYSTEMS` is compared with its version in the commit `BASE`. The report and its pictures are written into
`$RUNNER_TEMP/NAME`; the report is added to the summary of the job, and is a comment of the pull request. A later report
replaces the comment, which is found by a marker. A token that cannot comment leads to a notice, not to a failure.

The outputs of the step are `comparison`, the path of the report, and `status`, which is 0, or 1 if a comparison failed.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

# The longest comment that GitHub accepts is 65,536 characters.
MAX_COMMENT = 60_000
_PAGE = 100
_IMAGE = re.compile(r"^!\[(?P<title>.*)\]\((?P<path>.*)\)$", re.MULTILINE)
_REFUSED = (401, 403, 404)


def main() -> None:
    given = os.environ
    if not given["BASE"]:
        _say(
            "notice", "There is nothing to compare with: the event has no pull request, and the input `base` is empty."
        )
        return
    folder = Path(given["RUNNER_TEMP"], given["NAME"])
    folder.mkdir(parents=True, exist_ok=True)
    reports = []
    failed = 0
    base = _fetched(given["BASE"])
    for system in shlex.split(given["SYSTEMS"]):
        report, status = compare(base, system, shlex.split(given["ARGUMENTS"]), folder)
        reports.append(report)
        failed = max(failed, status)
    path = folder / "comparison.md"
    path.write_text("\n".join(reports), encoding="utf-8")
    shown = as_comment("\n".join(reports), given["NAME"], _run_address(given))
    _append(given["GITHUB_STEP_SUMMARY"], shown)
    _append(given["GITHUB_OUTPUT"], f"comparison={path}\nstatus={failed}\n")
    if given["PULL_REQUEST"]:
        comment(given, shown)


def _fetched(base: str) -> str:
    """The short name of a commit of the remote repository, which may be missing in a checkout of depth 1."""
    if subprocess.run(["git", "cat-file", "-e", f"{base}^{{commit}}"], capture_output=True, check=False).returncode:
        subprocess.run(["git", "fetch", "--quiet", "--depth", "1", "origin", base], check=True)
    short = ["git", "rev-parse", "--short", f"{base}^{{commit}}"]
    return subprocess.run(short, stdout=subprocess.PIPE, text=True, check=True).stdout.strip()


def compare(base: str, system: str, arguments: Sequence[str], folder: Path) -> tuple[str, int]:
    """The report on a system, and 1 if the comparison failed, otherwise 0.

    Args:
        folder: for the pictures.
    """
    old = f"{base}:./{system}"
    if subprocess.run(["git", "cat-file", "-e", old], capture_output=True, check=False).returncode:
        return f"### `{system}`\n\nThe base `{base}` does not contain this file.\n", 0
    name = re.sub(r"\W", "_", system)
    report = folder / f"{name}.md"
    command = [sys.executable, "-m", "as2fm_lsp", "compare", old, system, "--fail-on", "expectation"]
    outputs = ["--format", "markdown", "--output", str(report), "--pictures", str(folder / name)]
    status = subprocess.run([*command, *arguments, *outputs], check=False).returncode
    if not report.exists():
        return f"### `{system}`\n\nThe comparison failed; the log of the job contains the reason.\n", 1
    text = report.read_text(encoding="utf-8")
    report.unlink()
    return text, int(status != 0)


def as_comment(report: str, artifact: str, run: str) -> str:
    """The report for a place without its pictures: comments and summaries do not show relative links. Each picture is
    replaced by a sentence that names its file. A report that is too long for a comment ends before a section."""

    def named(image: re.Match[str]) -> str:
        title, path = image["title"], image["path"].replace("%20", " ")
        return f"Picture of the {title}: `{path}` in the artifact `{artifact}` of [this run]({run})."

    text = _IMAGE.sub(named, report)
    if len(text) <= MAX_COMMENT:
        return text
    end = max(text.rfind("\n#### ", 0, MAX_COMMENT), text.rfind("\n### ", 0, MAX_COMMENT), 0)
    return f"{text[:end]}\n\nThe report is longer: `comparison.md` in the artifact `{artifact}` of [this run]({run}).\n"


def comment(given: Mapping[str, str], report: str) -> None:
    """Create or replace the comment of the pull request."""
    marker = f"<!-- as2fm-lsp compare: {given['NAME']} -->"
    issues = f"{given['GITHUB_API_URL']}/repos/{given['GITHUB_REPOSITORY']}/issues"
    comments = f"{issues}/{given['PULL_REQUEST']}/comments"
    body = {"body": f"{marker}\n{report}"}
    try:
        found = _earlier(given["GITHUB_TOKEN"], comments, marker)
        if found is None:
            _request(given["GITHUB_TOKEN"], "POST", comments, body)
        else:
            _request(given["GITHUB_TOKEN"], "PATCH", f"{issues}/comments/{found}", body)
    except urllib.error.HTTPError as error:
        if error.code in _REFUSED:
            _say("notice", f"The token cannot comment on the pull request (HTTP {error.code}): the job needs the "
                 "permission `pull-requests: write`, which pull requests from forks never have. The summary of the job "
                 "contains the report.")  # fmt: skip
        else:
            _say("warning", f"GitHub did not accept the comment (HTTP {error.code}). The summary of the job contains "
                 "the report.")  # fmt: skip
    except OSError as error:
        _say("warning", f"GitHub could not be reached ({error}). The summary of the job contains the report.")


def _earlier(token: str, comments: str, marker: str) -> int | None:
    """The number of the comment with the marker. A comment of a person who copied the marker is never replaced."""
    page = 0
    while True:
        page += 1
        found = _request(token, "GET", f"{comments}?per_page={_PAGE}&page={page}")
        for one in found:
            if one["user"]["type"] == "Bot" and one["body"].startswith(marker):
                return int(one["id"])
        if len(found) < _PAGE:
            return None


def _request(token: str, method: str, address: str, content: Mapping[str, str] | None = None) -> Any:
    data = None if content is None else json.dumps(content).encode()
    headers = {"Authorization": f"Bearer {token}", "Accept": "application/vnd.github+json"}
    request = urllib.request.Request(address, data, headers, method=method)
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.load(answer)


def _run_address(given: Mapping[str, str]) -> str:
    return f"{given['GITHUB_SERVER_URL']}/{given['GITHUB_REPOSITORY']}/actions/runs/{given['GITHUB_RUN_ID']}"


def _append(path: str, text: str) -> None:
    with open(path, "a", encoding="utf-8") as file:
        file.write(text)


def _say(level: str, text: str) -> None:
    print(f"::{level} title=as2fm-lsp compare::{text}", flush=True)


if __name__ == "__main__":
    main()
