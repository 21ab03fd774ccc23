# SPDX-License-Identifier: Apache-2.0
"""`pytest --as2fm` checks and verifies models as tests."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
PLUGIN = ("-p", "no:cacheprovider", "-p", "no:pytest-lsp", "-p", "no:as2fm", "-p", "as2fm_lsp.pytest_plugin")


def run(folder: Path, *options: str) -> str:
    command = [sys.executable, "-m", "pytest", "-v", "-rs", "-c", "/dev/null", f"--rootdir={folder}", *PLUGIN, *options]
    done = subprocess.run([*command, str(folder)], cwd=folder, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


def test_systems_and_trees_are_tests(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES / "grid_world", tmp_path / "grid")
    shutil.copytree(EXAMPLES / "fetch_tree", tmp_path / "fetch")
    (tmp_path / "grid/as2fm.toml").write_text('[verify.expect]\narrives = ">= 0.95"\n')
    said = run(tmp_path, "--as2fm")
    assert "grid/main.xml::check PASSED" in said
    assert "grid/main.xml::arrives FAILED" in said
    assert "expected ≥ 0.95: NOT MET" in said
    assert "fetch/fetch.xml::succeeds SKIPPED" in said
    assert "no expectation set: succeeds: " in said
    assert "Traceback" not in said


def test_errors_fail_and_nothing_is_verified(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES / "delivery_robot", tmp_path / "robot")
    tree = tmp_path / "robot/tree.xml"
    tree.write_text(tree.read_text().replace("<Charge />", "<Chrge />"))
    said = run(tmp_path, "--as2fm")
    assert "tree.xml:8:18: error: there is no node `Chrge`" in said
    assert "all_delivered" not in said


def test_without_the_option_models_are_no_tests(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES / "grid_world", tmp_path / "grid")
    assert "no tests ran" in run(tmp_path)
