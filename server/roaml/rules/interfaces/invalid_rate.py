# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-rate`, which invalid_rate.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.model.expand import PortConstant
from roaml.model.machine import Declaration
from roaml.model.syntax import Name, PortRead
from roaml.regex import regex
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, replacements
from roaml.text import Span, TextEdit

SLOWEST = 1e-9
"""The lowest rate of a timer, in Hz, included."""
FASTEST = 1e9
"""The highest rate of a timer, in Hz, included."""
ALMOST = regex(r"(\d+)(?:[.,](\d+))?\s*(?:hz)?\Z", re.IGNORECASE | re.ASCII)
"""A rate that may be written with a decimal comma or the unit Hz."""


def check(context: MachineContext) -> Iterator[Finding]:
    for declaration in context.machine.declarations:
        if declaration.kind is not SymbolKind.TIMER:
            continue
        match declaration.rate:
            case None:
                yield _missing(declaration)
            case Name(value=text, span=span) if reason := rate_problem(text):
                yield RULE.at(span, reason, *replacements(span, _corrected(text)))
            case PortRead():
                yield from _port(context, declaration.rate)


def _missing(declaration: Declaration) -> Finding:
    element = declaration.element
    attribute = element.get("rate_hz")
    end = element.attributes[-1].span.end if element.attributes else element.name_span.end
    edit = TextEdit(Span(end, end) if attribute is None else attribute.span, f'{" " * (attribute is None)}rate_hz="1"')
    fix = Fix("Add a rate of 1 Hz", (edit,), preferred=False)
    return RULE.at(element.name_span, "the timer has no rate; add `rate_hz`", fix)


def _port(context: MachineContext, read: PortRead) -> Iterator[Finding]:
    """Check the rates that the nodes of the tree pass through a port."""
    key = read.key.value if read.key else ""
    for automaton in context.automata:
        value = automaton.port(key)
        if isinstance(value, PortConstant) and (reason := rate_problem(value.text)):
            yield RULE.at(read.span, f'{reason}; the tree passes `{key}="{value.text}"`')


def rate_problem(text: str) -> str:
    """The reason why `text` is not a rate in Hz, or an empty string if it is one."""
    try:
        rate = float(text)
    except ValueError:
        return f"a rate must be a number in Hz, not `{text[:40]}`"
    if not 0 < rate < float("inf"):
        return f"a rate must be finite and greater than 0 Hz, not `{text[:40]}`"
    if rate < SLOWEST:
        return "a rate must be at least 1e-9 Hz, one tick in 31 years; check the exponent"
    if rate > FASTEST:
        return "a rate must be at most 1 GHz, because the clock has a resolution of 1 ns"
    return ""


def _corrected(text: str) -> tuple[str, ...]:
    match = ALMOST.match(text.strip())
    if match is None or not rate_problem(text):
        return ()
    number = f"{match[1]}.{match[2]}" if match[2] else match[1]
    return () if rate_problem(number) else (number,)


RULE = Rule("invalid-rate", Severity.ERROR, "The rate of a timer is not a positive number.", machine=check)
