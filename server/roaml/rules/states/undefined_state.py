# SPDX-License-Identifier: Apache-2.0
"""The rule `undefined-state`, which undefined_state.md describes."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import after
from roaml.model.machine import Chart, Dialect
from roaml.model.syntax import Name
from roaml.regex import regex
from roaml.rules.rule import MachineContext, Rule, close_names, replacements
from roaml.rules.support import misspelled
from roaml.rules.support.states import references
from roaml.suggest import alternatives
from roaml.xml_syntax import Document, Element

STATES = ("state", "parallel", "final", "history")
VALID = regex(r"[A-Za-z_][\w.-]*\Z", re.ASCII)
WORD = regex(r"\S+")


def check(context: MachineContext) -> Iterator[Finding]:
    anywhere = set(_states_below(context.machine.element))
    if context.dialect in (Dialect.PLAIN, Dialect.FOREIGN):
        for name in _plain_references(context.document, context.machine.element):
            if name.value not in anywhere:
                yield _finding(name, anywhere)
        return
    elsewhere = anywhere - {state.id.value for chart in context.machine.charts for state in chart.states if state.id}
    for chart in context.machine.charts:
        states = [state.id.value for state in chart.states if state.id]
        for name in references(chart) if chart.states else ():
            # misplaced-element reports a state in a place where none is allowed
            if name.value in states or name.value in elsewhere:
                continue
            if not misspelled.declaration(context.machine, "state", name.value):
                yield _finding(name, states, *_add(context, chart, name.value, states))


def _finding(name: Name, states: Collection[str], *more: Fix) -> Finding:
    close = close_names(name.value, states)
    message = f"there is no state `{name.value}`{alternatives(close, states, 'state')}"
    return RULE.at(name.span, message, *replacements(name.span, close), *more)


def _add(context: MachineContext, chart: Chart, name: str, states: Collection[str]) -> Iterator[Fix]:
    """A fix that adds a state after the other states."""
    if VALID.match(name):
        edit = after(context.document, chart.states[-1].element, f'<state id="{name}" />')
        yield Fix(f"Add the state `{name}`", (edit,), preferred=not close_names(name, states))


def _states_below(root: Element) -> Iterator[str]:
    for element in root.walk():
        id_ = element.get("id") if element.name in STATES else None
        if id_ is not None:
            yield id_.value.strip()


def _plain_references(document: Document, root: Element) -> Iterator[Name]:
    """The references to states in plain SCXML, where states are nested and a transition may have several targets."""
    for element in root.walk():
        attribute = element.get("target" if element.name == "transition" else "initial")
        if attribute is not None and attribute.has_value and element.name in ("scxml", "state", "transition"):
            source = document.decoded(attribute.value_span)
            for word in WORD.finditer(source.text):
                yield Name(word[0], source.span(*word.span()))


RULE = Rule(
    "undefined-state", Severity.ERROR, "A name refers to a state that does not exist.", machine=check, plain=True
)
