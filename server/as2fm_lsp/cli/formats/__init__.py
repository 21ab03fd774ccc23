# SPDX-License-Identifier: Apache-2.0
"""The formats in which diagnostics are written. Each format is a module with a function `render` that takes a
`CheckReport`."""

from __future__ import annotations

import importlib

from as2fm_lsp.cli.formats.report import CheckReport

FORMATS = ("text", "json", "github", "gitlab", "sarif", "junit")


def render(report: CheckReport, name: str) -> str:
    """The report in one of the formats. Only the module of that format is imported."""
    text = importlib.import_module(f"as2fm_lsp.cli.formats.{name}").render(report)
    assert isinstance(text, str)
    return text


__all__ = ["FORMATS", "CheckReport", "render"]
