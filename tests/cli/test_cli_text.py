# SPDX-License-Identifier: Apache-2.0
"""The report for users. The expected outputs are made from fixed diagnostics, so they do not depend on the messages of
rules."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest
from command import Command

import clock
from as2fm_lsp.cli.formats import CheckReport, Format
from as2fm_lsp.cli.formats import render as render_report
from as2fm_lsp.cli.formats.report import entry
from roaml.diagnostics import Diagnostic, RelatedPlace, Severity
from roaml.text import Location, SourceFile, Span


def render(text: str, place: str, message: str = "wrong", *, color: bool = False) -> str:
    """The report of one diagnostic at the first occurrence of `place`."""
    start = text.index(place)
    return render_span(text, Span(start, start + len(place)), message, color=color)


def render_span(text: str, span: Span, message: str = "wrong", *, color: bool = False) -> str:
    source = SourceFile("/x/a.ascxml", text)
    diagnostic = Diagnostic(source.path, "some-rule", Severity.ERROR, span, message)
    report = CheckReport([entry(diagnostic, lambda _: source, lambda path: path[3:])], 1, color=color)
    return render_report(report, Format.TEXT)


def excerpt(text: str, place: str) -> list[str]:
    """The source line in the report, and the line with the carets."""
    return render(text, place).splitlines()[1:3]


def test_golden() -> None:
    assert render("<a>\n  <b c='d'/>\n</a>\n", "c='d'") == (
        "a.ascxml:2:6: error: wrong [some-rule]\n    2 |   <b c='d'/>\n      |      ^^^^^\n1 file checked: 1 error\n"
    )


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends_are_not_shown(end: str) -> None:
    assert excerpt(f"one{end}two{end}", "two") == ["    2 | two", "      | ^^^"]
    assert excerpt(f"one{end}two{end}", f"two{end}") == ["    2 | two", "      | ^^^"]


def test_tabs_are_kept_so_that_carets_are_aligned() -> None:
    assert excerpt("\t\tx = \tfoo", "foo") == ["    1 | \t\tx = \tfoo", "      | \t\t    \t^^^"]


def test_several_lines_are_underlined_in_the_first() -> None:
    assert excerpt("a <b\n c\n/>\n", "<b\n c\n/>") == ["    1 | a <b", "      |   ^^"]


def test_an_empty_place_has_one_caret() -> None:
    assert render_span("ab", Span(1, 1)).splitlines()[1:3] == ["    1 | ab", "      |  ^"]
    assert render_span("ab", Span(2, 2)).splitlines()[1:3] == ["    1 | ab", "      |   ^"]
    assert render_span("", Span(0, 0)).splitlines()[:3] == [
        "a.ascxml:1:1: error: wrong [some-rule]",
        "    1 | ",
        "      | ^",
    ]
    assert render_span("ab\n", Span(3, 3)).splitlines()[:3] == [
        "a.ascxml:2:1: error: wrong [some-rule]",
        "    2 | ",
        "      | ^",
    ]


@pytest.mark.parametrize(
    ("text", "place", "carets"),
    [
        ("é = foo", "foo", "    ^^^"),
        ("字 = foo", "foo", "     ^^^"),  # a wide character takes two columns
        ("a = 字字", "字字", "    ^^^^"),
        ("e\u0301 = foo", "foo", "    ^^^"),  # a combining accent takes none
        ("🤖 = foo", "foo", "     ^^^"),
        ("ｆ = foo", "foo", "     ^^^"),
    ],
)
def test_carets_are_aligned_below_characters_of_any_width(text: str, place: str, carets: str) -> None:
    assert excerpt(text, place) == [f"    1 | {text}", f"      | {carets}"]


def test_control_characters_do_not_reach_the_terminal() -> None:
    assert excerpt("a\x1b[31m\x07b\x00 c", "c") == ["    1 | a\ufffd[31m\ufffdb\ufffd c", "      |           ^"]
    assert excerpt("a\u202eb\u200b c", "c") == ["    1 | a\ufffdb\ufffd c", "      |      ^"]
    first = render("x", "x", "no `a\x1b[2J\nb`").splitlines()[0]
    assert first == "a.ascxml:1:1: error: no `a\ufffd[2J\ufffdb` [some-rule]"


def test_of_a_wide_line_the_part_around_the_place_is_shown() -> None:
    text = "a" * 500 + "WRONG" + "b" * 500
    line, carets = excerpt(text, "WRONG")
    assert line == f"  {'1':>3} | …{'a' * 39}WRONG{'b' * 115}"
    assert carets == f"      | {' ' * 40}^^^^^"
    line, carets = excerpt("WRONG" + "b" * 500, "WRONG")
    assert line == f"    1 | WRONG{'b' * 155}"
    line, carets = excerpt("x" * 1000, "x" * 1000)
    assert line == f"    1 | {'x' * 160}"
    assert carets == f"      | {'^' * 160}"


def test_numbers_of_any_length_are_aligned() -> None:
    text = "\n" * 123_455 + "foo"
    assert excerpt(text, "foo") == ["123456 | foo", "      | ^^^"]


def test_related_places_are_shown_with_their_lines() -> None:
    here, there = SourceFile("/x/a.ascxml", "a\nb\n"), SourceFile("/x/b.ascxml", "\n\n  c\n")
    related = (
        RelatedPlace(Location(here.path, Span(2, 3)), "first here"),
        RelatedPlace(Location(there.path, Span(4, 5)), "and there"),
    )
    diagnostic = Diagnostic(here.path, "some-rule", Severity.HINT, Span(0, 1), "twice", (), related)
    sources = {here.path: here, there.path: there}
    report = CheckReport([entry(diagnostic, sources.__getitem__, lambda path: path[3:])], 2)
    assert render_report(report, Format.TEXT) == (
        "a.ascxml:1:1: hint: twice [some-rule]\n"
        "    1 | a\n"
        "      | ^\n"
        "      a.ascxml:2:1: first here\n"
        "      b.ascxml:3:3: and there\n"
        "2 files checked: 1 hint\n"
    )


def test_the_summary_counts_in_words() -> None:
    source = SourceFile("/a", "x")
    severities = [Severity.HINT, Severity.ERROR, Severity.INFORMATION, Severity.WARNING, Severity.WARNING]
    diagnostics = [Diagnostic("/a", "c", severity, Span(0, 1), "m") for severity in severities]
    report = CheckReport([entry(d, lambda _: source, str) for d in diagnostics], 7)
    assert render_report(report, Format.TEXT).endswith(
        "\n7 files checked: 1 error, 2 warnings, 1 information, 1 hint\n"
    )
    assert render_report(CheckReport([], 1), Format.TEXT) == "1 file checked: no diagnostics\n"


def test_colors() -> None:
    colored = render("a foo", "foo", color=True)
    assert colored.splitlines()[0] == (
        "\x1b[1ma.ascxml:1:3\x1b[0m: \x1b[31merror\x1b[0m: wrong \x1b[2m[some-rule]\x1b[0m"
    )
    assert colored.splitlines()[2] == "      |   \x1b[31m^^^\x1b[0m"


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("environment", "arguments", "colored"),
    [
        ({}, (), True),
        ({"NO_COLOR": ""}, (), True),
        ({"NO_COLOR": "1"}, (), False),
        ({"TERM": "dumb"}, (), False),
        ({}, ("--output", "report.txt"), False),
        ({}, ("--format", "github"), False),
    ],
)
def test_colors_are_for_terminals(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    command: Command,
    environment: dict[str, str],
    arguments: tuple[str, ...],
    colored: bool,
) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    assert "\x1b" not in command("--check", ".").out
    for name, value in {"NO_COLOR": "", "TERM": "xterm", **environment}.items():
        monkeypatch.setenv(name, value)
    terminal = Terminal()
    monkeypatch.setattr(sys, "stdout", terminal)
    assert command("--check", ".", *arguments).status == 1
    written = (tmp_path / "report.txt").read_text() if "--output" in arguments else terminal.getvalue()
    assert "undeclared-variable" in written
    assert ("\x1b" in written) is colored
