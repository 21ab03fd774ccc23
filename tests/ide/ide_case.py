# SPDX-License-Identifier: Apache-2.0
"""Helpers of the tests of editor features: files in memory, and marked places in them."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping

from fixture import guess_name, split_files
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.text import Span

FOLDER = os.path.join(os.sep, "nowhere", "ide")

_MARK = re.compile(r"‸|«|»")


def path_of(name: str) -> str:
    return os.path.join(FOLDER, *name.split("/"))


def analysis_of(texts: Mapping[str, str]) -> Analysis:
    """The analysis of some files: name -> text."""
    workspace = Workspace((), Settings())
    for name, text in texts.items():
        workspace.open(path_of(name), text)
    return workspace.snapshot().analysis


def one_file(text: str) -> tuple[Analysis, str]:
    """The analysis of one file, and its path."""
    name = guess_name(text)
    return analysis_of({name: text}), path_of(name)


def several_files(written: str) -> Analysis:
    return analysis_of(split_files(written))


def marked(written: str) -> tuple[str, list[int], list[Span]]:
    """A text without its marks, the places of `‸` in it, and the spans of `«…»` in the order of their beginnings."""
    parts: list[str] = []
    length = done = 0
    carets: list[int] = []
    spans: list[list[int]] = []
    opened: list[list[int]] = []
    for mark in _MARK.finditer(written):
        part = written[done : mark.start()]
        parts.append(part)
        length += len(part)
        done = mark.end()
        if mark[0] == "‸":
            carets.append(length)
        elif mark[0] == "«":
            opened.append([length, length])
            spans.append(opened[-1])
        else:
            opened.pop()[1] = length
    return "".join([*parts, written[done:]]), carets, [Span(*span) for span in spans]
