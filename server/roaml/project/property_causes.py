# SPDX-License-Identifier: Apache-2.0
"""Findings at the condition that is to blame for a property that nothing tests or that no run satisfies.

Whether a part of a condition is ever true is asked by the observer of another property: that this part is true at some
time. So it is judged exactly as in the property itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Protocol, TypeAlias

from roaml.comparison import as_written
from roaml.diagnostics import Finding, Related
from roaml.expr.tree import Expr, Name, walk
from roaml.jani.expressions import Binary as JaniBinary
from roaml.jani.expressions import Expression as JaniExpression
from roaml.jani.expressions import Name as JaniName
from roaml.jani.model import Model
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import eventually, identifiers
from roaml.model.property_links import LinkedProperty
from roaml.observers.properties import ANY_TIME, CLOSE, LEFT, OPEN, RIGHT, Pattern, PatternProperty
from roaml.project.analysis import Analysis
from roaml.project.exploration import with_reactions
from roaml.project.property_search import Doubt, Doubted
from roaml.record import replace
from roaml.rules.properties import never_satisfied, unmet_expectation, vacuous_property
from roaml.rules.support.known_parts import conjuncts
from roaml.scxml.model import Network
from roaml.scxml.names import flag_of, sent_by
from roaml.scxml.observed import ObservedPort, ObservedProperty
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker
from roaml.text import Location, Span
from roaml.to_jani import translate
from roaml.views.ends import marks, observer_outputs
from roaml.xml_syntax.escapes import unescape

MAX_SENDERS = 5
"""The maximum number of related places where an event is sent."""
MAX_VALUES = 4
"""The maximum number of values that are listed one by one."""
_NOT_TESTED = (Doubt.SCOPE, Doubt.TRIGGER)


Values: TypeAlias = "Mapping[str, set[float]]"
"""Variable of a port -> the values that it has after a message."""


class Evidence(Protocol):
    """Answers about all runs of a system, or about simulated ones."""

    def never(self, checker: ModelChecker, ports: Sequence[ObservedPort], *, is_notable: bool) -> Values | None:
        """The values that the variables of the ports have after a message, if what the only property of the model
        checker states, that something happens at some time, is true in no run; otherwise `None`.

        Args:
            is_notable: whether this must be notable by itself: simulated runs must send many messages to each port.
        """

    def always(self, checker: ModelChecker) -> bool:
        """Whether the only property of the model checker holds in all runs."""


class Causes:
    """The causes of doubts about the properties of one system.

    Args:
        network: the system.
        evidence: answers further questions about it.
    """

    def __init__(self, analysis: Analysis, path: str, network: Network, evidence: Evidence) -> None:
        self._analysis = analysis
        self._network = network
        self._evidence = evidence
        self._linked = {
            linked.name: linked
            for listed in analysis.listed(path)
            if (file := analysis.linked_properties(listed.path, path)) is not None
            for linked in file.properties
        }

    def findings(self, doubted: Doubted) -> Iterator[tuple[str, Finding]]:
        """The paths of files, and the findings about a property with a doubt."""
        linked, observed = self._linked.get(doubted.property.name), doubted.observed
        if linked is not None and observed is not None:
            cause = None if doubted.values.upper > 0.0 and doubted.doubt is Doubt.UNMET else observed
            found = None if cause is None else self._never_true(doubted, linked, cause)
            if found is None and cause is not None and not doubted.simulated and self._depends_on_reactions:
                found = self._never_true(replace(doubted, is_instant=True), linked, cause)
            if found is not None:
                yield linked.path, found
                return
            if cause is not None and (late := self._of_time(doubted, linked, observed)) is not None:
                yield linked.path, late
                return
            if doubted.doubt is not Doubt.UNMET:
                # In few runs, what never happens in the right order may only be rare.
                if not (doubted.simulated and doubted.doubt in _NOT_TESTED):
                    yield linked.path, self._of_order(doubted, linked, observed)
                return
        origin = doubted.property.origin or doubted.property.expression.origin
        expect = None if linked is None else linked.written.expect
        if linked is not None and expect is not None and observed is not None and doubted.expected == observed.expected:
            origin = Location(linked.path, expect.span)
        if origin is not None and doubted.doubt is Doubt.UNMET:
            yield origin.path, _unmet(doubted, origin)
        elif origin is not None:
            why = "what must happen before the property requires anything never happens"
            yield (
                origin.path,
                vacuous_property.finding(origin.span, doubted.property.name, why, (), is_instant=doubted.is_instant),
            )

    def _never_true(self, doubted: Doubted, linked: LinkedProperty, observed: ObservedProperty) -> Finding | None:
        """The finding about the first part of a condition that is never true; `None` if each is true in some run."""
        relevant = [observed.conditions[name] for name in _relevant(doubted.doubt, observed)]
        parts = [part for condition in relevant for part, holds in conjuncts(condition, holds=True) if holds]
        for part in dict.fromkeys((*parts, *relevant)):
            values = self._when(doubted, observed, part)
            if values is None:
                continue
            stated = "; ".join(f"`{name}` is {_listed(known)}" for name, known in values.items() if known)
            why = f"`{self._text(linked, part)}` is never true" + (f" ({stated})" if stated else "")
            return _finding(doubted, linked, part.span, why, self._senders(observed, part))
        return None

    @property
    def _depends_on_reactions(self) -> bool:
        """Whether machines of the system may react at once or later."""
        return any(assumes_more for _, assumes_more in with_reactions(translate(self._network, (), ())))

    def _model(self, asked: ObservedProperty, *, is_instant: bool) -> Model:
        """The system with another property."""
        model = translate(self._network, (), (asked,))
        return next(variant for variant, assumes_more in with_reactions(model) if assumes_more is is_instant)

    def _when(self, doubted: Doubted, observed: ObservedProperty, condition: Expr) -> Values | None:
        """The values of the variables of a condition if it is true in no run of the system; otherwise `None`."""
        asked = replace(
            observed, property=PatternProperty(Pattern.EXISTENCE), conditions={LEFT: condition}, expected=None
        )
        model = self._model(asked, is_instant=doubted.is_instant)
        [property_] = model.properties
        known = {variable.name for variable in model.variables}
        read = [*(name for name, _ in identifiers(property_.expression)), *_read(observed, condition)]
        # A search keeps the values of the variables that the property reads.
        happens: JaniExpression = JaniName(read[0])
        for name in read[1:]:
            if name in known:
                same = JaniBinary(BinaryOperator.EQUAL, JaniName(name), JaniName(name))
                happens = JaniBinary(BinaryOperator.AND, happens, same)
        try:
            checker = ModelChecker(model, [eventually(property_.name, happens)], marks(model))
        except FaultError:
            return None
        if checker.refused:
            return None
        return self._evidence.never(checker, _ports_of(observed, condition), is_notable=doubted.doubt in _NOT_TESTED)

    def _of_order(self, doubted: Doubted, linked: LinkedProperty, observed: ObservedProperty) -> Finding:
        """The finding about a property each of whose conditions is true in some run."""
        name = _relevant(doubted.doubt, observed)[0]
        condition = linked.conditions[name]
        others = [
            Related(Location(linked.path, other.span), "the other condition")
            for key, other in linked.conditions.items()
            if key != name
        ]
        if doubted.doubt is Doubt.SCOPE:
            why = "no run contains a part from the beginning of the scope to its end"
        elif doubted.doubt is Doubt.TRIGGER:
            where = "inside of the scope" if OPEN in linked.conditions else "where the property requires something"
            why = f"`{self._text(linked, condition.tree)}` is never true {where}"
        else:
            why = _why_never(observed, self._text(linked, condition.tree), doubted.simulated)
            if self._holds_exchanged(observed, is_instant=doubted.is_instant):
                why += "; with both conditions exchanged, it always holds"
        return _finding(doubted, linked, condition.span, why, others)

    def _of_time(self, doubted: Doubted, linked: LinkedProperty, observed: ObservedProperty) -> Finding | None:
        """The finding about a property that would always hold without its time interval; `None` for others."""
        property_, intervals = observed.property, linked.written.intervals
        if doubted.doubt in _NOT_TESTED or not isinstance(property_, PatternProperty) or not intervals:
            return None
        if property_.pattern is Pattern.RECURRENCE or property_.window.is_unbounded:
            return None
        relaxed = replace(observed, property=replace(property_, window=ANY_TIME))
        if not self._always_holds(relaxed, is_instant=doubted.is_instant):
            return None
        why = "without this time interval, it always holds"
        return _finding(doubted, linked, intervals[0].element.name_span, why, ())

    def _holds_exchanged(self, observed: ObservedProperty, *, is_instant: bool) -> bool:
        """Whether a property holds in all runs with its conditions exchanged."""
        property_ = observed.property
        if not isinstance(property_, PatternProperty) or not property_.pattern.is_binary:
            return False
        left, right = observed.conditions[LEFT], observed.conditions[RIGHT]
        exchanged = replace(observed, conditions={**observed.conditions, LEFT: right, RIGHT: left})
        return self._always_holds(exchanged, is_instant=is_instant)

    def _always_holds(self, asked: ObservedProperty, *, is_instant: bool) -> bool:
        """Whether another property holds in all runs."""
        model = self._model(replace(asked, expected=None), is_instant=is_instant)
        try:
            checker = ModelChecker(model, model.properties, marks(model), outputs=observer_outputs(model))
        except FaultError:
            return False
        return self._evidence.always(checker)

    def _text(self, linked: LinkedProperty, part: Expr) -> str:
        source = self._analysis.source(linked.path)
        return "this condition" if source is None else unescape(source.text[part.span.start : part.span.end])

    def _senders(self, observed: ObservedProperty, part: Expr) -> Iterator[Related]:
        """The places that send the events on which a condition depends."""
        events = {
            event.name: variable.id
            for port in _ports_of(observed, part)
            for variable in port.variables
            for event in port.events
        }
        edges = (edge for automaton in translate(self._network, (), ()).automata for edge in automaton.edges)
        found = {
            edge.origin: events[event]
            for edge in edges
            if (event := sent_by(edge.action or "")) in events and edge.origin is not None
        }
        for origin, variable in list(found.items())[:MAX_SENDERS]:
            yield Related(origin, f"sends `{variable}`")


def _ports_of(observed: ObservedProperty, part: Expr) -> list[ObservedPort]:
    """The ports of a property from which a condition reads variables, with these variables."""
    names = _names(part)
    ports = (replace(p, variables=tuple(v for v in p.variables if v.id in names)) for p in observed.ports)
    return [port for port in ports if port.variables]


def _relevant(doubt: Doubt, observed: ObservedProperty) -> list[str]:
    """The conditions one of which is to blame, the most likely first."""
    property_ = observed.property
    names = list(observed.conditions)
    if not isinstance(property_, PatternProperty):
        return names
    scope = [name for name in (OPEN, CLOSE) if name in names]
    if doubt is Doubt.SCOPE or (doubt is Doubt.TRIGGER and not property_.pattern.is_binary):
        return scope
    if doubt is Doubt.TRIGGER:
        return [RIGHT if property_.pattern is Pattern.PRECEDENCE else LEFT, *scope]
    return [name for name in (LEFT, RIGHT, *scope) if name in names]


def _why_never(observed: ObservedProperty, condition: str, simulated: int) -> str:
    """Why no run satisfies a property each of whose conditions is true in some run.

    Args:
        condition: the text of its first condition.
        simulated: see `Doubted`.
    """
    pattern = observed.property.pattern if isinstance(observed.property, PatternProperty) else None
    if pattern in (Pattern.UNIVERSALITY, Pattern.ABSENCE):
        value = "false" if pattern is Pattern.UNIVERSALITY else "true"
        return f"`{condition}` is {value} at some time in every {'one' if simulated else 'run'}"
    return "each of its conditions is true in some run, but never as the pattern, its scope and its time require"


def _finding(doubted: Doubted, linked: LinkedProperty, place: Span, why: str, related: Iterable[Related]) -> Finding:
    finding = vacuous_property.finding if doubted.doubt in _NOT_TESTED else never_satisfied.finding
    return finding(place, linked.name, why, related, is_instant=doubted.is_instant, simulated=doubted.simulated)


def _unmet(doubted: Doubted, origin: Location) -> Finding:
    values, expected = doubted.values, doubted.expected
    number = f"{expected.relation} {as_written(expected.number)}" if expected is not None else "of its formula"
    low, high = (f"{value:.6g}" for value in values)
    shown = f"{low} in this system" if low == high else f"from {low} to {high} in this system"
    if doubted.simulated:
        shown = f"satisfied in {round(values.lower * doubted.simulated)} of {doubted.simulated} simulated runs"
    return unmet_expectation.finding(origin.span, doubted.property.name, number, shown, is_instant=doubted.is_instant)


def _read(observed: ObservedProperty, condition: Expr) -> Iterator[str]:
    """The variables of the model that contain the values of a condition."""
    names = _names(condition)
    for port in observed.ports:
        for event in port.events:
            read = [v for v in port.variables if v.id in names and v.initial is not None and v.parameter]
            yield from (f"{event.name}__{variable.parameter}" for variable in read)
            yield from (flag_of(event.name) for _ in read[:1])


def _names(part: Expr) -> set[str]:
    return {node.name for node in walk(part) if isinstance(node, Name)}


# ----------------------------------------------------------------- reached values


def _listed(values: set[float]) -> str:
    ordered = sorted(values)
    if len(ordered) > MAX_VALUES:
        return f"from {ordered[0]:g} to {ordered[-1]:g}"
    texts = [f"{value:g}" for value in ordered]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} or {texts[-1]}"
