# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp migrate`: the conformance models, made old."""

from __future__ import annotations

import os
from pathlib import Path

from command import Command
from test_cli_migrate import write

import conformance
from roaml import api

AGED = (
    ("<roaml", "<convince_mc_tc"),
    ("</roaml", "</convince_mc_tc"),
    ("<parameters", "<mc_parameters"),
    ("</parameters", "</mc_parameters"),
    ("<ascxml", "<scxml"),
    ("</ascxml", "</scxml"),
    ('"node-ascxml"', '"ros-scxml"'),
    ('"bt-plugin-ascxml"', '"bt-plugin-ros-scxml"'),
    (".ascxml", ".scxml"),
)


def test_conformance_models_made_old_become_what_they_were(command: Command, tmp_path: Path) -> None:
    alone = [path for path in conformance.systems() if "../" not in path.read_text(encoding="utf-8")]
    for source in dict.fromkeys(path.parent for path in alone):
        files = {path: path.read_bytes().decode() for path in sorted(source.rglob("*")) if path.is_file()}
        for way in ("new", "old"):
            folder = tmp_path / way / source.name
            for path, text in files.items():
                name = path.relative_to(source).as_posix()
                write(folder, {aged(name): aged(text)} if way == "old" else {name: text})
            done = command("migrate", folder, "--ros-path", conformance.INTERFACES)
            assert done.status == 0, source
        new, old = (tmp_path / way / source.name for way in ("new", "old"))
        names = [os.path.relpath(path, new) for path in files_of_systems(new)]
        assert any(name.endswith(".ascxml") for name in names)
        for name in names:
            assert (old / name).read_bytes() == (new / name).read_bytes(), old / name


def aged(text: str) -> str:
    for new, old in AGED:
        text = text.replace(new, old)
    return text


def files_of_systems(folder: Path) -> set[str]:
    analysis = api.check([str(folder)]).snapshot.analysis
    return {path for system in analysis.system_paths for path in analysis.files_of(system)}
