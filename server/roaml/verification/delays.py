# SPDX-License-Identifier: Apache-2.0
"""Which element a scheduler delays in a trace, although it could take a step."""

from __future__ import annotations

from collections import Counter

from roaml.explicit.path import EndlessTrace
from roaml.jani.model import Clock
from roaml.jani.reaction import owner_of
from roaml.record import Record
from roaml.smc.goal import CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE
from roaml.verification.results import ShortestTrace


class DelayedActor(Record, frozen=True):
    """An automaton that did not take a step of its own although one was possible.

    Attributes:
        actor: a noun phrase for the automaton.
        since, until: the numbers of steps with which the clock has advanced the time before and after the delay;
            `until` is `None` if it lasts until the end of the model's time.
    """

    actor: str
    since: int
    until: int | None


def longest_delay(trace: ShortestTrace, clock: Clock) -> DelayedActor | None:
    """The longest delay in a trace; of equally long ones, the first. `None` if nothing is delayed."""
    checker = trace.checker
    owners, begins = _deciders(checker, clock)
    instance, ends = _ends_of_time(checker, clock)
    compiled = checker.compiled(trace.compiled_property)
    kernel = Kernel(compiled.program, compiled.goal)
    kernel.root(trace.path.root)
    now, since, is_over = 0, dict[int, int](), False
    delays: list[tuple[int, int, int, bool]] = []

    def end(owner: int) -> None:
        start = since.pop(owner)
        if now > start:
            delays.append((now - start, start, owner, is_over))

    for step in trace.path.steps:
        able = {owners[vector] for vector, _, _ in kernel.choices() if vector in owners}
        for owner in [owner for owner in since if owner not in able]:
            end(owner)
        for owner in able:
            since.setdefault(owner, now)
        if owners.get(step.vector) in since:
            end(owners[step.vector])
        kernel.go(step.vector, list(step.edges), list(step.ways))
        if step.vector in begins:
            # The last step of the clock only ends the time, so no time passes in it.
            is_over = kernel.location(instance) in ends
            now += not is_over
    for owner in list(since):
        end(owner)
    if not delays:
        return None
    length, start, owner, lasts = max(delays, key=lambda delay: (delay[0], -delay[1]))
    return DelayedActor(checker.actors[owner], start, None if lasts else start + length)


def endless_delay(
    checker: ModelChecker, property_: CompiledProperty, endless: EndlessTrace, clock: Clock | None
) -> str:
    """The element that could take a step in an endless trace again and again but never does, in a clause for users; ""
    if there is none. If there are several, it is the one that could most often, and of these the first.

    Args:
        checker, property_: those whose states contain the trace (`exhaustive.alone`).
    """
    owners, _ = _deciders(checker, clock)
    compiled = checker.compiled(property_)
    kernel = Kernel(compiled.program, compiled.goal)
    kernel.root(endless.path.root)
    for step in endless.path.steps:
        kernel.go(step.vector, list(step.edges), list(step.ways))
    able = Counter[int]()
    for step in endless.cycle:
        able.update({owners[vector] for vector, _, _ in kernel.choices() if vector in owners})
        kernel.go(step.vector, list(step.edges), list(step.ways))
    repeating = sorted({owners[step.vector] for step in endless.cycle if step.vector in owners})
    waiting = sorted(able.keys() - set(repeating), key=lambda owner: (-able[owner], owner))
    if not waiting or not repeating:
        return ""
    # Machines and trees are names of the user, and the others are phrases.
    named = [checker.actors[owner] for owner in repeating if checker.actors[owner].startswith("`")]
    names = named or [checker.actors[owner] for owner in repeating]
    who = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
    count = len(endless.cycle)
    what = f"{'repeats' if len(names) == 1 else 'repeat'} {'a step' if count == 1 else f'{count:,} steps'}"
    verb = "fails" if endless.path.verdict == FALSE else "holds"
    return f"it {verb}, for example, if {checker.actors[waiting[0]]} is delayed for ever while {who} {what}"


def _ends_of_time(checker: ModelChecker, clock: Clock) -> tuple[int, frozenset[int]]:
    """The number of the clock's element, and the numbers of its locations that it never leaves."""
    names = [element.automaton for element in checker.model.system.elements]
    instance = names.index(clock.automaton)
    sources = {edge.source for edge in checker.legend.layout.instances[instance].automaton.edges}
    locations = enumerate(checker.legend.locations)
    return instance, frozenset(n for n, (owner, name) in locations if owner == instance and name not in sources)


def _deciders(checker: ModelChecker, clock: Clock | None) -> tuple[dict[int, int], set[int]]:
    """The number of the element that decides to take each synchronisation vector, without those of the clock; and the
    vectors with which the clock begins a step."""
    names = [element.automaton for element in checker.model.system.elements]
    owners: dict[int, int] = {}
    begins: set[int] = set()
    clock_name, starts = ("", ()) if clock is None else (clock.automaton, clock.actions)
    for vector, (slots, result) in enumerate(checker.legend.vectors):
        actions = {checker.legend.slots[slot].instance: checker.legend.slots[slot].action for slot in slots}
        owner = owner_of(result or "", {i: names[i] for i in sorted(actions)}, clock_name)
        if owner is not None:
            owners[vector] = owner
        if any(names[i] == clock_name and action in starts for i, action in actions.items()):
            begins.add(vector)
    return owners, begins
