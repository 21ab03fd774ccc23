# SPDX-License-Identifier: Apache-2.0
"""Keep everything that is released at one version.

`python docs/packaging/release_version.py [TAG]` checks that all files state the version of `pyproject.toml`; with a tag
such as `v0.2.0`, that the tag is that version, and that all changes are in its section of the changelog. With
`--set TAG`, it writes the version of the tag into all files, and moves the unreleased changes into its section.
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
    if tag is not None:
        _, unreleased, rest = changelog(root)
        if not rest.startswith(f"## [{version}]"):
            found.append(f"{CHANGELOG} has no section [{version}] after [Unreleased]")
        if unreleased.strip():
            found.append(f"{CHANGELOG} has unreleased changes: run this program with --set v{version}")
    return found


def changelog(root: Path = ROOT) -> tuple[str, str, str]:
    """The changelog up to the heading of the unreleased changes, these changes, and the sections after them."""
    head, heading, rest = (root / CHANGELOG).read_text(encoding="utf-8").partition(UNRELEASED)
    unreleased, next_section, released = rest.partition("\n## ")
    return head + heading, unreleased + "\n", next_section.removeprefix("\n") + released


def set_version(tag: str, today: datetime.date, root: Path = ROOT) -> None:
    """Write the version of a tag into all files, and move the unreleased changes into its section of the changelog. A
    section that was written before the tag gets the date of today."""
    version = tag.removeprefix("v")
    for path, pattern in PLACES:
        file = root / path
        text = file.read_text(encoding="utf-8")
        file.write_text(re.sub(pattern, rf"\g<1>{version}\g<3>", text, count=1, flags=re.MULTILINE), encoding="utf-8")
    head, unreleased, rest = changelog(root)
    heading, section, older = f"## [{version}]", "", rest
    if rest.startswith(heading):
        if not unreleased.strip():
            return
        section, next_section, older = rest.partition("\n")[2].partition("\n## ")
        older = next_section.lstrip() + older
    section = with_changes(section, unreleased)
    text = f"{head}\n{heading} - {today:%Y-%m-%d}\n\n{section}\n{older}"
    (root / CHANGELOG).write_text(text.rstrip() + "\n", encoding="utf-8")


def with_changes(section: str, changes: str) -> str:
    """A section of the changelog with further changes, which come first below the heading of their kind."""
    kinds: dict[str, list[str]] = {}
    for text in (changes, section):
        for part in f"\n{text}".split("\n### ")[1:]:
            kind, _, entries = part.partition("\n")
            kinds.setdefault(kind, []).append(entries.strip())
    parts = []
    for kind, texts in kinds.items():
        separator = "\n" if texts[-1].startswith("- ") else "\n\n"
        parts.append(f"### {kind}\n\n{separator.join(texts)}\n")
    return "\n".join(parts)


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--set"]:
        set_version(arguments[1], datetime.date.today())
        arguments = arguments[1:]
    found = problems(arguments[0] if arguments else None)
    print("\n".join(found), file=sys.stderr, end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
