# SPDX-License-Identifier: Apache-2.0
"""The page about the comparison with Storm."""

from __future__ import annotations

import json
from pathlib import Path

from corpus.judgements import EQUAL, TOO_LARGE, Judgement, page, read


def record(file: Path, system: str, *judgements: Judgement) -> Path:
    with file.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps({"system": system, "judged": judgements}) + "\n")
    return file


def test_the_page_lists_systems_and_counts_networks(tmp_path: Path) -> None:
    file = record(
        tmp_path / "a.resume",
        "robot",
        Judgement("p", "any", EQUAL, searched=1_200, storm=3_400, storm_s=1.5),
        Judgement("p", "instant", TOO_LARGE, "Storm: more than 60 s", searched=7),
    )
    record(file, "network 0", Judgement("q", "any", EQUAL), Judgement("q", "instant", TOO_LARGE, "stopped; raise it"))
    text = page(read([file]), "Limits.")
    assert "\nLimits.\n" in text
    assert "| robot, p | 1,200; 3,400, 1.5 s | no clock | no clock | 7; Storm: more than 60 s |" in text
    assert "network 0" not in text
    systems, networks = text.split("## 2. Random networks")
    assert "| any | 1 | 0 | 0 | 0 |" in systems
    assert "| instant | 0 | 0 | 1 | 0 |" in systems
    assert "| any | 1 | 0 | 0 | 0 |" in networks
    assert "\n1 without a comparison: stopped.\n" in networks


def test_the_page_names_the_systems_that_were_not_compared(tmp_path: Path) -> None:
    file = record(tmp_path / "a.resume", "second", Judgement("p", "any", EQUAL))
    record(file, "first", Judgement("q", "any", EQUAL))
    text = page(read([file]), "Limits.", ["first", "second", "third", "fourth"])
    assert text.index("| first, q |") < text.index("| second, p |")
    assert "\nNot compared: third, fourth.\n" in text
    assert "\nAll conformance systems are listed.\n" in page(read([file]), "Limits.", ["second", "first"])


def test_a_later_judgement_replaces_an_earlier_one(tmp_path: Path) -> None:
    first = record(tmp_path / "a.resume", "robot", Judgement("p", "any", TOO_LARGE, "Storm: more than 60 s"))
    second = record(tmp_path / "b.resume", "robot", Judgement("p", "any", EQUAL, searched=1, storm=2))
    assert read([first, second]) == [("robot", Judgement("p", "any", EQUAL, searched=1, storm=2))]
