# SPDX-License-Identifier: Apache-2.0
"""The rule `model-too-large`, which model_too_large.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.kinds import FileKind
from roaml.model.size import Share, total
from roaml.rules.rule import Rule, SystemContext
from roaml.text import Span


def check(context: SystemContext) -> Iterator[Finding]:
    size, limits = context.size, context.limits
    cells, parts = total(size.cells), total(size.parts)
    if cells > limits.cells:
        message = (
            f"the variables of this system have {cells:,} cells, but at most {limits.cells:,} are translated: "
            f"{size.cells[0].words} takes {size.cells[0].count:,}; make arrays smaller, or raise `max-cells`"
        )
        yield _finding(context, size.cells[0], message)
    if parts > limits.parts:
        message = (
            f"the translation of this system has about {parts:,} parts, but at most {limits.parts:,} are written: "
            f"{size.parts[0].words} takes {size.parts[0].count:,}; divide the system, or raise `max-parts`"
        )
        yield _finding(context, size.parts[0], message)


def _finding(context: SystemContext, largest: Share, message: str) -> Finding:
    related = (Related(largest.symbol, "this is the largest part"),) if largest.symbol and largest.path else ()
    return RULE.at(_place(context, largest), message, related=related)


def _place(context: SystemContext, largest: Share) -> Span:
    """The place where the file of the largest part is listed; if the part has no file, the place where the tree is
    listed or, without a tree, the name of the root."""
    for listed in context.files:
        of_tree = not largest.path and listed.required_kind is FileKind.TREE
        if listed.input.src is not None and (of_tree or (largest.path and listed.path == largest.path)):
            return listed.input.src.span
    return context.file.element.name_span


RULE = Rule("model-too-large", Severity.ERROR, "A system is too large to be translated.", system=check)
