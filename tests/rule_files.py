# SPDX-License-Identifier: Apache-2.0
"""The cases and documents of the rules, read without the library."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from fixture import Case, read_cases

CASES_FOLDER = Path(__file__).parent / "rules" / "cases"
RULES_FOLDER = Path(__file__).parents[1] / "server" / "roaml" / "rules"
ALL_RULES = "one_report"
"""The folder of the cases whose marks are about all rules."""

_BLOCK = re.compile(r"^```\w*\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@cache
def documents() -> dict[str, str]:
    """Code -> document of each rule."""
    paths = sorted(RULES_FOLDER.glob("*/*.md"))
    return {path.stem.replace("_", "-"): path.read_text(encoding="utf-8") for path in paths}


def section(code: str, title: str) -> str:
    match = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", documents()[code], re.MULTILINE | re.DOTALL)
    assert match is not None, f"{code} has no section {title}"
    return match[1].strip()


def has_fix(code: str) -> bool:
    """Whether the document of a rule describes a fix."""
    return "\n## Fix\n" in documents()[code]


def examples(code: str, title: str) -> list[Case]:
    """The examples of a document in its section *Bad* or *Good*."""
    return [Case(code, f"{title} {number}", text) for number, text in enumerate(_BLOCK.findall(section(code, title)))]


@cache
def cases_of_rules() -> tuple[Case, ...]:
    paths = sorted(path for path in CASES_FOLDER.glob("*/*.txt") if path.parent.name != ALL_RULES)
    return tuple(case for path in paths for case in read_cases(path))


@cache
def cases_of_all_rules() -> tuple[Case, ...]:
    return tuple(case for path in sorted((CASES_FOLDER / ALL_RULES).glob("*.txt")) for case in read_cases(path))
