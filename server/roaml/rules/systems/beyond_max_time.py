# SPDX-License-Identifier: Apache-2.0
"""The rule `beyond-max-time`, which beyond_max_time.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.durations import DEFAULT_MAX_TIME
from roaml.model.node_effects import tree_effects
from roaml.model.property_links import LinkedFile
from roaml.model.property_problems import ProblemKind
from roaml.model.system import System
from roaml.model.timing import period, periods, rates
from roaml.model.tree import TreeNode
from roaml.rules.rule import MachineContext, Rule, SystemContext, TreeContext
from roaml.rules.support.property_problems import problems
from roaml.rules.support.settings import place_of
from roaml.rules.support.timing import (
    counted_waits,
    duration,
    durations,
    ending_counts,
    port_durations,
    running_first,
    timers,
    tree_rates,
)
from roaml.text import Span

SHORT_RUN = 10**10
"""The `max_time`, in ns, from which on it is probably right if timers do not tick before it: 10 s."""


def _machine(context: MachineContext) -> Iterator[Finding]:
    end = context.system.parameters.max_time if context.system else None
    if context.system is None or end is None or not context.automata:
        return
    if not _is_end_usual(end) and _little_ticks(context.system, end):
        return  # reported at `max_time`
    for _, rate, hertz in timers(context):
        ns = period(hertz).nanoseconds
        if ns > end:
            message = (
                f"this timer never ticks: its period is {duration(ns)}, and the system runs for {duration(end)} "
                "(`max_time`)"
            )
            yield RULE.at(rate.span, message)
    for wait, hertz, ns in counted_waits(context):
        if end < ns and period(hertz).nanoseconds <= end:
            message = (
                f"this never holds: `{wait.variable}` counts ticks of `{wait.timer}`, which take {duration(ns)}, and "
                f"the system runs for {duration(end)} (`max_time`)"
            )
            yield RULE.at(wait.span, message)
    for wait, hertz, ns in ending_counts(context):
        if end < ns and period(hertz).nanoseconds <= end:
            message = (
                f"this always holds: `{wait.variable}` counts ticks of `{wait.timer}`, which take {duration(ns)} until "
                f"the limit, and the system runs for {duration(end)} (`max_time`)"
            )
            yield RULE.at(wait.span, message)


def _tree(context: TreeContext) -> Iterator[Finding]:
    yield from _mocked(context)
    end = context.system.parameters.max_time if context.system else None
    for node, port, ns in durations(context) if end is not None else ():
        if end is not None and ns > end:
            effect = "it never ends the child" if port == "msec" and node.children else "it never ends"
            message = f"{duration(ns)} is longer than the system runs, {duration(end)} (`max_time`), so {effect}"
            yield RULE.at(place_of(node, port), message)
    reported: set[tuple[TreeNode, str]] = set()
    for node, _, port, hertz, ns in port_durations(context) if end is not None else ():
        if end is not None and ns > end >= period(hertz).nanoseconds and (node, port) not in reported:
            reported.add((node, port))
            message = (
                f"with this value the node counts ticks of a timer for {duration(ns)}, which is longer than the system "
                f"runs, {duration(end)} (`max_time`), so it never succeeds"
            )
            yield RULE.at(place_of(node, port), message)


def _mocked(context: TreeContext) -> Iterator[Finding]:
    """Report the leaves of a tree without a system that cannot end before the end of the time, because of their mocks.
    Those below a `Timeout` that is shorter are reported by short-time."""
    forest = context.forest
    for _, node in forest.own_nodes if forest is not None and context.mocked else ():
        least = context.mocked.get(node, 0)
        if least > DEFAULT_MAX_TIME:
            message = (
                f"with its mock, `{node.type_name}` takes {duration(least)}, and the tree runs for "
                f"{duration(DEFAULT_MAX_TIME)}, so it never succeeds; check the unit in the file of mocks, or "
                "verify with `--max-time`"
            )
            yield RULE.at(node.element.name_span, message)


def _system(context: SystemContext) -> Iterator[Finding]:
    end = context.file.parameters.max_time
    if end is None:
        return
    shown = context.file.parameter("max_time")
    unit = min((p.unit for p in periods(context.system)), default=1)
    if shown is not None and not _is_end_usual(end) and _little_ticks(context.system, end):
        if end % unit:
            return  # inexact-max-time reports it
        times = [timer.period.nanoseconds for timer in rates(context.system)]
        late = sorted(time for time in times if time > end)
        value = shown.get("value")
        message = (
            f"{_count(len(late), len(times))}: the system runs for {duration(end)}, and the shortest of their periods "
            f"is {duration(late[0])}"
        )
        yield RULE.at(value.value_span if value is not None else shown.name_span, message)
        return
    for place, hertz, _ in tree_rates(context):
        ns = period(hertz).nanoseconds
        if ns > end:
            message = (
                f"the tree is never ticked: the time between two ticks is {duration(ns)}, and the system runs for "
                f"{duration(end)} (`max_time`)"
            )
            yield RULE.at(place, message)
    if shown is not None:
        value = shown.get("value")
        yield from _too_many_ticks(context.system, end, value.value_span if value is not None else shown.name_span)


def _too_many_ticks(system: System, end: int, place: Span) -> Iterator[Finding]:
    """Report a tree that needs more ticks to succeed than it gets, because its actions are RUNNING at their first
    tick."""
    waits = running_first(system)
    if not waits or max(waits.values()) > end:
        return  # the tree is never ticked twice, which is reported at the rate
    effects = tree_effects(system)
    for root in system.roots:
        automaton = system.by_instance.get(root.number)
        least = effects.time_to_success(system, automaton, waits) if automaton is not None else 0
        if least > end:
            message = (
                f"the tree never succeeds: its nodes that are RUNNING at their first tick need {duration(least)} at "
                f"least, and the system runs for {duration(end)}"
            )
            yield RULE.at(place, message)
            return


def _properties(file: LinkedFile) -> Iterator[Finding]:
    return problems(RULE, ProblemKind.BEYOND_END, file)


def _is_end_usual(end: int) -> bool:
    """Whether `max_time`, in ns, is so long that the periods of timers are probably wrong if nothing ticks."""
    return end >= SHORT_RUN


MIN_LATE = 3
"""How many timers never tick at least before `max_time` is probably wrong, instead of their periods."""


def _little_ticks(system: System, end: int) -> bool:
    """Whether the system has timers and none of them ticks, or several, and at least half of them, do not."""
    times = [timer.period.nanoseconds for timer in rates(system)]
    late = sum(time > end for time in times)
    return bool(times) and (late == len(times) or (late >= MIN_LATE and 2 * late >= len(times)))


def _count(late: int, all_: int) -> str:
    return "no timer ticks" if late == all_ else f"{late} of {all_} timers never tick"


RULE = Rule(
    "beyond-max-time",
    Severity.WARNING,
    "A time is longer than the system runs.",
    machine=_machine,
    tree=_tree,
    system=_system,
    xml_properties=_properties,
    whole=True,
)
