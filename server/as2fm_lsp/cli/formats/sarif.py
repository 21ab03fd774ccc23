# SPDX-License-Identifier: Apache-2.0
"""SARIF 2.1.0 (OASIS), as GitHub code scanning reads it.

Each rule contains its document as help. GitHub uses `primaryLocationLineHash` to recognise an alert after its line has
moved.
"""

from __future__ import annotations

import json
import os
import urllib.parse
from collections import Counter
from typing import Any

from as2fm_lsp.cli.formats.report import CheckReport, Entry, LineRange
from as2fm_lsp.verification.findings import SUMMARIES
from roaml import __version__
from roaml.project.paths import slashed
from roaml.rules import BY_CODE, cited, document

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
MAX_RESULTS = 25_000

_LEVELS = {"error": "error", "warning": "warning", "information": "note", "hint": "note"}


def render(report: CheckReport) -> str:
    entries = report.entries[:MAX_RESULTS]
    codes = sorted({entry.code for entry in entries})
    seen: Counter[str] = Counter()
    results = [_result(entry, codes.index(entry.code), seen) for entry in entries]
    run = {
        "tool": {
            "driver": {
                "name": "as2fm-lsp",
                "semanticVersion": __version__,
                "rules": [_rule(code) for code in codes],
            }
        },
        "columnKind": "unicodeCodePoints",
        "results": results,
    }
    return json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, ensure_ascii=False, indent=2) + "\n"


def _rule(code: str) -> dict[str, Any]:
    if code in SUMMARIES:
        return {"id": code, "name": _name(code), "shortDescription": {"text": SUMMARIES[code]}}
    rule, text = BY_CODE[code], cited(document(code))
    return {
        "id": code,
        "name": _name(code),
        "shortDescription": {"text": rule.summary},
        "fullDescription": {"text": rule.summary},
        "help": {"text": text, "markdown": text},
        "defaultConfiguration": {"level": _LEVELS[rule.severity.label]},
    }


def _name(code: str) -> str:
    return "".join(word.capitalize() for word in code.split("-"))


def _result(entry: Entry, index: int, seen: Counter[str]) -> dict[str, Any]:
    seen[entry.fingerprint] += 1
    result: dict[str, Any] = {
        "ruleId": entry.code,
        "ruleIndex": index,
        "level": _LEVELS[entry.severity],
        "message": {"text": entry.message},
        "locations": [_location(entry.file, entry.place)],
        "partialFingerprints": {"primaryLocationLineHash": f"{entry.fingerprint}:{seen[entry.fingerprint]}"},
    }
    related = [
        {**_location(r.file, r.place), "id": number, "message": {"text": r.message}}
        for number, r in enumerate(entry.related)
    ]
    if related:
        result["relatedLocations"] = related
    return result


def _location(file: str, place: LineRange) -> dict[str, Any]:
    region = {
        "startLine": place.line,
        "startColumn": place.column,
        "endLine": place.end_line,
        "endColumn": place.end_column,
    }
    uri = urllib.parse.quote(os.fsencode(slashed(file)))  # quotes bytes, because a name may not be valid text
    return {"physicalLocation": {"artifactLocation": {"uri": uri}, "region": region}}
