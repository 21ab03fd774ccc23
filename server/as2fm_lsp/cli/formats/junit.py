# SPDX-License-Identifier: Apache-2.0
"""JUnit XML: each diagnostic is a test of its file, which fails if the diagnostic makes the check fail."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

from as2fm_lsp.cli.formats.report import Report

_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def render(report: Report) -> str:
    failures = sum(entry.diagnostic.severity >= report.limit for entry in report.entries)
    counts = {"tests": str(max(len(report.entries), 1)), "failures": str(failures), "errors": "0"}
    suites = ET.Element("testsuites", {"name": "as2fm-lsp", **counts})
    suite = ET.SubElement(suites, "testsuite", {"name": "check", **counts})
    for entry in report.entries:
        place = f"{entry.file}:{entry.place.line}:{entry.place.column}"
        case = ET.SubElement(
            suite, "testcase", {"classname": _clean(entry.file), "name": f"{entry.code} {_clean(place)}"}
        )
        text = _clean(f"{place}: {entry.severity}: {entry.message}")
        if entry.diagnostic.severity >= report.limit:
            attributes = {"type": entry.severity, "message": _clean(entry.message)}
            ET.SubElement(case, "failure", attributes).text = text
        else:
            ET.SubElement(case, "system-out").text = text
    if not report.entries:
        ET.SubElement(suite, "testcase", {"classname": "as2fm-lsp", "name": f"{report.checked} files checked"})
    ET.indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(suites, encoding="unicode") + "\n"


def _clean(text: str) -> str:
    return _FORBIDDEN.sub("\ufffd", text)
