# SPDX-License-Identifier: Apache-2.0
"""A test case as one string: a text, the findings below its lines, and the result at the end.

    a + * b
        ^ a value is missing before `*`
    => (+ a (* _ b))

A `.` in place of carets marks an empty span.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from roaml.diagnostics import Finding

_MARK = re.compile(r"( *)(\^+|\.) (.*)")
_RESULT = "=> "


class Case:
    """A test case.

    Attributes:
        text: the text that is read.
        found: (start, end, message) of all findings, in order.
        result: the text after `=>`.
    """

    def __init__(self, written: str) -> None:
        lines: list[str] = []
        marks: list[tuple[int, int, str]] = []
        self.result = ""
        for line in written.strip("\n").split("\n"):
            if line.startswith(_RESULT):
                self.result = line.removeprefix(_RESULT)
            elif lines and (mark := _MARK.fullmatch(line)):
                start = sum(len(line) + 1 for line in lines[:-1]) + len(mark[1])
                marks.append((start, start + (0 if mark[2] == "." else len(mark[2])), mark[3]))
            else:
                lines.append(line)
        self.text = "\n".join(lines)
        self.found = sorted(marks)


def found(findings: Iterable[Finding]) -> list[tuple[int, int, str]]:
    """The findings in the form of `Case.found`."""
    return sorted((f.span.start, f.span.end, f.message) for f in findings)
