# SPDX-License-Identifier: Apache-2.0
"""`python tests/failed.py REPORT.xml`: the names of the tests that failed, from a JUnit report of pytest."""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path


def failed(report: Path) -> Iterator[str]:
    """The names of failed tests as pytest accepts them, without classes. If the report does not contain them, a line
    that states a failure."""
    names = []
    if report.exists():
        for case in ET.parse(report).iter("testcase"):
            if case.find("failure") is not None or case.find("error") is not None:
                file = case.get("classname", "").replace(".", "/")
                names.append(f"{file}.py::{case.get('name')}" if file else str(case.get("name")))
    yield from names or ["tests: pytest itself, see above"]


if __name__ == "__main__":
    for name in failed(Path(sys.argv[1])):
        print(f"  {name}")
