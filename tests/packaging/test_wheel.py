# SPDX-License-Identifier: Apache-2.0
"""The wheel is complete: its content checks a model without the checkout."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from roaml.smc import kernel

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE", "server", "schemas")


def run(*command: str, cwd: Path) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def c_code(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What Cython makes of the sources. The tests begin with what the installation of the checkout left, if there is
    anything; Cython translates what is older than its source, and each file only once."""
    folder, left = tmp_path_factory.mktemp("cython"), ROOT / "build/cython"
    if left.is_dir():
        shutil.copytree(left, folder, dirs_exist_ok=True)
    return folder


@pytest.fixture(scope="module")
def objects(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the compiler has made; the tests compile the same source only once."""
    return tmp_path_factory.mktemp("objects")


def build(tmp_path: Path, c_code: Path) -> Path:
    """The wheel, unpacked."""
    source = tmp_path / "source"
    source.mkdir()
    for name in SOURCES:
        copy_to = source / name
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, copy_to, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", "*.so"))
        else:
            shutil.copy(ROOT / name, copy_to)
    if any(c_code.iterdir()):
        shutil.copytree(c_code, source / "build/cython")
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "wheel", "--quiet")
    run(*pip, "--no-deps", "--no-build-isolation", "--wheel-dir", str(tmp_path), str(source), cwd=tmp_path)
    shutil.copytree(source / "build/cython", c_code, dirs_exist_ok=True)
    (wheel,) = tmp_path.glob("*.whl")
    installed = tmp_path / "installed"
    zipfile.ZipFile(wheel).extractall(installed)
    return installed


def hasty_compiler(path: Path, objects: Path) -> Path:
    """The compiler of this Python with less optimisation, which takes less time. Its objects are kept in a folder, by
    the content of their sources, and copied from there."""
    path.write_text(HASTY.format(compiler=sysconfig.get_config_var("CC"), objects=objects))
    path.chmod(0o755)
    return path


HASTY = """\
#!/bin/sh
source="" result="" before=""
for argument; do
    case "$argument" in *.c) source=$argument ;; esac
    [ "$before" != -o ] || result=$argument
    before=$argument
done
[ -n "$source" ] || exec {compiler} "$@"
kept="{objects}/$(cksum <"$source" | tr " " -).o"
[ -e "$kept" ] || {compiler} "$@" -O0 -c -o "$kept" || exit
case "$result" in *.o) exec cp "$kept" "$result" ;; esac
for argument; do
    shift
    [ "$argument" = "$source" ] && set -- "$@" "$kept" || set -- "$@" "$argument"
done
exec {compiler} "$@"
"""


def test_wheel_checks_the_example(tmp_path: Path, c_code: Path, objects: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", str(hasty_compiler(tmp_path / "cc", objects)))
    installed = build(tmp_path, c_code)
    assert len(kernels(installed)) == len(PLAIN) + len(MODULES) * kernel.compiled()
    for schema in (ROOT / "schemas").iterdir():
        assert (installed / "roaml/schemas" / schema.name).read_bytes() == schema.read_bytes()
    example = installed / "as2fm_lsp/templates/delivery_robot"
    isolated = "import sys; sys.path.insert(0, sys.argv.pop(1)); import as2fm_lsp; print(as2fm_lsp.__file__); "
    isolated += "from as2fm_lsp.__main__ import main; sys.exit(main())"
    said = run(sys.executable, "-I", "-c", isolated, str(installed), "--check", str(example), cwd=tmp_path)
    assert said.startswith(str(installed))


MODULES = ("ample", "chain", "counts", "elimination", "kernel", "packing", "search", "solver", "states")
PLAIN = [f"{module}.{ending}" for module in MODULES for ending in ("pxd", "py")]
CARRIED = sorted([*PLAIN, *(f"{module}.c" for module in MODULES)])
VERIFY = "import sys; sys.path.insert(0, sys.argv.pop(1)); from as2fm_lsp.__main__ import main; sys.exit(main())"
BUILD = (
    "import sys, sysconfig; sys.path.insert(0, sys.argv[1]); sysconfig.get_config_vars()['LDSHARED'] = sys.argv.pop(); "
)
BUILD += "from as2fm_lsp.cli.build_kernel import main; sys.exit(main())"
IS_COMPILED = "import sys; sys.path.insert(0, sys.argv[1]); from roaml.smc.kernel import compiled; print(compiled())"


def verified(installed: Path) -> str:
    """The results of a verification, without their durations."""
    example = installed / "as2fm_lsp/templates/delivery_robot/main.xml"
    options = ("--property", "never_empty", "--method", "fixed", "--max-traces", "2", "--scheduler", "uniform")
    said = run(sys.executable, "-I", "-c", VERIFY, str(installed), "verify", str(example), *options, cwd=installed)
    return re.sub(r"\d+\.\d s\b", "", said)


def kernels(installed: Path) -> list[str]:
    """The files of the modules that are compiled if possible."""
    patterns = (*(f"smc/{module}.*" for module in MODULES), *(f"explicit/{module}.*" for module in MODULES))
    return sorted(path.name for pattern in patterns for path in (installed / "roaml").glob(pattern))


def test_wheel_without_a_compiler(tmp_path: Path, c_code: Path, objects: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The wheel contains the kernel as Python, which verifies, and as C, which can be compiled after the installation.
    The program says that it is slow."""
    monkeypatch.setenv("CC", "false")
    installed = build(tmp_path, c_code)
    assert kernels(installed) == CARRIED
    slow = verified(installed)
    assert slow.startswith("never_empty: 1 in ")
    _, *flags = shlex.split(sysconfig.get_config_var("LDSHARED"))
    linker = shlex.join((str(hasty_compiler(tmp_path / "cc", objects)), *flags))
    isolated = (sys.executable, "-I", "-c", BUILD, str(installed), linker)
    done = subprocess.run(isolated, capture_output=True, text=True, check=False)
    # The environment of the tests was made in the same way: what could be compiled there can be compiled here.
    assert (done.returncode == 0) is kernel.compiled()
    compiled = run(sys.executable, "-I", "-c", IS_COMPILED, str(installed), cwd=tmp_path)
    assert compiled.strip() == str(kernel.compiled())
    assert verified(installed) == slow
    assert len(kernels(installed)) == len(CARRIED) + len(MODULES) * kernel.compiled()


def test_wheel_for_every_platform(tmp_path: Path, c_code: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The wheel contains the same, and has no platform."""
    monkeypatch.setenv("AS2FM_PURE_PYTHON", "1")
    assert kernels(build(tmp_path, c_code)) == CARRIED
    assert list(tmp_path.glob("*-py3-none-any.whl"))
