# SPDX-License-Identifier: Apache-2.0
"""JUnit XML, the format of test results for continuous integration."""

from __future__ import annotations

import enum
import xml.etree.ElementTree as ET
from collections.abc import Sequence

from roaml.record import Record
from roaml.xml_syntax.escapes import replace_forbidden


class CaseOutcome(enum.Enum):
    """The outcome of a test; the values are the names of elements."""

    PASSED = "system-out"
    FAILED = "failure"
    ERROR = "error"
    SKIPPED = "skipped"


class Case(Record, frozen=True):
    """A test.

    Attributes:
        text: its output; omitted if it is empty and the test passed.
        message: why it failed or was skipped, in one line.
        type: the kind of the failure.
        seconds: its duration in s, if known.
        properties: further facts, as names and values.
    """

    class_name: str
    name: str
    outcome: CaseOutcome = CaseOutcome.PASSED
    text: str = ""
    message: str = ""
    type: str = ""
    seconds: float | None = None
    properties: tuple[tuple[str, str], ...] = ()


def render(suite: str, cases: Sequence[Case]) -> str:
    """A report with one suite of tests. Characters that XML does not allow are replaced."""
    failures = sum(case.outcome is CaseOutcome.FAILED for case in cases)
    errors = sum(case.outcome is CaseOutcome.ERROR for case in cases)
    skipped = sum(case.outcome is CaseOutcome.SKIPPED for case in cases)
    counts = {"tests": str(len(cases)), "failures": str(failures), "errors": str(errors)}
    if skipped:
        counts["skipped"] = str(skipped)
    root = ET.Element("testsuites", {"name": "as2fm-lsp", **counts})
    parent = _child(root, "testsuite", {"name": suite, **counts})
    for case in cases:
        _add(parent, case)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _add(suite: ET.Element, case: Case) -> None:
    time = {} if case.seconds is None else {"time": f"{case.seconds:.3f}"}
    element = _child(suite, "testcase", {"classname": case.class_name, "name": case.name, **time})
    if case.properties:
        properties = _child(element, "properties", {})
        for name, value in case.properties:
            _child(properties, "property", {"name": name, "value": value})
    if case.text or case.outcome is not CaseOutcome.PASSED:
        details = {"type": case.type, "message": case.message}
        attributes = {name: value for name, value in details.items() if value}
        _child(element, case.outcome.value, attributes).text = replace_forbidden(case.text)


def _child(parent: ET.Element, name: str, attributes: dict[str, str]) -> ET.Element:
    return ET.SubElement(parent, name, {key: replace_forbidden(value) for key, value in attributes.items()})
