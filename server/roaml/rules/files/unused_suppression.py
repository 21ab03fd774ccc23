# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-suppression`, which unused_suppression.md describes. `roaml.project.checking` reports it,
because it has the findings of all rules."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Severity, Tag
from roaml.edit.elements import removal
from roaml.rules.rule import Rule, close_names, did_you_mean, listing, replacements
from roaml.text import Span, TextEdit


def finding(
    text: str, comment: Span, codes: Iterable[str] | None, used: Iterable[str], known: Iterable[str]
) -> Iterator[Finding]:
    """The findings for a comment that lists unknown codes, or that suppresses findings that do not occur; nothing if
    all codes of the comment are needed.

    Args:
        text: the text of the file.
        comment: the place of the comment.
        codes: the codes that the comment lists; `None` if the comment suppresses all rules.
        used: the codes of the findings that the comment suppresses.
        known: the codes of all rules.
    """
    used, known = frozenset(used), frozenset(known)
    misspelt = [code for code in codes or () if code not in known]
    if misspelt:
        yield from (_misspelt(text, comment, code, known) for code in misspelt)
        codes = [code for code in codes or () if code in known]
        if not codes:
            return
    kept = [code for code in codes or () if code in used]
    if codes is None and used:
        return
    superfluous = [code for code in codes or () if code not in used]
    if codes is not None and not superfluous and kept:
        return
    tags = (Tag.UNNECESSARY,)
    if not kept:
        fix = Fix("Remove the comment", (removal(text, comment),))
        yield RULE.at(comment, "unused suppression: this comment suppresses no finding", fix, tags=tags)
    else:
        fix = Fix(
            f"Remove {listing(superfluous)} from the comment",
            (TextEdit(comment, f"<!-- as2fm: ignore[{', '.join(kept)}] -->"),),
        )
        are = "is" if len(superfluous) == 1 else "are"
        yield RULE.at(comment, f"unused suppression: {listing(superfluous)} {are} not reported here", fix, tags=tags)


def _misspelt(text: str, comment: Span, code: str, known: Iterable[str]) -> Finding:
    close = close_names(code, sorted(known))
    word = re.compile(rf"(?<![\w-]){re.escape(code)}(?![\w-])").search(text, text.index("[", comment.start))
    fixes = replacements(Span(*word.span()), close) if word else ()
    return RULE.at(comment, f"there is no rule `{code}`{did_you_mean(close)}", *fixes)


RULE = Rule("unused-suppression", Severity.INFORMATION, "A comment suppresses findings that do not occur.", whole=True)
