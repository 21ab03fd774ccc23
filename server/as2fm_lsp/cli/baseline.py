# SPDX-License-Identifier: Apache-2.0
"""`--baseline FILE`: introduce the tool in an existing project by suppressing the diagnostics that it already has.

The file contains the fingerprints of diagnostics and how often each occurs. Fingerprints use paths relative to the
folder of the baseline, so that it is valid in every working directory. If the baseline does not exist yet, it is
written with all current diagnostics.
"""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Sequence
from typing import TypeAlias

from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.cli.formats.report import Entry
from as2fm_lsp.cli.output import note
from roaml.diagnostics import RENAMED_CODES
from roaml.disk import MAX_DATA, required
from roaml.project.paths import seen_from

VERSION = 1


class BaselineError(ValueError):
    """A baseline that cannot be used; the message contains the reason."""


def apply(path: str, entries: Sequence[Entry]) -> list[Entry]:
    """The entries that are not in the baseline. If the baseline does not exist, it is written with all entries, and
    none are returned.

    Raises:
        BaselineError: the baseline cannot be read or written.
    """
    if not os.path.exists(path):
        _write(path, entries)
        note(f"wrote {path} with {len(entries)} known diagnostics")
        return []
    known = _read(path)
    fresh = []
    for entry in entries:
        name = _name(entry, path)
        for key in (entry.fingerprint_as(name), (name, entry.code)):
            if known[key] > 0:
                known[key] -= 1
                break
        else:
            fresh.append(entry)
    return fresh


def _name(entry: Entry, path: str) -> str:
    """The path of the entry's file, relative to the folder of the baseline."""
    return seen_from(entry.diagnostic.path, os.path.abspath(path))


def _write(path: str, entries: Sequence[Entry]) -> None:
    counts = Counter((entry.fingerprint_as(_name(entry, path)), _name(entry, path), entry.code) for entry in entries)
    known = {key: {"file": file, "code": code, "count": count} for (key, file, code), count in counts.items()}
    text = json.dumps({"version": VERSION, "known": known}, indent=1, sort_keys=True) + "\n"
    try:
        write_file(path, text)
    except OSError as error:
        raise BaselineError(f"{path}: {error.strerror or error}") from None


_Key: TypeAlias = "str | tuple[str, str]"
"""A fingerprint. Messages of a rule may change together with its code, so a diagnostic with a former code is known by
its file and the code now."""


def _read(path: str) -> Counter[_Key]:
    try:
        table = json.loads(required(path, MAX_DATA).decode("utf-8"))
        known: Counter[_Key] = Counter()
        for fingerprint, row in table["known"].items():
            code = str(row.get("code", ""))
            key = fingerprint if code not in RENAMED_CODES else (str(row["file"]), RENAMED_CODES[code])
            known[key] += int(row["count"])
        return known
    except OSError as error:
        raise BaselineError(f"{path}: {error.strerror or error}") from None
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        raise BaselineError(f"{path}: not a baseline; remove it to write a new one") from None
