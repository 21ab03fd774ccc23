# SPDX-License-Identifier: Apache-2.0
"""The rule `branch-order`, which branch_order.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.model.vocabulary import BRANCH_MARKERS
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.elements import own_elements
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Element


def check(context: MachineContext) -> Iterator[Finding]:
    for element in own_elements(context.document):
        if element.name != "if":
            continue
        closed = False
        for child in element.elements:
            if child.name == "elseif" and closed:
                message = "an `<elseif>` after the `<else/>` is never reached; move it before the `<else/>`"
                yield RULE.at(child.name_span, message)
            if child.name in BRANCH_MARKERS and child.elements:
                message = f"`<{child.name}/>` must be empty; write its content after it"
                yield RULE.at(child.name_span, message, *_unwrapped(child))
            closed = closed or child.name == "else"


def _unwrapped(marker: Element) -> Iterator[Fix]:
    if marker.complete and marker.close_span is not None:
        end = marker.open_span.end
        close = TextEdit(Span(end - 1, end), " />")
        yield Fix(f"Close `<{marker.name}/>` before its content", (close, TextEdit(marker.close_span, "")))


RULE = Rule("branch-order", Severity.ERROR, "The branches of an `<if>` are not in order.", machine=check, plain=True)
