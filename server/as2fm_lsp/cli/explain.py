# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp explain CODE`, or `as2fm-lsp --explain CODE`"""

from __future__ import annotations

from collections.abc import Sequence

from as2fm_lsp.cli.arguments import ArgumentParser, unknown_rule
from as2fm_lsp.cli.exit_status import CLEAN, USAGE
from as2fm_lsp.cli.output import complain, print_text
from roaml.rules import BY_CODE, cited, document

EXAMPLES = """\
example:
  as2fm-lsp explain late-event-data

exit status: 0 success, 2 unknown rule
"""


def run(arguments: Sequence[str]) -> int:
    return explain(parser().parse_args(arguments).code)


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp explain",
        description="Print the document of a rule: what it reports, why this is a problem, and how to fix it.",
        epilog=EXAMPLES,
    )
    result.add_argument("code", metavar="CODE", help="the name of the rule, as it is shown after a finding")
    return result


def explain(code: str) -> int:
    """Print the document of a rule; return the exit status."""
    if code not in BY_CODE:
        complain(unknown_rule(code))
        return USAGE
    print_text(cited(document(code)))
    return CLEAN
