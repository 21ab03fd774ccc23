# SPDX-License-Identifier: Apache-2.0
"""Errors in different files of the largest conformance model are reported together as each alone."""

from __future__ import annotations

import re
from pathlib import Path

import conformance
from roaml import api
from roaml.diagnostics import Severity
from roaml.project.settings import Settings

FOLDER = conformance.ROOT / "models" / "uc3_museum_guide"
MISTAKES = [
    ("Main/main.xml", r"<(input)(?= [^>]*BatteryComponent)", "inptu"),
    ("Main/main.xml", r"<input (type)(?=[^>]*AlarmSkill)", "tpe"),
    ("Main/main.xml", r"Skills/(ResetSkill)", "RestSkill"),
    ("Components/SchedulerComponent.ascxml", r"<ros_service_server [^>]*service_name=\"(/[^\"]+)", "/Schedler"),
    ("Components/NavigationComponent.ascxml", r"action_name=\"(/[^\"]+)", "/NavigationComponent/GoToPo"),
    (
        "Components/PeopleDetectorFilterComponent.ascxml",
        r"topic=\"(/[^\"]+)",
        "/PeopleDetectorFilterComponent/isfollowed",
    ),
    ("Skills/WaitSkill.ascxml", r"(<state )", "<foo/><state "),
]


def report(numbers: range) -> set[tuple[str, str, str]]:
    """File, rule and message of each error and warning in the system with these errors."""
    texts: dict[str, str] = {}
    for file, pattern, new in (MISTAKES[number] for number in numbers):
        path = str(FOLDER / file)
        text = texts.get(path) or Path(path).read_text(encoding="utf-8")
        match = re.search(pattern, text)
        assert match is not None, pattern
        texts[path] = text[: match.start(1)] + new + text[match.end(1) :]
    main = str(FOLDER / "Main" / "main.xml")
    diagnostics = api.check([main], (str(conformance.INTERFACES),), Settings(), texts).diagnostics
    return {(Path(d.path).name, d.code, d.message) for d in diagnostics if d.severity >= Severity.WARNING}


def test_together_as_alone() -> None:
    alone = [report(range(number, number + 1)) for number in range(len(MISTAKES))]
    sound = report(range(0))
    assert all(rows - sound for rows in alone)
    assert set().union(*alone) <= report(range(len(MISTAKES)))
