# SPDX-License-Identifier: Apache-2.0
"""The wheel is complete: what it carries checks a model without the checkout around."""

from __future__ import annotations

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE", "server", "schemas")


def run(*command: str, cwd: Path) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def build(tmp_path: Path) -> Path:
    """The wheel, unpacked."""
    source = tmp_path / "source"
    source.mkdir()
    for name in SOURCES:
        copy_to = source / name
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, copy_to, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", "*.so"))
        else:
            shutil.copy(ROOT / name, copy_to)
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "wheel", "--quiet")
    run(*pip, "--no-deps", "--no-build-isolation", "--wheel-dir", str(tmp_path), str(source), cwd=tmp_path)
    (wheel,) = tmp_path.glob("*.whl")
    installed = tmp_path / "installed"
    zipfile.ZipFile(wheel).extractall(installed)
    return installed


def test_wheel_checks_the_example(tmp_path: Path) -> None:
    installed = build(tmp_path)
    for schema in (ROOT / "schemas").iterdir():
        assert (installed / "roaml/schemas" / schema.name).read_bytes() == schema.read_bytes()
    example = installed / "as2fm_lsp/templates/delivery_robot"
    isolated = "import sys; sys.path.insert(0, sys.argv.pop(1)); import as2fm_lsp; print(as2fm_lsp.__file__); "
    isolated += "from as2fm_lsp.__main__ import main; sys.exit(main())"
    said = run(sys.executable, "-I", "-c", isolated, str(installed), "--check", str(example), cwd=tmp_path)
    assert said.startswith(str(installed))


@pytest.mark.parametrize(("name", "value"), [("CC", "false"), ("AS2FM_PURE_PYTHON", "1")])
def test_wheel_without_a_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    """The kernel of the model checker is there as Python, and verifies."""
    monkeypatch.setenv(name, value)
    installed = build(tmp_path)
    assert sorted(path.name for path in (installed / "roaml/smc").glob("kernel*")) == ["kernel.pxd", "kernel.py"]
    assert bool(list(tmp_path.glob("*-py3-none-any.whl"))) is (name != "CC")
    example = installed / "as2fm_lsp/templates/delivery_robot/main.xml"
    isolated = "import sys; sys.path.insert(0, sys.argv.pop(1)); from as2fm_lsp.__main__ import main; sys.exit(main())"
    options = ("--property", "never_empty", "--method", "fixed", "--max-traces", "2")
    said = run(sys.executable, "-I", "-c", isolated, str(installed), "verify", str(example), *options, cwd=tmp_path)
    assert said.startswith("never_empty: 1 in ")
