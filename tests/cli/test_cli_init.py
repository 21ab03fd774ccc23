# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp init DIR`, and `as2fm-lsp init --mocks TREE.xml`"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from command import Command


def files(folder: Path) -> dict[str, str]:
    return {p.relative_to(folder).as_posix(): p.read_text() for p in folder.rglob("*") if p.is_file()}


@pytest.mark.parametrize("name", ["my_robot", "deep/er/robot", "with space ü", "."])
def test_what_it_writes_is_clean(command: Command, tmp_path: Path, name: str) -> None:
    done = command("init", name)
    assert (done.status, done.err) == (0, "")
    written = files(tmp_path / name)
    assert {"main.xml", "tree.xml", "properties.jani"} <= written.keys()
    lines = done.out.splitlines()
    announced = {line.removeprefix("wrote ") for line in lines[:-2]}
    assert announced == {os.path.normpath(os.path.join(name, file)) for file in written}
    quoted = f"'{name}/main.xml'" if " " in name else f"{name}/main.xml"
    assert lines[-1] == f"next: as2fm-lsp --check {quoted}"
    checked = command("--check", tmp_path / name / "main.xml", "--warnings-as-errors", "--severity", "information")
    assert checked.status == 0
    assert checked.out.endswith(f"{len(written)} files checked: 1 information\n")
    assert "[not-in-reference]" in checked.out.splitlines()[0]


def test_a_second_init_is_refused(command: Command, tmp_path: Path) -> None:
    assert command("init", "robot").status == 0
    (tmp_path / "robot" / "main.xml").write_text("mine")
    (tmp_path / "robot" / "tree.xml").unlink()
    before = files(tmp_path)
    done = command("init", "robot")
    assert (done.status, done.out) == (2, "")
    assert "main.xml already exists; nothing was written" in done.err
    assert files(tmp_path) == before


def test_beside_other_files(command: Command, tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("mine")
    assert command("init", ".").status == 0
    assert (tmp_path / "README.md").read_text() == "mine"


def test_where_nothing_can_be_written(command: Command, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    for name in ("file", "file/robot"):
        done = command("init", name)
        assert (done.status, done.out) == (2, "")
        assert done.err.startswith(f"as2fm-lsp: {name}: ")
    assert files(tmp_path) == {"file": "mine"}


TREE = """\
<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence><Find /><Grasp /></Sequence></BehaviorTree></root>
"""


def test_mocks_of_a_tree(command: Command, tmp_path: Path) -> None:
    """The proposal makes the tree verifiable. A second call adds what is missing and keeps what is there."""
    (tmp_path / "tree.xml").write_text(TREE)
    done = command("init", "--mocks", "tree.xml")
    assert done.out.splitlines()[0] == "wrote tree.mocks with proposed mocks for 2 leaves"
    assert command("verify", "tree.xml", "--max-traces", "5").status == 0
    (tmp_path / "tree.mocks").write_text("Find: 0.25 in 3 s\n")
    assert command("init", "--mocks", "tree.xml").out.startswith("wrote tree.mocks with proposed mocks for 1 leaf\n")
    written = (tmp_path / "tree.mocks").read_text()
    assert written.startswith("Find: 0.25 in 3 s\n")
    assert "\nGrasp: " in written
    complete = "as2fm-lsp: tree.mocks: every node that needs a mock has one already\n"
    assert command("init", "--mocks", "tree.xml") == (0, "", complete)


def test_mocks_of_what_is_not_a_tree(command: Command, tmp_path: Path) -> None:
    assert command("init", "--mocks", "missing.xml").status == 2
    (tmp_path / "wrong.xml").write_text(TREE.replace("<Find />", "<SubTree ID='No' />"))
    done = command("init", "--mocks", "wrong.xml")
    assert done.status == 1
    assert "wrong.xml:1:" in done.err
    assert not (tmp_path / "wrong.mocks").exists()
