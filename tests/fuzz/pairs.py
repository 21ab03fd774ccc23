# SPDX-License-Identifier: Apache-2.0
"""No error hides another one: pairs of errors in different files of one system must be reported like each error alone.

The errors are made from a correct system (`pairs.txt`): the name of an element, or the name or value of an attribute,
is misspelled or removed, or an unknown element is added. The findings of an error alone must also be reported beside
any other error, unless the other one could explain them; then the rule `not-checked` reports this.
"""

from __future__ import annotations

import enum
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random

from fixture import split_files
from fuzz.corpus import NOWHERE
from roaml import api
from roaml.diagnostics import Severity
from roaml.project.settings import Settings
from roaml.text import Span, apply_edits
from roaml.text import TextEdit as Edit
from roaml.xml_syntax import Element, parse

SYSTEM = Path(__file__).with_name("pairs.txt")
_WORD = re.compile(r"/?[A-Za-z_][\w/.]{2,}\Z")
_VARIABLE = re.compile(r'"((?:topic|action|moved)_\w+(?:\.valid)?)"')


@dataclass(frozen=True)
class Mistake:
    """An error in one file: a description, and the text of the file with the error."""

    file: str
    what: str
    text: str


@dataclass(frozen=True)
class Report:
    """The findings in a system: file and rule of each error and warning, and the texts of `not-checked`."""

    findings: frozenset[tuple[str, str]]
    not_checked: frozenset[tuple[str, str]]


class Outcome(enum.Enum):
    BOTH = "both are reported"
    HELD_BACK = "one is held back, and not-checked says so"
    LOST = "one is lost"


@cache
def base() -> dict[str, str]:
    """The correct system: file name -> text."""
    return split_files(SYSTEM.read_text(encoding="utf-8"))


@cache
def mistakes() -> tuple[Mistake, ...]:
    """All errors, in a fixed order. Some have no effect."""
    return tuple(_made())


@cache
def alone(mistake: Mistake) -> Report:
    return report({**base(), mistake.file: mistake.text})


def outcome(first: Mistake, second: Mistake) -> tuple[Outcome, str]:
    """The result of two errors in different files, and a description of the findings that are lost or suppressed."""
    together = report({**base(), first.file: first.text, second.file: second.text})
    missing = sorted((alone(first).findings | alone(second).findings) - together.findings)
    if not missing or _are_consequences(missing, first, second):
        return Outcome.BOTH, ""
    said = together.not_checked - alone(first).not_checked - alone(second).not_checked
    details = "; ".join(f"{code} in {file}" for file, code in missing)
    return (Outcome.HELD_BACK if said else Outcome.LOST), details


def _are_consequences(missing: list[tuple[str, str]], first: Mistake, second: Mistake) -> bool:
    """Whether both errors are reported in their files, and only findings in other files are missing. For example, two
    ports without a type do not conflict, though each conflicts with the type of the other."""
    files = {first.file, second.file}
    return not any(file in files for file, _ in missing) and all(
        any(file == mistake.file for file, _ in alone(mistake).findings) for mistake in (first, second)
    )


def choose(seed: int) -> tuple[Mistake, Mistake]:
    """Choose two errors in different files, both of which are reported alone."""
    random = Random(seed)
    while True:
        first, second = random.choice(mistakes()), random.choice(mistakes())
        if first.file != second.file and alone(first).findings and alone(second).findings:
            return first, second


def report(texts: dict[str, str]) -> Report:
    """The findings in the system that consists of these files."""
    files = {os.path.join(NOWHERE, name): text for name, text in texts.items()}
    diagnostics = api.check(list(files), (), Settings(), files).diagnostics
    return Report(
        frozenset((os.path.basename(d.path), d.code) for d in diagnostics if d.severity >= Severity.WARNING),
        frozenset((os.path.basename(d.path), d.message) for d in diagnostics if d.code == "not-checked"),
    )


# ------------------------------------------------------------------ the mistakes


def _made() -> Iterator[Mistake]:
    for file, text in base().items():
        if file.endswith(".jani"):
            for match in _VARIABLE.finditer(text):
                edited = text[: match.start(1)] + _misspelled(match[1]) + text[match.end(1) :]
                yield Mistake(file, f"{match[1]} misspelled", edited)
            continue
        root = parse(text).root
        assert root is not None
        for element in root.walk():
            for what, edits in _in_element(element, element is root):
                yield Mistake(file, what, apply_edits(text, edits))


def _in_element(element: Element, is_root: bool) -> Iterator[tuple[str, tuple[Edit, ...]]]:
    shown = f"<{element.name}> at {element.span.start}"
    if not is_root:
        spans = [span for span in (element.name_span, element.close_name_span) if span is not None]
        yield f"{shown}: misspelled", tuple(Edit(span, _misspelled(element.name)) for span in spans)
        if element.close_span is not None:
            start = element.open_span.end
            yield f"{shown}: <foo/> in it", (Edit(Span(start, start), "<foo/>"),)
    for attribute in element.attributes:
        where = f"{shown}: {attribute.name}"
        yield f"{where} misspelled", (Edit(attribute.name_span, _misspelled(attribute.name)),)
        yield f"{where} left out", (Edit(attribute.span, ""),)
        if _WORD.match(attribute.value):
            yield f"{where}: value misspelled", (Edit(attribute.value_span, _misspelled(attribute.value)),)


def _misspelled(name: str) -> str:
    """The name without one of its last letters."""
    at = max(len(name) - 2, 1)
    return name[:at] + name[at + 1 :] if len(name) > 2 else f"{name}{name}"
