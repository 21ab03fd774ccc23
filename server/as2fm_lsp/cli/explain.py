# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp --explain CODE`"""

from __future__ import annotations

import sys

from as2fm_lsp.cli.check import CLEAN, USAGE
from as2fm_lsp.cli.output import print_text
from roaml.rules import BY_CODE, document
from roaml.rules.rule import close_names


def run(code: str) -> int:
    if code not in BY_CODE:
        close = close_names(code, BY_CODE)
        hint = f"; did you mean {close[0]}?" if close else ""
        print(f"as2fm-lsp: there is no rule {code}{hint}", file=sys.stderr)
        return USAGE
    print_text(document(code))
    return CLEAN
