# SPDX-License-Identifier: Apache-2.0
"""Which element a scheduler delays in a trace, although it could take a step."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Collection, Mapping, Sequence

from roaml.explicit.path import EndlessTrace, PathStep
from roaml.jani.model import Clock
from roaml.jani.reaction import owner_of
from roaml.record import Record
from roaml.smc.goal import CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, UNKNOWN
from roaml.verification.results import ShortestTrace

MAX_REPLAYED = 10
"""The maximum length of a trace that is repeated with one delay only, in lengths of the trace."""


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
    """The longest delay in a trace with which alone the property has the verdict of the trace, as far as one trace for
    each delay shows; otherwise the longest one. Of equally long ones, it is the first. `None` if nothing is delayed."""
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
    delays.sort(key=lambda delay: (-delay[0], delay[1]))
    longest: dict[int, tuple[int, int, int, bool]] = {}
    for delay in delays:
        longest.setdefault(delay[2], delay)
    candidates = list(longest.values())
    if len(candidates) > 1:
        replay = _Replay(trace, kernel, owners, begins)
        if not replay.has_verdict(None, 0, 0):
            sufficient = (c for c in candidates if replay.has_verdict(c[2], c[1], c[1] + c[0]))
            candidates = [next(sufficient, candidates[0])]
    length, start, owner, lasts = candidates[0]
    return DelayedActor(checker.actors[owner], start, None if lasts else start + length)


class _Replay:
    """Repeats a trace in which no element but one is delayed. As far as possible, chance has the outcomes of the
    trace."""

    def __init__(
        self, trace: ShortestTrace, kernel: Kernel, owners: Mapping[int, int], begins: Collection[int]
    ) -> None:
        self.path = trace.path
        self.kernel = kernel
        self.owners = owners
        self.begins = begins

    def has_verdict(self, delayed: int | None, start: int, end: int) -> bool:
        """Whether the property has the verdict of the trace if the element `delayed` takes no step of its own from
        `start` until `end`, in steps of the clock, unless no other step is possible, and the others take theirs at
        once."""
        kernel, now = self.kernel, 0
        outcomes: dict[int, deque[PathStep]] = {}
        for step in self.path.steps:
            outcomes.setdefault(step.vector, deque()).append(step)
        kernel.root(self.path.root)
        for _ in range(MAX_REPLAYED * len(self.path.steps)):
            status = kernel.look()
            if status == UNKNOWN and kernel.ended():
                status = kernel.close()
            if status != UNKNOWN:
                return status == self.path.verdict
            choices = {vector: slots for vector, _, slots in kernel.choices()}
            is_held = start <= now < end
            held = {v for v in choices if is_held and self.owners.get(v) == delayed}
            _, _, _, vector = min((v in held, v in self.begins, v not in outcomes, v) for v in choices)
            given = outcomes[vector].popleft() if outcomes.get(vector) else None
            slots = choices[vector]
            if given is None or not _is_possible(given, slots):
                given = PathStep(vector, [0] * len(slots), [_first_way(edges[0]) for edges in slots])
            kernel.go(vector, list(given.edges), list(given.ways))
            now += vector in self.begins
        return False


def _is_possible(step: PathStep, slots: Sequence[Sequence[Sequence[float]]]) -> bool:
    parts = zip(step.edges, step.ways, slots, strict=True)
    return all(e < len(edges) and w < len(edges[e]) and edges[e][w] > 0 for e, w, edges in parts)


def _first_way(chances: Sequence[float]) -> int:
    return next(number for number, chance in enumerate(chances) if chance > 0)


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
    verb = "does not hold" if endless.path.verdict == FALSE else "holds"
    return f"the property {verb}, for example, if {checker.actors[waiting[0]]} is delayed for ever while {who} {what}"


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
