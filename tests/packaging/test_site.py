# SPDX-License-Identifier: Apache-2.0
"""The navigation of the website contains each page of the documentation."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WRITTEN = {"docs/reference/library.md"}
"""Pages that only the website has; `docs/site.py` writes them."""


def test_the_navigation_is_complete() -> None:
    settings = (ROOT / "docs/mkdocs.yml").read_text(encoding="utf-8")
    listed = re.findall(r"^ +- (?:.*: )?(\S+\.md)$", settings, re.MULTILINE)
    assert len(listed) == len(set(listed))
    pages = {path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md")}
    assert pages | WRITTEN <= set(listed)
    assert all((ROOT / path).exists() for path in set(listed) - WRITTEN)


def test_the_index_links_to_each_page() -> None:
    index = (ROOT / "docs/README.md").read_text(encoding="utf-8")
    pages = {path.name for path in (ROOT / "docs").glob("*.md")} - {"README.md"}
    assert pages <= set(re.findall(r"\]\(([A-Za-z0-9-]+\.md)\)", index))
