# SPDX-License-Identifier: Apache-2.0
"""The minimum and the maximum of a property if machines react at once, for properties on which schedulers disagree
(docs/spec/semantics.md#reaction-time)."""

from __future__ import annotations

from collections.abc import Callable

from roaml.durations import AT_ONCE
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, StateLimits, explore
from roaml.jani.model import Clock
from roaml.jani.reaction import owner_of, reacting
from roaml.record import Record, replace
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE
from roaml.verification.exhaustive import UndecidedError, alone, values_from
from roaml.verification.results import Computed, Estimated, Exact, Outcome, ShortestTrace, UnderAssumption
from roaml.verification.small import Budget, setup_cost
from roaml.verification.target import VerificationTarget

ASSUMPTION = "if machines react at once"
LIMITS = StateLimits(states=300_000, bytes=1 << 30, transitions=3_000_000, work=300_000_000)
"""The limits of the searches of all properties of one verification together, which nobody has requested."""


def at_once(
    target: VerificationTarget,
    property_: CompiledProperty,
    outcome: Outcome,
    checker_of: Callable[[VerificationTarget], ModelChecker],
    budget: Budget,
) -> UnderAssumption | None:
    """The values of a property if machines react at once; `None` if the result does not leave them open, if the model
    assumes a reaction time, or if they cannot be computed within the budget, which has the limits `LIMITS`.

    Args:
        outcome: the result without the assumption.
        checker_of: compiles the properties for a target.
    """
    metadata, question = target.model.metadata, property_.question
    if metadata is None or metadata.clock is None or not metadata.reaction_time.is_any or not _is_open(outcome):
        return None
    if question.is_reward or question.is_stuck or question.is_conditional:
        return None
    try:
        checker = checker_of(replace(target, model=reacting(target.model, AT_ONCE)))
        subject = next((p for p in checker.compiled_properties if p.question.name == question.name), None)
        exact = None if subject is None else _values(checker, subject, budget)
    except (FaultError, UndecidedError, LimitError):
        return None
    if exact is None or not exact.is_precise:
        return None
    return UnderAssumption(ASSUMPTION, Computed(question, exact), _remark(outcome, exact, metadata.clock))


def _is_open(outcome: Outcome) -> bool:
    """Whether schedulers have different values, or it is not known whether they have."""
    match outcome:
        case Computed(exact=exact):
            return not exact.agrees
        case Estimated(choices=choices, is_interrupted=False):
            return choices is not None and not choices.agreement
        case _:
            return False


def _values(checker: ModelChecker, property_: CompiledProperty, budget: Budget) -> Exact | None:
    setup = setup_cost(checker)
    limits = budget.share(len(checker.compiled_properties), setup)
    if limits is None:
        return None
    alone_checker, subject = alone(checker, property_)
    is_reduced = can_be_reduced(alone_checker.program, subject.goal)
    transitions = limits.transitions or 0
    try:
        space = explore(alone_checker, subject, limits, is_reduced=is_reduced)
        transitions = space.search.transitions + space.search.passed
        return values_from(space, limits)
    finally:
        budget.spend(setup + transitions)


def _remark(outcome: Outcome, exact: Exact, clock: Clock) -> str:
    """The longest delay in an example trace that the assumption may exclude; "" if there is none."""
    if not isinstance(outcome, Computed):
        return ""
    verdict = FALSE if outcome.exact.least < exact.least else TRUE
    trace = outcome.exact.shortest(verdict)
    delay = None if trace is None else longest_delay(trace, clock)
    if delay is None:
        return ""
    seconds = clock.step / 1e9
    end = "the end" if delay.until is None else f"{delay.until * seconds:g} s"
    what = "fails" if verdict == FALSE else "holds"
    return f"it {what}, for example, if {delay.actor} is delayed from {delay.since * seconds:g} s until {end}"


class DelayedActor(Record, frozen=True):
    """An automaton that did not take a step of its own although one was possible.

    Attributes:
        actor: a noun phrase for the automaton.
        since, until: the numbers of steps of the clock before and after the delay; `until` is `None` if it lasts until
            the end of the trace.
    """

    actor: str
    since: int
    until: int | None


def longest_delay(trace: ShortestTrace, clock: Clock) -> DelayedActor | None:
    """The longest delay in a trace; of equally long ones, the first. `None` if nothing is delayed."""
    checker = trace.checker
    owners, begins = _owners(checker, clock)
    compiled = checker.compiled(trace.compiled_property)
    kernel = Kernel(compiled.program, compiled.goal)
    kernel.root(trace.path.root)
    now, since = 0, dict[int, int]()
    delays: list[tuple[int, int, int, bool]] = []

    def end(owner: int, *, is_last: bool = False) -> None:
        start = since.pop(owner)
        if now > start:
            delays.append((now - start, start, owner, is_last))

    for step in trace.path.steps:
        able = {owners[vector] for vector, _, _ in kernel.choices() if vector in owners}
        for owner in [owner for owner in since if owner not in able]:
            end(owner)
        for owner in able:
            since.setdefault(owner, now)
        now += step.vector in begins
        if owners.get(step.vector) in since:
            end(owners[step.vector])
        kernel.go(step.vector, list(step.edges), list(step.ways))
    for owner in list(since):
        end(owner, is_last=True)
    if not delays:
        return None
    length, start, owner, is_last = max(delays, key=lambda delay: (delay[0], -delay[1]))
    return DelayedActor(checker.actors[owner], start, None if is_last else start + length)


def _owners(checker: ModelChecker, clock: Clock) -> tuple[dict[int, int], set[int]]:
    """The element that decides to take each vector, without those of the clock; and the vectors with which the clock
    begins a step."""
    names = [element.automaton for element in checker.model.system.elements]
    owners: dict[int, int] = {}
    begins: set[int] = set()
    for vector, (slots, result) in enumerate(checker.legend.vectors):
        actions = {checker.legend.slots[slot].instance: checker.legend.slots[slot].action for slot in slots}
        owner = owner_of(result or "", {i: names[i] for i in sorted(actions)}, clock.automaton)
        if owner is not None:
            owners[vector] = owner
        if any(names[i] == clock.automaton and action in clock.actions for i, action in actions.items()):
            begins.add(vector)
    return owners, begins
