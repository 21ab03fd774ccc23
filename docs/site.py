# SPDX-License-Identifier: Apache-2.0
"""Collects the pages of the website in `build/pages`; `docs/site.sh` builds it.

The pages are copies of the Markdown files of the checkout, in the same folders, so that all links are those of the
repository. Two parts are written: the navigation, from `docs/mkdocs.yml` and the documents of the rules, and the
reference of the library, from `roaml.api.__all__`.

MkDocs with the theme Material was chosen because it reads these files as they are, with links to files and headings as
in the repository, and reports links that lead nowhere. Sphinx with MyST needs a second syntax for the API and a
`toctree` in each page.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from roaml import api
from roaml.rules import RULES

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "build/pages"
COPIED = ("*.md", "*.svg", "*.png", "docs/*", "examples/*", "schemas/*", "pyproject.toml", "action.yml", "Dockerfile")


def main() -> None:
    shutil.rmtree(PAGES, ignore_errors=True)
    for path in _tracked():
        target = PAGES / "source" / path
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, target)
    reference = PAGES / "source/docs/reference/library.md"
    reference.write_text(_library_reference(), encoding="utf-8")
    settings = (ROOT / "docs/mkdocs.yml").read_text(encoding="utf-8")
    (PAGES / "mkdocs.yml").write_text(settings.replace("      - RULES\n", _rules()), encoding="utf-8")


def _tracked() -> list[str]:
    command = ["git", "ls-files", "--", *COPIED, ".github/workflows/release.yml", ".pre-commit-hooks.yaml"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()


def _rules() -> str:
    """The entries of the navigation for the documents of the rules."""
    documents = {path.stem: path for path in (ROOT / "server/roaml/rules").glob("*/*.md")}
    codes = sorted(rule.code for rule in RULES if rule.code in documents)
    return "".join(f"      - {code}: {documents[code].relative_to(ROOT).as_posix()}\n" for code in codes)


def _library_reference() -> str:
    """The page that `mkdocstrings` fills from the docstrings of the public names."""
    lines = [
        "# Library: reference\n",
        "All names are imported from `roaml.api`. [The library](../library.md) has examples.\n",
    ]
    for name in sorted(api.__all__, key=str.lower):
        origin = getattr(api, name)
        module = getattr(origin, "__module__", None)
        if module and module.startswith("roaml"):
            lines.append(f"::: {module}.{getattr(origin, '__name__', name)}\n")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
