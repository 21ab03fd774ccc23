# SPDX-License-Identifier: Apache-2.0
"""The formats in which diagnostics are written. Each format is a module with a function `render` that takes a
`CheckReport`."""

from __future__ import annotations

import importlib

from as2fm_lsp.cli.formats.report import CheckReport
from roaml.exhaustive import Vocabulary


class Format(Vocabulary):
    """A format of reports. For diagnostics, its value is the name of the module that writes it; CSV is only for
    values."""

    TEXT = "text"
    JSON = "json"
    GITHUB = "github"
    GITLAB = "gitlab"
    SARIF = "sarif"
    JUNIT = "junit"
    MARKDOWN = "markdown"
    CSV = "csv"

    @property
    def encoding(self) -> str | None:
        """The encoding of standard output; `None` for that of the terminal."""
        return None if self is Format.TEXT else "utf-8"


def render(report: CheckReport, format_: Format) -> str:
    """The report in one of the formats. Only the module of that format is imported."""
    text = importlib.import_module(f"as2fm_lsp.cli.formats.{format_.value}").render(report)
    assert isinstance(text, str)
    return text


__all__ = ["CheckReport", "Format", "render"]
