# SPDX-License-Identifier: Apache-2.0
"""The editor shows what follows from the reachable states of a system, after the other findings."""

from __future__ import annotations

from pathlib import Path

from client import connect

from fixture import write_files
from roaml.rules import document

CODE = "never-ticked"


def bad_example() -> str:
    """The files of the example that the rule reports."""
    return document(CODE).split("## Bad")[1].split("```xml\n")[1].split("```")[0]


async def test_the_finding_follows_the_files(tmp_path: Path) -> None:
    write_files(tmp_path, bad_example())
    battery, tree = tmp_path / "battery.ascxml", tmp_path / "tree.xml"
    async with connect(tmp_path) as client:
        client.open(tree, tree.read_text(encoding="utf-8"))
        text = battery.read_text(encoding="utf-8")
        client.open(battery, text)
        await client.until_codes(tree, CODE)
        client.replace(battery, text.replace("level - 10", "level - 90"))
        await client.until_codes(tree)
        client.replace(battery, text)
        await client.until_codes(tree, CODE)
