# SPDX-License-Identifier: Apache-2.0
"""JANI models in files."""

from __future__ import annotations

import os
from collections.abc import Mapping

from roaml.diagnostics import Diagnostic, Severity
from roaml.disk import MAX_DATA, NotReadableError, required
from roaml.jani.model import Model
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.text import SourceFile, decode


class PathError(ValueError):
    """Raised for a path that cannot be read, or that is not a file of the required kind. The message contains the
    reason."""


class JaniError(ValueError):
    """Raised for a JANI file with errors. `diagnostics` are the errors, with positions in `source`."""

    def __init__(self, diagnostics: tuple[Diagnostic, ...], source: SourceFile) -> None:
        super().__init__(f"{diagnostics[0].path}: {diagnostics[0].message}")
        self.diagnostics = diagnostics
        self.source = source


def read_jani(path: str, texts: Mapping[str, str | bytes] | None = None) -> tuple[Model, SourceFile]:
    """Read a JANI model; its positions are those in the file.

    Args:
        path: the file.
        texts: path -> text or bytes that replace the content of the file.

    Raises:
        PathError: the file cannot be read.
        JaniError: the file is not a JANI model, or has errors.
    """
    path = os.path.abspath(path)
    given = {os.path.abspath(name): text for name, text in (texts or {}).items()}.get(path)
    try:
        source = decode(path, _encoded(required(path, MAX_DATA) if given is None else given))
    except NotReadableError as error:
        raise PathError(str(error)) from None
    if source.undecodable is not None:
        raise PathError(f"{path}: not valid UTF-8; fix the encoding")
    value, syntax = parse(source.text)
    model, findings = (None, ()) if syntax else read_model(value, path)
    diagnostics = tuple(
        Diagnostic(path, finding.code, finding.severity or Severity.ERROR, finding.span, finding.message, source=source)
        for finding in (*syntax, *findings)
    )
    errors = tuple(diagnostic for diagnostic in diagnostics if diagnostic.severity is Severity.ERROR)
    if errors or model is None:
        raise JaniError(errors or diagnostics, source)
    return model, source


def _encoded(text: str | bytes) -> bytes:
    return text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
