# SPDX-License-Identifier: Apache-2.0
"""The entries for the registries of editors are those of `docs/editors.md`, and start the program of the package."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
ENTRIES = ROOT / "docs/packaging/editors"
PAGE = (ROOT / "docs/editors.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
(PROGRAM,) = PROJECT["scripts"]


def test_helix() -> None:
    entry = tomllib.loads((ENTRIES / "helix.toml").read_text(encoding="utf-8"))
    shown = re.search(r"```toml\n(\[language-server\.as2fm\].*?)```", PAGE, re.DOTALL)
    assert shown is not None
    assert entry == tomllib.loads(shown[1])
    assert entry["language-server"]["as2fm"]["command"] == PROGRAM


def test_nvim_lspconfig() -> None:
    entry = (ENTRIES / "as2fm_lsp.lua").read_text(encoding="utf-8")
    shown = re.search(r"```lua\n(vim\.filetype.*?)```", PAGE, re.DOTALL)
    assert shown is not None
    for name in ("cmd", "filetypes", "root_markers"):
        (line,) = re.findall(rf"^    {name} = .*$", entry, re.MULTILINE)
        assert line in shown[1], name
    assert shown[1].splitlines()[0] in entry


def test_lsp4ij() -> None:
    entry = json.loads((ENTRIES / "lsp4ij.json").read_text(encoding="utf-8"))
    assert entry["programArgs"]["default"] == PROGRAM
    patterns = {pattern for mapping in entry["fileTypeMappings"] for pattern in mapping["fileType"]["patterns"]}
    assert patterns == {"*.ascxml", "*.scxml", "*.xml", "*.jani"}


def test_mason() -> None:
    entry = (ENTRIES / "mason.yaml").read_text(encoding="utf-8")
    assert f"\n  id: pkg:pypi/{PROJECT['name']}@{PROJECT['version']}\n" in entry
    assert f"\n  {PROGRAM}: pypi:{PROJECT['name']}\n" in entry
    assert f"\n  lspconfig: {(ENTRIES / 'as2fm_lsp.lua').stem}\n" in entry
