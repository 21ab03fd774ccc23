# SPDX-License-Identifier: Apache-2.0
"""The rule `foreign-format`, which foreign_format.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.machine import Dialect
from roaml.rules.rule import FileContext, MachineContext, Rule
from roaml.text import Span


def check(context: FileContext) -> Iterator[Finding]:
    document = context.document
    if document is not None and document.root is not None and document.root.name == "specification":
        yield RULE.at(document.root.name_span, "this is a specification for another tool; it is not checked")


def check_machine(context: MachineContext) -> Iterator[Finding]:
    if context.dialect is Dialect.FOREIGN:
        span: Span = context.machine.element.name_span
        yield RULE.at(span, "this state machine is written for another tool; only its syntax is checked")


RULE = Rule(
    "foreign-format",
    Severity.INFORMATION,
    "The file is written for another tool.",
    file=check,
    machine=check_machine,
    plain=True,
)
