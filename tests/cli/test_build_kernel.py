# SPDX-License-Identifier: Apache-2.0
"""Compiling the kernel with compilers that fail; `tests/packaging` contains a test with a working one."""

from __future__ import annotations

import sysconfig
from pathlib import Path

import pytest

from as2fm_lsp.cli.build_kernel import BuildError, build, main


@pytest.fixture
def source(tmp_path: Path) -> Path:
    (tmp_path / "kernel.c").write_text("int x;\n")
    return tmp_path / "kernel.c"


def compiler(monkeypatch: pytest.MonkeyPatch, path: Path, script: str) -> None:
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    known = {**sysconfig.get_config_vars(), "LDSHARED": f"{path} -shared"}
    monkeypatch.setattr(sysconfig, "get_config_var", known.get)


def test_the_extension_is_beside_its_source(
    source: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    copies = (
        'for last; do :; done; case "$*" in *-shared*kernel.c*) cp "$(dirname "$0")/made" "$last";; *) exit 9;; esac'
    )
    tools = tmp_path_factory.mktemp("tools")
    (tools / "made").write_text("extension")
    compiler(monkeypatch, tools / "cc", copies)
    (target,) = build([source])
    assert target == source.parent / f"kernel{sysconfig.get_config_var('EXT_SUFFIX')}"
    assert target.read_text() == "extension"
    assert sorted(source.parent.iterdir()) == sorted([source, target])


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("echo 'kernel.c:1:10: fatal error: Python.h: No such file or directory' >&2; exit 1", "fatal error: Python.h"),
        ("exit 1", "cc failed"),
    ],
)
def test_a_failed_build_leaves_no_files(
    source: Path,
    tmp_path_factory: pytest.TempPathFactory,
    monkeypatch: pytest.MonkeyPatch,
    script: str,
    message: str,
) -> None:
    compiler(monkeypatch, tmp_path_factory.mktemp("tools") / "cc", script)
    with pytest.raises(BuildError, match=message):
        build([source])
    assert list(source.parent.iterdir()) == [source]


def test_an_interrupted_attempt_is_no_answer(
    source: Path,
    tmp_path_factory: pytest.TempPathFactory,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    compiler(monkeypatch, tmp_path_factory.mktemp("tools") / "cc", "kill -TERM $$")
    assert main([source]) == 2
    assert "ended by signal 15" in capsys.readouterr().err
    assert list(source.parent.iterdir()) == [source]


def test_no_compiler(source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sysconfig, "get_config_var", {"LDSHARED": "/nowhere/cc -shared"}.get)
    with pytest.raises(BuildError, match="there is no C compiler"):
        build([source])


def test_nothing_to_compile(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(BuildError, match="does not contain the kernel as C"):
        build([tmp_path / "kernel.c"])
    assert main([tmp_path / "kernel.c"]) == 1
    assert "verification runs as plain Python" in capsys.readouterr().err
