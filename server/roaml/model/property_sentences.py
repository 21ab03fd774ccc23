# SPDX-License-Identifier: Apache-2.0
"""The properties of a property file in XML as English sentences. Every view of a property shows the same sentence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.expr.tree import Name as NameExpr
from roaml.model.property_file import (
    ObservedPart,
    Port,
    PortKind,
    PortVariableKind,
    PropertyFile,
    PropertySection,
    WrittenProperty,
)
from roaml.model.syntax import Expression, Name
from roaml.observers.properties import CLOSE, LEFT, OPEN, RIGHT, Pattern, ScopeKind
from roaml.observers.sentences import SentenceClause, Times, formula_sentence, pattern_formula, pattern_sentence


def sentence(file: PropertyFile, written: WrittenProperty) -> str:
    """A sentence that states the requirement of a property, with names in backquotes; "" if the property has neither a
    pattern nor a formula."""
    text = _sentence(file, written)
    if text and written.expect is not None:
        text = f"{text[:-1]}; the expected probability is {quoted(written.expect.value)}."
    return f"Assumed: {text[:1].lower()}{text[1:]}" if text and written.section is PropertySection.ASSUMES else text


def sentences(file: PropertyFile) -> Mapping[str, str]:
    """The sentence of each property, by the name of the property."""
    return {written.id.value: sentence(file, written) for written in file.properties if written.id is not None}


def formula(written: WrittenProperty) -> str:
    """A property as a formula in one line; "" if it has neither a pattern nor a formula."""
    if written.formula is not None:
        return " ".join(written.formula.source.text.split())
    pattern, kind = pattern_of(written), scope_of(written)
    if pattern is None:
        return ""
    conditions = {name: f"({text})" if " " in text else text for name, text in _conditions(written)}
    return pattern_formula(pattern, kind or ScopeKind.GLOBALLY, conditions, _times(written))


def pattern_of(written: WrittenProperty) -> Pattern | None:
    return next((p for p in Pattern if written.pattern is not None and written.pattern.value == p.value), None)


def scope_of(written: WrittenProperty) -> ScopeKind | None:
    type_ = written.scopes[0].type if written.scopes else None
    return next((kind for kind in ScopeKind if type_ is not None and type_.value == kind.value), None)


def _conditions(written: WrittenProperty) -> Iterator[tuple[str, str]]:
    for name, condition in conditions_of(written).items():
        yield name, " ".join(condition.text.split())


def conditions_of(written: WrittenProperty) -> dict[str, Expression]:
    """The conditions of a pattern and its scope, by the names of the inputs of its observer."""
    conditions = dict(zip((LEFT, RIGHT), written.conditions, strict=False))
    scope = written.scopes[0] if written.scopes else None
    if scope is not None and scope.event is not None:
        conditions[OPEN] = scope.event
    if scope is not None and scope.until is not None:
        conditions[CLOSE] = scope.until
    return conditions


def _sentence(file: PropertyFile, written: WrittenProperty) -> str:
    ports = {
        variable.id.value: port
        for port, variable in file.variables
        if variable.id and variable.kind is PortVariableKind.EVENT
    }
    if written.formula is not None and written.formula.notation.formula is not None:
        clauses = {atom.text.strip(): clause(atom, ports) for atom in written.formula.atoms}
        return formula_sentence(written.formula.notation.formula, clauses)
    pattern = pattern_of(written)
    if pattern is None:
        return ""
    clauses = {name: clause(condition, ports) for name, condition in conditions_of(written).items()}
    return pattern_sentence(pattern, scope_of(written) or ScopeKind.GLOBALLY, clauses, _times(written))


def clause(condition: Expression, ports: Mapping[str, Port]) -> SentenceClause:
    """A condition as a clause. A condition that is only an event variable gives the clause that the event is sent;
    other conditions give the clause that they hold.

    Args:
        ports: id of an event variable -> its port.
    """
    tree = condition.tree
    port = ports.get(tree.name) if isinstance(tree, NameExpr) else None
    if port is not None and port.name is not None:
        return event_clause(port)
    return SentenceClause(quoted(condition.text), "holds")


def quoted(text: str) -> str:
    """A name or condition in backquotes. Backquotes in it are replaced, so that it remains code in Markdown."""
    return f"`{' '.join(text.split()).replace('`', chr(39)) or '…'}`"


def event_clause(port: Port) -> SentenceClause:
    """The clause that the event of a port is sent."""
    name = quoted(port.name.value) if port.name is not None else "…"
    by = f" by {quoted(port.origin.value)}" if port.origin is not None else ""
    to = f" to {quoted(port.target.value)}" if port.target is not None else ""
    part = port.part
    if port.kind is PortKind.TOPIC:
        return _is("a message", f"published on {name}{by}")
    if port.kind is PortKind.SERVICE:
        return _is(f"a response of {name}", f"sent{to}") if part is ObservedPart.RESPONSE else _is(name, f"called{by}")
    if port.kind is PortKind.ACTION:
        match part:
            case ObservedPart.GOAL_RESPONSE:
                return _is(f"a goal{by} for {name}", "accepted or rejected")
            case ObservedPart.CANCEL_REQUEST:
                return _is(f"cancelling a goal of {name}", f"requested{by}")
            case ObservedPart.FEEDBACK | ObservedPart.RESULT:
                return _is(f"{'feedback' if part is ObservedPart.FEEDBACK else 'a result'} of {name}", f"sent{to}")
        return _is("a goal", f"sent to {name}{by}")
    if port.kind is PortKind.NODE:
        return (
            SentenceClause(name, "answers")
            if part is ObservedPart.RESPONSE
            else _is(name, "halted" if part is ObservedPart.HALT else "ticked")
        )
    return _is(name, f"sent{by}{to}")


def _is(subject: str, participle: str) -> SentenceClause:
    return SentenceClause(subject, participle, "is")


def _times(written: WrittenProperty) -> Times:
    if not written.intervals:
        return Times()
    interval = written.intervals[0]
    unit = interval.unit.value if interval.unit is not None else ""

    def with_unit(number: Name | None) -> str:
        return f"{number.value} {unit}".strip() if number is not None else ""

    return Times(with_unit(interval.after), with_unit(interval.time or interval.within))
