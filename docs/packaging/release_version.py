# SPDX-License-Identifier: Apache-2.0
"""Keep everything that is released at one version.

`python docs/packaging/release_version.py [TAG]` checks that all files state the version of `pyproject.toml`; with a tag
such as `v0.2.0`, that the tag is that version, and that the changelog has a section for it. With `--set TAG`, it writes
the version of the tag into all files, and makes the unreleased changes a section of the changelog.
"""

from __future__ import annotations

import datetime
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROJECT = "pyproject.toml"
PLACES = (
    (PROJECT, r'^(version = ")(.*)(")'),
    ("server/roaml/__init__.py", r'^(__version__ = ")(.*)(")'),
    ("vscode-extension/package.json", r'^(    "version": ")(.*)(")'),
    ("vscode-extension/package-lock.json", r'\A(\{\n.*\n    "version": ")(.*)(")'),
    ("vscode-extension/package-lock.json", r'^(        "": \{\n.*\n            "version": ")(.*)(")'),
    ("docs/packaging/conda/recipe.yaml", r"^(  version: )(.*)($)"),
    ("docs/packaging/ament_cmake_as2fm/package.xml", r"(<version>)(.*)(</version>)"),
    ("docs/packaging/README.md", r"(as2fm-lsp@v)(.*)(      # the repository)"),
    ("docs/packaging/editors/mason.yaml", r"(as2fm-lsp@)(.*)($)"),
    ("CITATION.cff", r"^(version: )(.*)($)"),
)
"""The places that state the version: the path of the file, and a pattern whose second group is the version."""
CHANGELOG = "CHANGELOG.md"
UNRELEASED = "## [Unreleased]\n"


def stated(root: Path = ROOT) -> list[tuple[str, str]]:
    """Path and version of each place; the version is `none` if the pattern does not match."""
    found = []
    for path, pattern in PLACES:
        match = re.search(pattern, (root / path).read_text(encoding="utf-8"), re.MULTILINE)
        found.append((path, match[2] if match else "none"))
    return found


def problems(tag: str | None, root: Path = ROOT) -> list[str]:
    """What prevents a release, one line for each problem."""
    versions = stated(root)
    version = versions[0][1]
    found = [f"{path} has version {other}, {PROJECT} has {version}" for path, other in versions if other != version]
    if tag is not None and tag != f"v{version}":
        found.append(
            f"the tag is {tag}, the version is {version}: tag v{version}, or run this program with --set {tag}"
        )
    if tag is not None and f"\n## [{version}]" not in (root / CHANGELOG).read_text(encoding="utf-8"):
        found.append(f"{CHANGELOG} has no section [{version}]")
    return found


def set_version(tag: str, today: datetime.date, root: Path = ROOT) -> None:
    """Write the version of a tag into all files. If the changelog has no section for it, the unreleased changes become
    one."""
    version = tag.removeprefix("v")
    for path, pattern in PLACES:
        file = root / path
        text = file.read_text(encoding="utf-8")
        file.write_text(re.sub(pattern, rf"\g<1>{version}\g<3>", text, count=1, flags=re.MULTILINE), encoding="utf-8")
    file = root / CHANGELOG
    text = file.read_text(encoding="utf-8")
    if f"\n## [{version}]" not in text:
        text = text.replace(UNRELEASED, f"{UNRELEASED}\n## [{version}] - {today:%Y-%m-%d}\n", 1)
        file.write_text(text, encoding="utf-8")


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--set"]:
        set_version(arguments[1], datetime.date.today())
        arguments = arguments[1:]
    found = problems(arguments[0] if arguments else None)
    print("\n".join(found), file=sys.stderr, end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
