# SPDX-License-Identifier: Apache-2.0
"""The reports for programs, each read back with a reader that is not ours."""

from __future__ import annotations

import json
import os
import re
import urllib.parse
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from command import Command

import clock
from as2fm_lsp.cli.formats import CheckReport, Format
from as2fm_lsp.cli.formats import render as render_report
from as2fm_lsp.cli.formats.report import entry
from roaml import __version__
from roaml.diagnostics import Diagnostic, RelatedPlace, Severity
from roaml.rules import BY_CODE, RULES, cited, document
from roaml.text import Location, SourceFile, Span

FOLDER = "/models, 100%: 字"
EVIL = 'a "quoted" 100% <tag> & [brackets], colon: "字🤖"\r\nnext \x1b[0m line'
TEXT = "first\nsecond 字🤖 line\nthird\n"


def diagnostics(file: str = f"{FOLDER}/näme, a:b.ascxml") -> list[Diagnostic]:
    """One of each severity, in one line and over several, with all that needs care in names and messages."""
    there = RelatedPlace(Location(f"{FOLDER}/other.xml", Span(0, 5)), "there")
    here = RelatedPlace(Location(file, Span(6, 12)), "here")
    return [
        Diagnostic(file, "unknown-element", Severity.ERROR, Span(13, 15), EVIL, (), (here, there)),
        Diagnostic(file, "unknown-element", Severity.ERROR, Span(13, 15), EVIL),
        Diagnostic(file, "duplicate-data", Severity.WARNING, Span(0, 20), "over lines"),
        Diagnostic(file, "division-by-zero", Severity.INFORMATION, Span(0, 0), "empty"),
        Diagnostic(file, "document-type", Severity.HINT, Span(len(TEXT), len(TEXT)), "at the end"),
    ]


def render(name: str, reported: list[Diagnostic] | None = None, limit: Severity = Severity.ERROR) -> str:
    reported = diagnostics() if reported is None else reported
    entries = [
        entry(d, lambda path: SourceFile(path, TEXT), lambda path: path.removeprefix(f"{FOLDER}/")) for d in reported
    ]
    return render_report(CheckReport(entries, 2, limit), Format(name))


# ------------------------------------------------------------------------ JSON


def test_json() -> None:
    rows = json.loads(render("json"))
    assert rows[0] == {
        "file": "näme, a:b.ascxml",
        "line": 2,
        "column": 8,
        "end_line": 2,
        "end_column": 10,
        "severity": "error",
        "code": "unknown-element",
        "message": EVIL,
    }
    assert [row["severity"] for row in rows] == ["error", "error", "warning", "information", "hint"]
    places = [(row["line"], row["column"], row["end_line"], row["end_column"]) for row in rows]
    assert places == [(2, 8, 2, 10), (2, 8, 2, 10), (1, 1, 2, 15), (1, 1, 1, 1), (4, 1, 4, 1)]
    assert render("json", []) == "[]\n"


def test_json_counts_code_points(check: Command, tmp_path: Path) -> None:
    """As `run.py --help` of the conformance set states it: from 1, in code points, the end exclusive."""
    clock.write(tmp_path, clock=clock.CLOCK.replace('expr="(count', "expr=\"'🤖字' + wrong + (count"))
    row = next(row for row in check("main.xml").rows if row["code"] == "undeclared-variable")
    line = (tmp_path / "clock.ascxml").read_text().splitlines()[row["line"] - 1]
    assert line[row["column"] - 1 : row["end_column"] - 1] == "wrong"
    assert row["line"] == row["end_line"]


def test_json_names_files_as_given_or_relative(check: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock.write(tmp_path / "deep" / "er", clock=clock.WRONG_CLOCK)
    for given in ("deep/er/main.xml", tmp_path / "deep/er/main.xml", "./deep/../deep/er", "deep"):
        (file,) = [row["file"] for row in check(given).rows]
        assert file == os.path.join("deep", "er", "clock.ascxml")
    monkeypatch.chdir(tmp_path / "deep")
    assert check("er").rows[0]["file"] == os.path.join("er", "clock.ascxml")
    monkeypatch.chdir("/")
    for row in check(tmp_path / "deep").rows:
        assert Path(row["file"]).resolve() == tmp_path / "deep" / "er" / "clock.ascxml"


# ---------------------------------------------------------------------- GitHub

_COMMAND = re.compile(r"::(error|warning|notice) ([^:]*)::(.*)")


def github_lines(text: str) -> list[tuple[str, dict[str, str], str]]:
    """As the runner of GitHub reads workflow commands."""
    commands = []
    for line in text.splitlines():
        match = _COMMAND.fullmatch(line)
        assert match is not None, line
        properties = dict(part.split("=", 1) for part in match[2].split(","))
        commands.append((match[1], {k: unescape(v) for k, v in properties.items()}, unescape(match[3])))
    return commands


def unescape(text: str) -> str:
    for code, character in (("%2C", ","), ("%3A", ":"), ("%0A", "\n"), ("%0D", "\r"), ("%25", "%")):
        text = text.replace(code, character)
    return text


def test_github() -> None:
    commands = github_lines(render("github"))
    assert [kind for kind, _, _ in commands] == ["error", "error", "warning", "notice", "notice"]
    _, properties, message = commands[0]
    assert message == EVIL
    assert properties == {
        "file": "näme, a:b.ascxml",
        "line": "2",
        "endLine": "2",
        "col": "8",
        "endColumn": "10",
        "title": "unknown-element",
    }
    # GitHub ignores columns of annotations over several lines, and complains.
    assert commands[2][1] == {
        "file": "näme, a:b.ascxml",
        "line": "1",
        "endLine": "2",
        "title": "duplicate-data",
    }
    assert render("github", []) == ""


# ---------------------------------------------------------------------- GitLab


def test_gitlab() -> None:
    rows = json.loads(render("gitlab"))
    assert rows[0] == {
        "type": "issue",
        "check_name": "unknown-element",
        "description": EVIL,
        "severity": "major",
        "fingerprint": rows[0]["fingerprint"],
        "location": {"path": "näme, a:b.ascxml", "lines": {"begin": 2, "end": 2}},
    }
    assert [row["severity"] for row in rows] == ["major", "major", "minor", "info", "info"]
    fingerprints = [row["fingerprint"] for row in rows]
    assert len(set(fingerprints)) == len(rows), "GitLab would drop one of those with the same fingerprint"
    assert render("gitlab", []) == "[]\n"


# ----------------------------------------------------------------------- SARIF

REGION = {
    "type": "object",
    "required": ["startLine", "startColumn", "endLine", "endColumn"],
    "properties": {
        key: {"type": "integer", "minimum": 1} for key in ("startLine", "startColumn", "endLine", "endColumn")
    },
    "additionalProperties": False,
}
MESSAGE = {
    "type": "object",
    "required": ["text"],
    "properties": {"text": {"type": "string", "minLength": 1}, "markdown": {"type": "string", "minLength": 1}},
    "additionalProperties": False,
}
LOCATION = {
    "type": "object",
    "required": ["physicalLocation"],
    "properties": {
        "id": {"type": "integer", "minimum": -1},
        "message": MESSAGE,
        "physicalLocation": {
            "type": "object",
            "required": ["artifactLocation"],
            "properties": {
                "artifactLocation": {
                    "type": "object",
                    "properties": {"uri": {"type": "string", "format": "uri-reference", "pattern": r"^[!-~]*$"}},
                    "additionalProperties": False,
                },
                "region": REGION,
            },
            "additionalProperties": False,
        },
    },
    "additionalProperties": False,
}
LEVEL = {"enum": ["none", "note", "warning", "error"]}
RULE = {
    "type": "object",
    "required": ["id"],
    "properties": {
        "id": {"type": "string"},
        "name": {"type": "string"},
        "shortDescription": MESSAGE,
        "fullDescription": MESSAGE,
        "help": MESSAGE,
        "helpUri": {"type": "string", "format": "uri"},
        "defaultConfiguration": {
            "type": "object",
            "properties": {"level": LEVEL, "enabled": {"type": "boolean"}},
            "additionalProperties": False,
        },
    },
    "additionalProperties": False,
}
SARIF: dict[str, Any] = {
    # The parts of the schema of SARIF 2.1.0 (OASIS) that are used, with everything else closed.
    "type": "object",
    "required": ["version", "runs"],
    "properties": {
        "$schema": {"type": "string", "format": "uri"},
        "version": {"const": "2.1.0"},
        "runs": {
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "object",
                "required": ["tool"],
                "properties": {
                    "tool": {
                        "type": "object",
                        "required": ["driver"],
                        "properties": {
                            "driver": {
                                "type": "object",
                                "required": ["name"],
                                "properties": {
                                    "name": {"type": "string"},
                                    "semanticVersion": {"type": "string", "pattern": r"^\d+\.\d+\.\d+"},
                                    "rules": {"type": "array", "uniqueItems": True, "items": RULE},
                                },
                                "additionalProperties": False,
                            }
                        },
                        "additionalProperties": False,
                    },
                    "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
                    "results": {
                        "type": "array",
                        "items": {
                            "type": "object",
                            "required": ["message"],
                            "properties": {
                                "ruleId": {"type": "string"},
                                "ruleIndex": {"type": "integer", "minimum": 0},
                                "level": LEVEL,
                                "message": MESSAGE,
                                "locations": {"type": "array", "items": LOCATION},
                                "relatedLocations": {"type": "array", "uniqueItems": True, "items": LOCATION},
                                "partialFingerprints": {
                                    "type": "object",
                                    "additionalProperties": {"type": "string"},
                                },
                            },
                            "additionalProperties": False,
                        },
                    },
                },
                "additionalProperties": False,
            },
        },
    },
    "additionalProperties": False,
}


def test_sarif() -> None:
    log = json.loads(render("sarif"))
    jsonschema.validate(log, SARIF)
    (run,) = log["runs"]
    driver = run["tool"]["driver"]
    assert (driver["name"], driver["semanticVersion"]) == ("as2fm-lsp", __version__)
    assert run["columnKind"] == "unicodeCodePoints"
    for result in run["results"]:
        assert driver["rules"][result["ruleIndex"]]["id"] == result["ruleId"]
    assert [r["level"] for r in run["results"]] == ["error", "error", "warning", "note", "note"]
    first = run["results"][0]
    assert first["message"] == {"text": EVIL}
    place = first["locations"][0]["physicalLocation"]
    assert place["region"] == {"startLine": 2, "startColumn": 8, "endLine": 2, "endColumn": 10}
    assert urllib.parse.unquote(place["artifactLocation"]["uri"]) == "näme, a:b.ascxml"
    assert ":" not in place["artifactLocation"]["uri"], "it would be read as the scheme of a URI"
    files = [r["physicalLocation"]["artifactLocation"]["uri"] for r in first["relatedLocations"]]
    assert [urllib.parse.unquote(uri) for uri in files] == ["näme, a:b.ascxml", "other.xml"]
    assert [r["message"]["text"] for r in first["relatedLocations"]] == ["here", "there"]
    hashes = [r["partialFingerprints"]["primaryLocationLineHash"] for r in run["results"]]
    assert len(set(hashes)) == len(hashes)
    jsonschema.validate(json.loads(render("sarif", [])), SARIF)


def test_sarif_carries_the_documents_of_rules() -> None:
    of_all_rules = [Diagnostic("/a", rule.code, rule.severity, Span(0, 1), "m") for rule in RULES]
    log = json.loads(render("sarif", of_all_rules))
    jsonschema.validate(log, SARIF)
    rules = log["runs"][0]["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == sorted(BY_CODE)
    for rule in rules:
        assert rule["help"]["markdown"] == cited(document(rule["id"]))
        assert rule["shortDescription"]["text"] == BY_CODE[rule["id"]].summary


# ----------------------------------------------------------------------- JUnit


def test_junit() -> None:
    """What does not make the check fail is a test that passes, so that a green run has a green report."""
    for limit, failures in ((Severity.ERROR, 2), (Severity.WARNING, 3)):
        suites = ET.fromstring(render("junit", limit=limit))
        (suite,) = suites
        assert suites.tag == "testsuites"
        for element in (suites, suite):
            counts = {key: element.get(key) for key in ("tests", "failures", "errors")}
            assert counts == {"tests": "5", "failures": str(failures), "errors": "0"}
        cases = list(suite)
        assert [case.tag for case in cases] == ["testcase"] * 5
        assert [child.tag for case in cases for child in case] == ["failure"] * failures + ["system-out"] * (
            5 - failures
        )
    first = cases[0]
    assert first.get("classname") == "näme, a:b.ascxml"
    assert first.get("name") == "unknown-element näme, a:b.ascxml:2:8"
    failure = first.find("failure")
    assert failure is not None
    assert failure.get("type") == "error"
    assert failure.get("message") == EVIL.replace("\x1b", "\ufffd")
    (case,) = ET.fromstring(render("junit", []))[0]
    assert (case.get("name"), list(case)) == ("2 files checked", [])


def test_junit_says_the_same_as_the_exit_status(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.UNHEARD_CLOCK)
    done = command("--check", ".", "--format", "junit")
    assert (done.status, ET.fromstring(done.out).get("failures")) == (0, "0")
    (tmp_path / "as2fm.toml").write_text('severity = { topic-without-subscriber = "warning" }\n')
    done = command("--check", ".", "--format", "junit", "--warnings-as-errors")
    assert (done.status, ET.fromstring(done.out).get("failures")) == (1, "1")


# ---------------------------------------------------------------- fingerprints

Fingerprints = Callable[[str], list[str]]


def gitlab_fingerprints(text: str) -> list[str]:
    return [row["fingerprint"] for row in json.loads(text)]


def sarif_fingerprints(text: str) -> list[str]:
    return [r["partialFingerprints"]["primaryLocationLineHash"] for r in json.loads(text)["runs"][0]["results"]]


@pytest.mark.parametrize(
    ("name", "fingerprints"), [("gitlab", gitlab_fingerprints), ("sarif", sarif_fingerprints)], ids=["gitlab", "sarif"]
)
def test_fingerprints_stay_when_lines_move(
    command: Command, tmp_path: Path, name: str, fingerprints: Fingerprints
) -> None:
    broken = clock.CLOCK.replace("</state>", "<unknwon /><unknwon />\n<misplaced/>\n</state>")
    path = tmp_path / "clock.ascxml"

    def now(text: str) -> list[str]:
        path.write_text(text, encoding="utf-8")
        return fingerprints(command("--check", "clock.ascxml", "--select", "unknown-element", "--format", name).out)

    before = now(broken)
    assert len(set(before)) == len(before) == 3
    moved = broken.replace("<datamodel>", "<!-- one -->\n\n<!-- two -->\n    <datamodel>").replace("<mis", "\t\t<mis")
    assert now(moved) == before
    assert now(broken.replace("<misplaced/>", "")) == before[:2]
    assert now(broken.replace("misplaced", "otherwise"))[2] not in before


def test_a_long_line_is_shortened_around_the_finding() -> None:
    """Generated files may be one line of megabytes with thousands of findings."""

    def fingerprint(text: str) -> str:
        start = text.index("WRONG")
        diagnostic = Diagnostic("/a", "xml-syntax", Severity.ERROR, Span(start, start + 5), "m")
        return entry(diagnostic, lambda _: SourceFile("/a", text), str).fingerprint

    known = fingerprint("a" * 1000 + "WRONG" + "b" * 1000)
    assert fingerprint("a" * 900_000 + "WRONG" + "b" * 900_000) == known
    assert fingerprint("a" * 999 + "x" + "WRONG" + "b" * 1000) != known
