# SPDX-License-Identifier: Apache-2.0
"""The reason why a tree cannot be translated."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.text import Location, Span
from roaml.xml_syntax.escapes import decoded

INVALID_SCRIPT = "the script is not valid"
"""The reason for a script with a syntax error."""


class TreeRefusal(Exception):  # noqa: N818 - the tree may be correct
    """Raised if a tree cannot be translated.

    Attributes:
        origin: the position of the cause.
        is_reported: whether the rules for nodes, ports and scripts also report the reason.
        unset: the name of the entry that a script, or a port of a tree without a system, reads and nothing sets, if
            this is the reason; otherwise "".
        script: the place of the script that contains the cause, whose text has its escapes resolved in `origin`, if it
            is a part of a script; otherwise `None`.
        all: this refusal, and those for other reasons, in the order of the text.
    """

    def __init__(
        self,
        origin: Location,
        reason: str,
        *,
        is_reported: bool = False,
        unset: str = "",
        script: Span | None = None,
    ) -> None:
        super().__init__(reason)
        self.script = script
        self.all: tuple[TreeRefusal, ...] = (self,)
        self.origin = origin
        self.reason = reason
        self.is_reported = is_reported
        self.unset = unset


def place_in(text: str, refusal: TreeRefusal) -> Span:
    """The place of the cause in the text of its file."""
    span, script = refusal.origin.span, refusal.script
    return span if script is None else decoded(text, script).span(span.start - script.start, span.end - script.start)


def first_of(refusals: Iterable[TreeRefusal]) -> TreeRefusal:
    """The first of some refusals, in the order of the text, with all of them."""
    reasons = {(r.origin.path, r.origin.span.start, r.reason): r for refusal in refusals for r in refusal.all}
    ordered = tuple(reasons[key] for key in sorted(reasons))
    result = ordered[0]
    result.all = ordered
    return result
