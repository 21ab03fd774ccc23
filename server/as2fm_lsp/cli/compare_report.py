# SPDX-License-Identifier: Apache-2.0
"""Reports of a comparison of two models: text, Markdown, HTML, JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

from as2fm_lsp.cli.formats.markdown import cell as markdown_cell
from roaml.api.comparing import StructuralChanges
from roaml.exhaustive import Vocabulary, assert_never
from roaml.experiments.changes import ValueChange, ValueVerdict
from roaml.experiments.enough import Met
from roaml.experiments.points import ExperimentPoint, PointKind
from roaml.experiments.results import cell, estimate_note, exact_note
from roaml.figures.plot import page
from roaml.figures.svg import CHANGE_STYLES
from roaml.ide.diagrams.changes import PartChange
from roaml.ide.diagrams.diagram import Change
from roaml.record import Record
from roaml.verification.number_text import number
from roaml.views.marked import marked

_SIGNS: Mapping[Change, str] = {Change.ADDED: "+", Change.REMOVED: "−", Change.CHANGED: "~", Change.SAME: " "}
_MET: Mapping[Met, str] = {Met.YES: "met", Met.NO: "NOT MET", Met.OPEN: "open"}
_HEAD = ("property", "old", "new", "difference", "result", "expected")


class CompareFormat(Vocabulary):
    """The formats of the report."""

    TEXT = "text"
    MARKDOWN = "markdown"
    HTML = "html"
    JSON = "json"


class ComparedSide(Record, frozen=True):
    """A version of the model. `has_values` is `None` if no values were requested, false if it has errors, or is a
    single machine."""

    name: str
    has_values: bool | None


class ComparisonReport(Record, frozen=True):
    """What is reported. `confidence` is that of all intervals together; `only_uniform` is whether the values under
    uniform choices are requested, not the minimum or maximum."""

    old: ComparedSide
    new: ComparedSide
    structure: StructuralChanges
    values: tuple[ValueChange, ...]
    confidence: float
    only_uniform: bool = False

    @property
    def title(self) -> str:
        return f"{self.old.name} → {self.new.name}"


def as_report(report: ComparisonReport, format_: CompareFormat, links: Mapping[str, str]) -> str:
    """The report in a format.

    Args:
        links: title of a picture -> the path of its file.
    """
    match format_:
        case CompareFormat.TEXT:
            return _text(report)
        case CompareFormat.MARKDOWN:
            return _markdown(report, links)
        case CompareFormat.HTML:
            return _html(report)
        case CompareFormat.JSON:
            return json.dumps(_json(report), ensure_ascii=False, indent=2) + "\n"
    return assert_never(format_)


def _text(report: ComparisonReport) -> str:
    lines = [report.title]
    for title, changes in _sections(report.structure):
        lines += ["", title, *(f"  {_SIGNS[change.change]} {change.text}" for change in changes)]
    if report.structure.is_empty:
        lines += ["", _without_changes(report.structure)]
    rows = [_HEAD, *(_row(value) for value in report.values)]
    if report.values:
        widths = [max(len(row[column]) for row in rows) for column in range(len(_HEAD))]
        table = ("  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)) for row in rows)
        lines += ["", *(line.rstrip() for line in table)]
    lines += _notes(report)
    return "".join(f"{line}\n" for line in lines)


def _markdown(report: ComparisonReport, links: Mapping[str, str]) -> str:
    lines = [f"### `{report.old.name}` → `{report.new.name}`", ""]
    if report.values:
        lines += [f"| {' | '.join(_HEAD)} |", "|" + " --- |" * len(_HEAD)]
        for value in report.values:
            name, *cells = _row(value)
            shown = [f"`{name}`", *map(markdown_cell, cells)]
            if value.differs or value.is_newly_missed:
                shown[4] = f"**{shown[4]}**"
            lines.append(f"| {' | '.join(shown)} |")
        lines.append("")
    lines += [f"{note[0].upper()}{note[1:]}.  " for note in _notes(report)]
    if report.structure.is_empty:
        text = _without_changes(report.structure)
        lines += ["", f"{text[0].upper()}{text[1:]}."]
    for title, changes in _sections(report.structure):
        lines += ["", f"#### {title[0].upper()}{title[1:]}", ""]
        if title in links:
            lines += [f"![{title}: {_counts(changes)}]({links[title].replace(' ', '%20')})", ""]
        lines += ["```diff", *(f"{_diff_sign(change)} {change.text}" for change in changes), "```"]
    return "".join(f"{line}\n" for line in lines)


def _diff_sign(change: PartChange) -> str:
    """The sign that colors a line of a block `diff`."""
    return {Change.ADDED: "+", Change.REMOVED: "-"}.get(change.change, "!")


def _html(report: ComparisonReport) -> str:
    # A column in which no row says anything is left out.
    is_expected = any(value.expected_before or value.expected_now for value in report.values)
    shown = len(_HEAD) if is_expected else len(_HEAD) - 1
    head = "".join(f"<th>{text}</th>" for text in _HEAD[:shown])
    rows = "".join(_html_row(value, shown) for value in report.values)
    parts = [f"<table><tr>{head}</tr>{rows}</table>"] if report.values else []
    parts += [f"<p>{marked(note)}</p>" for note in _notes(report)]
    pictures = {picture.title: picture for picture in report.structure.pictures}
    if report.structure.is_empty:
        parts.append(f"<p>{marked(_without_changes(report.structure))}</p>")
    for title, changes in _sections(report.structure):
        listed = "".join(f"<li>{_SIGNS[change.change]} {marked(change.text)}</li>" for change in changes)
        figure = f"<figure>{pictures[title].svg()}</figure>" if title in pictures else ""
        parts.append(f"<h2>{escape(title)}</h2>{figure}<ul>{listed}</ul>")
    return page(report.title, "\n".join(parts), CHANGE_STYLES)


def _html_row(value: ValueChange, shown: int) -> str:
    """The first `shown` cells of a row. The row of a value that has changed is marked."""
    cells = "".join(f"<td>{escape(text)}</td>" for text in _row(value)[:shown])
    return f"<tr class='changed'>{cells}</tr>" if value.differs or value.is_newly_missed else f"<tr>{cells}</tr>"


def _sections(structure: StructuralChanges) -> Iterator[tuple[str, tuple[PartChange, ...]]]:
    for picture in structure.pictures:
        yield picture.title, picture.changes
    if structure.declarations:
        yield "declarations", structure.declarations
    if structure.files:
        yield "files (without comments and layout)", structure.files


def _without_changes(structure: StructuralChanges) -> str:
    """A clause about a structure without changes."""
    if structure.is_compared:
        return "the structure is the same"
    return "the structure was not compared: that of a JANI model is not shown, only its values are compared"


def _counts(changes: tuple[PartChange, ...]) -> str:
    counts = ((word, sum(1 for c in changes if c.change is word)) for word in Change)
    return ", ".join(f"{count} {word.value}" for word, count in counts if count)


def _row(value: ValueChange) -> tuple[str, ...]:
    name = f"{value.name} (redefined)" if value.is_redefined else value.name
    verdict = f"{value.verdict.value}; expectation missed" if value.is_newly_missed else value.verdict.value
    return (name, _shown(value.old), _shown(value.new), _difference(value), verdict, _expected(value))


def _shown(point: ExperimentPoint | None) -> str:
    return "–" if point is None else cell(point)


def _difference(value: ValueChange) -> str:
    if value.verdict is ValueVerdict.SAME:
        return "0"
    if math.isnan(value.change):
        return "–"
    if value.is_exact:
        return _signed(value.change)
    return f"{_signed(value.change)} in [{_signed(value.difference.lower)}, {_signed(value.difference.upper)}]"


def _signed(difference: float) -> str:
    text = number(difference, is_probability=False)
    return f"+{text}" if difference > 0 else text.replace("-", "−")


def _expected(value: ValueChange) -> str:
    before = dict(zip((e.text for e in value.expected_before), value.met_before(), strict=False))
    now = dict(zip((e.text for e in value.expected_now), value.met_now(), strict=False))
    texts = []
    for text in dict.fromkeys((*now, *before)):
        words = [_MET[side[text]] if text in side else "–" for side in (before, now)]
        texts.append(f"{text}: {words[0]}" if words[0] == words[1] else f"{text}: {words[0]} → {words[1]}")
    return ", ".join(texts) or "–"


def _notes(report: ComparisonReport) -> list[str]:
    """Sentences without a full stop: what the values mean."""
    notes = [
        f"`{side.name}` has no values: it has errors, or is a single machine"
        for side in (report.old, report.new)
        if side.has_values is False
    ]
    points = [point for value in report.values for point in (value.old, value.new) if point is not None]
    if any(point.kind is PointKind.EXACT for point in points):
        notes.append(exact_note(points))
    if any(point.kind is PointKind.ESTIMATE for point in points):
        meaning = estimate_note(points, only_uniform=report.only_uniform)
        notes.append(
            f"{meaning}: the intervals of all values and differences are right together with {report.confidence:g} "
            "confidence; a change is significant if its interval does not contain 0"
        )
    limited = {f"`{point.name}`: {point.note}" for point in points if point.note}
    return [*notes, *sorted(limited)]


def _json(report: ComparisonReport) -> dict[str, Any]:
    return {
        "old": report.old.name,
        "new": report.new.name,
        "confidence": report.confidence,
        "properties": [
            {
                "name": value.name,
                "result": value.verdict.value,
                "redefined": value.is_redefined,
                "expectation missed": value.is_newly_missed,
                "difference": _finite(value.change),
                "low": _finite(value.difference.lower),
                "high": _finite(value.difference.upper),
                "old": None if value.old is None else value.old.as_json(),
                "new": None if value.new is None else value.new.as_json(),
            }
            for value in report.values
        ],
        "structure_compared": report.structure.is_compared,
        "pictures": [
            {"title": picture.title, "kind": picture.kind.value, "changes": _listed(picture.changes)}
            for picture in report.structure.pictures
        ],
        "declarations": _listed(report.structure.declarations),
        "files": _listed(report.structure.files),
    }


def _listed(changes: tuple[PartChange, ...]) -> list[dict[str, str]]:
    return [{"change": change.change.value, "text": change.text} for change in changes]


def _finite(value: float) -> float | str | None:
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else str(value)
