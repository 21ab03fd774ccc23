# SPDX-License-Identifier: Apache-2.0
"""The output formats of diagnostics: one module for each, all created from `Report`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from as2fm_lsp.cli.formats import github, gitlab, json, junit, sarif, text
from as2fm_lsp.cli.formats.report import Report

FORMATS: Mapping[str, Callable[[Report], str]] = {
    "text": text.render,
    "json": json.render,
    "github": github.render,
    "gitlab": gitlab.render,
    "sarif": sarif.render,
    "junit": junit.render,
}

__all__ = ["FORMATS", "Report"]
