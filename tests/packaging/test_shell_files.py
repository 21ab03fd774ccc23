# SPDX-License-Identifier: Apache-2.0
"""The parser of which `docs/packaging/shell_files.py` makes the man page and the completion of shells."""

from __future__ import annotations

import argparse
import runpy
import sys
from pathlib import Path
from types import ModuleType

import pytest

from as2fm_lsp.cli.main import COMMANDS

SCRIPT = Path(__file__).resolve().parents[2] / "docs/packaging/shell_files.py"


def test_all_commands_are_in_one_parser(monkeypatch: pytest.MonkeyPatch) -> None:
    shtab, manpage = ModuleType("shtab"), ModuleType("build_manpages.manpage")
    monkeypatch.setattr(shtab, "FILE", {"bash": "_files"}, raising=False)
    monkeypatch.setattr(manpage, "Manpage", object, raising=False)
    for module in (shtab, ModuleType("build_manpages"), manpage):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    whole = runpy.run_path(str(SCRIPT))["whole_parser"]()
    (commands,) = (action for action in whole._actions if isinstance(action, argparse._SubParsersAction))
    assert set(commands.choices) == set(COMMANDS)
    assert "--exhaustive" in commands.choices["verify"].format_help()
