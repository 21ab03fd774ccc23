# SPDX-License-Identifier: Apache-2.0
"""The parts of old versions of a file are released: an editor that stays open needs no more memory with each key."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

from fixture import write_files
from mending import found, offered, workspace_of
from roaml.project.workspace import Workspace
from rule_files import examples

VERSIONS = 20
MAX_KEPT = 2
"""The number of versions of a file that may be kept: the current one, and the last one for which a cache has a result.
"""


@pytest.mark.parametrize(
    "code", ["undeclared-variable", "undefined-state", "port-value", "script-type", "missing-port"]
)
def test_old_versions_are_released(code: str, tmp_path: Path) -> None:
    """A file is checked and its fixes are listed in many versions."""
    [case, *_] = examples(code, "Bad")
    write_files(tmp_path, case.text)
    workspace = workspace_of(tmp_path)
    before = alive()
    for version in range(VERSIONS):
        check(workspace, version)
    files = len(workspace.snapshot().files())
    after = alive()
    growth = {name: count - before[name] for name, count in after.items()}  # negative if earlier tests left some behind
    assert after["Document"] > 0
    assert max(growth.values()) <= MAX_KEPT * files, growth


def check(workspace: Workspace, version: int) -> None:
    """Check a version of a workspace in which all files end with the given number of additional blank lines."""
    for path in workspace.snapshot().files():
        source = workspace.snapshot().analysis.source(path)
        assert source is not None
        workspace.open(path, source.text.rstrip("\n") + "\n" * (version + 1))
    found(workspace.snapshot())
    assert all(action.title for _, action in offered(workspace.snapshot()))


def alive() -> dict[str, int]:
    """The number of objects that contain all parts of a file, by their class."""
    gc.collect()
    names = [type(object_).__name__ for object_ in gc.get_objects()]
    return {name: names.count(name) for name in ("Document", "Forest", "Machine")}
