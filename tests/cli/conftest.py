# SPDX-License-Identifier: Apache-2.0
"""Calls of the command line in the process of the tests."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path

import pytest
from command import Command, Done

from as2fm_lsp.cli.main import run


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """Calls the command line in the folder of the test; `stdin` is its standard input.

    It sees one processor: on a busy machine, starting processes takes longer than the answers. With `--jobs`, it starts
    them.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {0}, raising=False)

    def call(*arguments: object, stdin: bytes = b"") -> Done:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(stdin), encoding="utf-8"))
        capsys.readouterr()
        try:
            status = run([str(argument) for argument in arguments])
        except SystemExit as end:  # as argparse ends
            status = int(end.code or 0)
        out, err = capsys.readouterr()
        return Done(status, out, err)

    return call


@pytest.fixture
def check(command: Command) -> Command:
    """`as2fm-lsp --check --format json`"""
    return lambda *arguments, stdin=b"": command("--check", "--format", "json", *arguments, stdin=stdin)
