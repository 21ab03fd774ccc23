# SPDX-License-Identifier: Apache-2.0
"""The forms in which diagnostics are written: one module each, all made from `CheckReport`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from as2fm_lsp.cli.formats import github, gitlab, json, junit, sarif, text
from as2fm_lsp.cli.formats.report import CheckReport

FORMATS: Mapping[str, Callable[[CheckReport], str]] = {
    "text": text.render,
    "json": json.render,
    "github": github.render,
    "gitlab": gitlab.render,
    "sarif": sarif.render,
    "junit": junit.render,
}

__all__ = ["FORMATS", "CheckReport"]
