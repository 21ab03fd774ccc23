# SPDX-License-Identifier: Apache-2.0
"""Models that tests of the editor's features are about, written as one string (`fixture.split_files`)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from fixture import split_files
from marked import Case
from roaml import api
from roaml.ide.occurrence import Access, Occurrence
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings

WORDS = {Access.TEXT: "names", Access.READ: "reads", Access.WRITE: "writes"}


def system_file(*inputs: str) -> str:
    """A system file; each input is `SECTION TYPE SRC`."""
    sections: dict[str, list[str]] = {}
    for section, type_, src in map(str.split, inputs):
        sections.setdefault(section, []).append(f'<input type="{type_}" src="{src}"/>')
    body = "".join(f"<{name}>{''.join(found)}</{name}>" for name, found in sections.items())
    return f'<roaml><parameters><max_time value="1" unit="s"/></parameters>{body}</roaml>'


def load(folder: Path, files: dict[str, str]) -> Analysis:
    """Write files and analyse the folder."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
    return api.check([str(folder)], settings=Settings()).snapshot.analysis


def load_marked(folder: Path, written: str) -> tuple[Analysis, dict[str, Case]]:
    """Files with carets below their lines."""
    cases = {name: Case(text) for name, text in split_files(written).items()}
    return load(folder, {name: case.text for name, case in cases.items()}), cases


def found(occurrences: Iterable[Occurrence]) -> list[tuple[int, int, str]]:
    """Occurrences in the form of `Case.found`."""
    return sorted((each.span.start, each.span.end, _words(each)) for each in occurrences)


def _words(each: Occurrence) -> str:
    verb = "defines" if each.defines else WORDS[each.access]
    scope = f" in {each.symbol.scope}" if each.symbol.scope else ""
    return f"{verb} {each.symbol.kind} {each.symbol.name}{scope}"
