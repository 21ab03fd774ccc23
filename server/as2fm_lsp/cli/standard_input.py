# SPDX-License-Identifier: Apache-2.0
"""Models on standard input: the path `-`.

The text gets a name, so that all commands and messages treat it as a file: the one of `--stdin-filename`, otherwise
`<stdin>.xml` in the working directory, or `<stdin>.jani` if the text is JSON. Files that the text names are looked up
in the folder of that name.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping

from as2fm_lsp.outputs import InputPath

STANDARD_INPUT_PATH = "-"
"""The path that means standard input."""
_JSON_STARTS = (b"{", b"[")
_BYTE_ORDER_MARKS = b"\xef\xbb\xbf\xff\xfe\x00"


def add_stdin_filename(parser: argparse._ActionsContainer) -> None:
    """Add the option that names the text on standard input."""
    parser.add_argument(
        "--stdin-filename",
        type=InputPath,
        metavar="FILE",
        help="read the text of FILE, also written as -, from standard input",
    )


def named_input(path: str, options: argparse.Namespace) -> tuple[InputPath, Mapping[str, bytes]]:
    """The path of a model, and the texts that replace the content of files: if the path is `-`, the path by which
    standard input is known, and its text; otherwise `path` and nothing."""
    if path != STANDARD_INPUT_PATH:
        return InputPath(path), {}
    data = sys.stdin.buffer.read()
    name = options.stdin_filename or _default_name(data)
    return InputPath(name), {os.path.abspath(name): data}


def _default_name(data: bytes) -> str:
    is_json = data.lstrip(_BYTE_ORDER_MARKS + b" \t\r\n").startswith(_JSON_STARTS)
    return "<stdin>.jani" if is_json else "<stdin>.xml"
