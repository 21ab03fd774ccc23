# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp --explain CODE`"""

from __future__ import annotations

from as2fm_lsp.cli.arguments import unknown_rule
from as2fm_lsp.cli.check import CLEAN, USAGE
from as2fm_lsp.cli.output import complain, print_text
from roaml.rules import BY_CODE, cited, document


def run(code: str) -> int:
    if code not in BY_CODE:
        complain(unknown_rule(code))
        return USAGE
    print_text(cited(document(code)))
    return CLEAN
