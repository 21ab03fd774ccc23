# SPDX-License-Identifier: Apache-2.0
"""Translates a whole system to a network of plain automata, in processing order
(docs/spec/systems.md#processing-order)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.durations import ANY_TIME
from roaml.lower.actions import action_handler
from roaml.lower.blackboard import blackboard
from roaml.lower.machine import TimerEvents, lower_machine
from roaml.lower.nodes import builtin_machine
from roaml.lower.program import TranslatableSystem
from roaml.lower.services import service_handler
from roaml.lower.timers import clock, clock_step, timers_of
from roaml.lower.tree import tick_timer, tree_root
from roaml.model.globals import tree_flags
from roaml.model.machine import Machine
from roaml.model.system import SystemAutomaton
from roaml.scxml.model import Automaton as PlainAutomaton
from roaml.scxml.model import Network


def lower(program: TranslatableSystem) -> Network:
    """The plain automata of a system without errors."""
    members = [
        (automaton, _machine(automaton, program))
        for automaton in program.system.automata
        if not program.system.is_program(automaton)
    ]
    timers = timers_of(program, members)
    events = {(timer.user, timer.handle): timer.event for timer in timers if timer.event is not None}
    automata = list(_automata(program, members, events))
    if timers:
        automata.append(clock(timers, program.parameters.max_time or 0, program.place))
    parameters = program.parameters
    return Network(
        tuple(automata),
        parameters.max_array_size,
        parameters.random_values,
        clock_step(timers),
        parameters.reaction_time or ANY_TIME,
        tree_flags(program.system),
    )


def _machine(automaton: SystemAutomaton, program: TranslatableSystem) -> Machine:
    if automaton.path:
        return program.machines[automaton.path]
    return builtin_machine(automaton)


def _automata(
    program: TranslatableSystem, members: Iterable[tuple[SystemAutomaton, Machine]], timers: TimerEvents
) -> Iterator[PlainAutomaton]:
    system = program.system
    for automaton, machine in members:
        if automaton.instance is None:
            yield from lower_machine(automaton, machine, program, timers)
    machines = {automaton.instance.number: (automaton, machine) for automaton, machine in members if automaton.instance}
    for instance in system.instances:
        if instance.parent is None:
            yield tree_root(program, instance, timers[tick_timer(program, instance)])
        if program.library is not None:
            yield from program.library.automata(instance.number)
        if instance.number in machines:
            yield from lower_machine(*machines[instance.number], program, timers)
    for root in system.roots:
        if (board := blackboard(program, root)) is not None:
            yield board
    for service in system.services.values():
        yield service_handler(service, program)
    for action in system.actions.values():
        yield action_handler(action, program)
