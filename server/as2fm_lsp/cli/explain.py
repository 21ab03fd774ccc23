# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp explain CODE`, or `as2fm-lsp --explain CODE`"""

from __future__ import annotations

from collections.abc import Sequence

from as2fm_lsp.cli.arguments import ArgumentParser, unknown_rule
from as2fm_lsp.cli.exit_status import CLEAN, USAGE
from as2fm_lsp.cli.output import complain, print_text
from roaml.diagnostics import current_code
from roaml.rules import BY_CODE, RULES, cited, document

EXAMPLES = """\
examples:
  as2fm-lsp explain late-event-data
  as2fm-lsp explain                     all rules, each with its severity and what it reports

exit status: 0 success, 2 unknown rule
"""


def run(arguments: Sequence[str]) -> int:
    code = parser().parse_args(arguments).code
    return _list() if code is None else explain(code)


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp explain",
        description="Print the document of a rule: what it reports, why this is a problem, and how to fix it.",
        epilog=EXAMPLES,
    )
    result.add_argument(
        "code",
        nargs="?",
        metavar="CODE",
        help="the name of the rule, as it is shown after a finding; without it, all rules are listed",
    )
    return result


def _list() -> int:
    """Print the names, severities and summaries of all rules, by name; return the exit status."""
    rules = sorted(RULES, key=lambda rule: rule.code)
    width = max(len(rule.code) for rule in rules)
    print_text("".join(f"{rule.code:<{width}}  {rule.severity.label:<11}  {rule.summary}\n" for rule in rules))
    return CLEAN


def explain(code: str) -> int:
    """Print the document of a rule; return the exit status."""
    code = current_code(code)
    if code not in BY_CODE:
        complain(unknown_rule(code))
        return USAGE
    print_text(cited(document(code)))
    return CLEAN
