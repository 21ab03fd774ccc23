# SPDX-License-Identifier: Apache-2.0
"""`python docs/packaging/release_version.py [TAG]`: check that everything that is released has one version.

The version is that of `pyproject.toml`. The library, the VS Code extension, the conda recipe and the ROS package must
have it too; with a tag such as `v0.2.0`, the tag must be that version, and the changelog must have a section for it.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def _in(path: str, pattern: str) -> str:
    match = re.search(pattern, (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE)
    return match[1] if match else "none"


def versions() -> dict[str, str]:
    """The version that each file states, by the path of the file."""
    return {
        "pyproject.toml": _in("pyproject.toml", r'^version = "(.*)"'),
        "server/roaml/__init__.py": _in("server/roaml/__init__.py", r'^__version__ = "(.*)"'),
        "vscode-extension/package.json": json.loads((ROOT / "vscode-extension/package.json").read_text())["version"],
        "docs/packaging/conda/recipe.yaml": _in("docs/packaging/conda/recipe.yaml", r"^  version: (.*)"),
        "docs/packaging/ament_cmake_as2fm/package.xml": _in(
            "docs/packaging/ament_cmake_as2fm/package.xml", r"<version>(.*)</version>"
        ),
    }


def problems(tag: str | None) -> list[str]:
    """What prevents a release, one line for each problem."""
    stated = versions()
    version = stated["pyproject.toml"]
    found = [
        f"{path} has version {other}, pyproject.toml has {version}"
        for path, other in stated.items()
        if other != version
    ]
    if tag is not None and tag != f"v{version}":
        found.append(f"the tag is {tag}, the version is {version}: tag v{version}, or change the version")
    if tag is not None and f"\n## [{version}]" not in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"):
        found.append(f"CHANGELOG.md has no section [{version}]")
    return found


def main(arguments: list[str]) -> int:
    found = problems(arguments[0] if arguments else None)
    print("\n".join(found), file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
