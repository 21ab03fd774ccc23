# SPDX-License-Identifier: Apache-2.0
"""Arguments of the command line; the error for a misspelled option, command or rule suggests the nearest one."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from as2fm_lsp.cli.output import Verbosity, print_text, set_verbosity
from roaml.exhaustive import Vocabulary
from roaml.suggest import close_names, did_you_mean

if TYPE_CHECKING:
    from _typeshed import SupportsWrite


class ArgumentParser(argparse.ArgumentParser):
    """An `argparse.ArgumentParser` whose errors for unknown arguments contain suggestions. Descriptions keep their
    lines. Every command has the options `--quiet` and `--verbose`."""

    def __init__(self, *, prog: str, description: str, epilog: str, usage: str | None = None) -> None:
        super().__init__(
            prog=prog,
            description=description,
            epilog=epilog,
            usage=usage,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        amount = self.add_mutually_exclusive_group()
        for short, name, verbosity, help_ in (
            ("-q", "--quiet", Verbosity.QUIET, "write only results and errors: no notes, summary and progress"),
            ("-v", "--verbose", Verbosity.VERBOSE, "also write on standard error what is read and how long it takes"),
        ):
            amount.add_argument(
                short, name, dest="verbosity", action="store_const", const=verbosity, default=Verbosity.NORMAL,
                help=help_,
            )  # fmt: skip

    def parse_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: None = None
    ) -> argparse.Namespace:
        options, unknown = self.parse_known_args(args, namespace)
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}{self._hint(unknown)}")
        set_verbosity(options.verbosity)
        return options

    def _hint(self, unknown: Sequence[str]) -> str:
        for argument in unknown:
            if argument.startswith("--") and (
                close := close_names(argument.partition("=")[0], self._option_string_actions)
            ):
                return did_you_mean(close)
        return ""

    def _print_message(self, message: str, file: SupportsWrite[str] | None = None) -> None:
        if file is sys.stdout:
            print_text(message)  # unlike argparse, raises an error if the stream cannot be written
        else:
            super()._print_message(message, file)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            close = close_names(str(value), map(str, action.choices or ()))
            raise argparse.ArgumentError(action, f"{error.message}{did_you_mean(close)}") from None


class WordAction(argparse.Action):
    """Stores a member of an enumeration. The argument is the value of the member.

    Args:
        words: the members that users may choose.
    """

    def __init__(self, option_strings: Sequence[str], dest: str, *, words: Iterable[Vocabulary], **rest: Any) -> None:
        self._members = {str(member): member for member in words}
        super().__init__(option_strings, dest, choices=tuple(self._members), **rest)

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        setattr(namespace, self.dest, self._members[values])


def unknown_rule(code: str) -> str:
    """The error message for an unknown rule code."""
    from roaml.rules import BY_CODE  # noqa: PLC0415 - other commands start faster without the rules

    hint = did_you_mean(close_names(code, BY_CODE)) or "; `as2fm-lsp explain` lists all rules"
    return f"there is no rule `{code}`{hint}"
