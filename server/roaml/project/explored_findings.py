# SPDX-License-Identifier: Apache-2.0
"""What a check finds in the states that a whole system can reach.

A system without errors is translated and explored (`roaml.project.exploration`). If it has too many states, runs of it
are simulated instead (`roaml.project.simulation`). Nothing is reported about a system whose translation is too large.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, TypeAlias

from roaml.comparison import Comparison
from roaml.diagnostics import Finding, Related
from roaml.model.expand import Instance
from roaml.model.size import Size
from roaml.model.system import System
from roaml.project.analysis import Analysis
from roaml.project.exploration import Reached, ReachedFaultError, explored
from roaml.record import replace
from roaml.rules.answers import (
    answer_needs_time,
    outstanding_response,
    unanswered_goal,
    unanswered_request,
    unanswered_tick,
)
from roaml.rules.expressions import division_by_zero, index_out_of_bounds
from roaml.rules.properties import model_fault, never_satisfied, unmet_expectation, vacuous_property
from roaml.rules.states import never_taken
from roaml.rules.trees import never_in_time, never_ticked
from roaml.text import Location, SourceFile, Span

if TYPE_CHECKING:
    from roaml.project.blame import Blame
    from roaml.project.optional_branches import ByNumber

CODES = frozenset(
    rule.RULE.code
    for rule in (never_in_time, never_satisfied, never_taken, never_ticked, unmet_expectation, vacuous_property)
)
"""The codes of the rules that need an exploration."""
FAULT_CODES = frozenset((division_by_zero.RULE.code, index_out_of_bounds.RULE.code, model_fault.RULE.code))
"""The codes of the rules that report more if there is an exploration."""
STALLS = frozenset(
    rule.RULE.code
    for rule in (answer_needs_time, outstanding_response, unanswered_goal, unanswered_request, unanswered_tick)
)
"""The codes of the rules about what a system may wait for for ever. They explain what no run does afterwards."""
MAX_PARTS = 20_000
"""The maximum number of parts of a translation that is explored (`roaml.model.size.Size.parts`)."""
MORE_TIME = 5
"""How many times longer runs last in which variables that count may reach what a condition compares them with."""


def findings_of(
    analysis: Analysis, path: str, expected: Mapping[str, Comparison]
) -> Mapping[str, tuple[Finding, ...]] | None:
    """Path of a file -> the findings in it, for a system without errors; `None` if the system is too large to be
    explored and simulated.

    Args:
        expected: name of a property -> the result that the settings of the user expect.
    """
    expanded = analysis.expanded(path)
    plain = analysis if expanded is None else expanded.analysis
    system, size = plain.system(path), plain.size_of_translation(path)
    if system is None or size is None:
        return {}
    if _parts(size) > MAX_PARTS:
        return None
    known = _known(plain, path, system, expected)
    if known is None:
        return None
    found: dict[str, list[Finding]] = {}
    for place, finding in _merged(known):
        if expanded is None:
            found.setdefault(place, []).append(finding)
        else:
            source = expanded.location(Location(place, finding.span)).path
            found.setdefault(source, []).append(expanded.finding(place, finding))
    return {place: tuple(dict.fromkeys(findings)) for place, findings in found.items()}


def _known(
    analysis: Analysis, path: str, system: System, expected: Mapping[str, Comparison]
) -> list[tuple[str, Finding]] | None:
    """The paths of files, and the findings in them; `None` if the system can neither be explored nor be simulated."""
    from roaml.project.blame import Blame  # noqa: PLC0415 - these modules are imported only if a system is explored
    from roaml.project.explored_properties import findings_about_properties  # noqa: PLC0415
    from roaml.project.unticked import is_missed  # noqa: PLC0415

    known: list[tuple[str, Finding]] | None = None
    blame: Blame | None = None
    late: list[tuple[str, Finding]] = []
    nodes = {instance.number: instance for instance in system.instances}
    missed = functools.cache(functools.partial(is_missed, analysis, path, nodes))
    simulated = functools.partial(_in_simulations, analysis, path, system, nodes, missed)
    try:
        for reached in explored(analysis, path):
            blame = Blame(analysis, system, reached)
            known = list(_all(analysis, system, nodes, reached, missed, blame))
            is_settled = not known and not blame.has_unexplained
            late = [] if is_settled else _late(analysis, path, nodes, reached)
            if is_settled:
                break
    except ReachedFaultError as fault:
        from roaml.project.explored_faults import finding_about_fault, searched_run  # noqa: PLC0415 - few systems have one

        return [*(known or ()), *finding_about_fault(analysis, path, system, searched_run(fault.space))]
    if known is None or blame is None:
        return _with_simulated_properties(analysis, path, expected, simulated())
    if late:
        known = late
    elif blame.has_unexplained and not blame.is_tree_at_fault:
        longer = simulated(more_time=MORE_TIME) or ()
        known += [(place, finding) for place, finding in longer if finding.code == never_taken.RULE.code]
    return [*known, *findings_about_properties(analysis, path, expected)]


def _in_simulations(
    analysis: Analysis,
    path: str,
    system: System,
    nodes: ByNumber,
    missed: Callable[[Instance], bool],
    *,
    more_time: int = 1,
) -> list[tuple[str, Finding]] | None:
    """What is found in a system that has too many states; `None` if it cannot be simulated."""
    from roaml.project.blame import Blame  # noqa: PLC0415
    from roaml.project.simulation import SimulatedFaultError, simulated  # noqa: PLC0415 - only large systems

    known: list[tuple[str, Finding]] | None = None
    try:
        for reached in simulated(analysis, path, more_time):
            known = list(_all(analysis, system, nodes, reached, missed, Blame(analysis, system, reached)))
            if not known:
                break
    except SimulatedFaultError as fault:
        if more_time > 1:
            return None  # the system ends before this run does
        from roaml.project.explored_faults import finding_about_fault, simulated_run  # noqa: PLC0415

        return list(finding_about_fault(analysis, path, system, simulated_run(fault.checker, fault.problem)))
    return _late(analysis, path, nodes, reached) or known if known else known


def _with_simulated_properties(
    analysis: Analysis, path: str, expected: Mapping[str, Comparison], known: list[tuple[str, Finding]] | None
) -> list[tuple[str, Finding]] | None:
    """What is found in a system that has too many states, with what is found about its properties.

    Args:
        known: the other findings; `None` if the system cannot be simulated.
    """
    if known is None or any(finding.code in FAULT_CODES for _, finding in known):
        return known
    from roaml.project.simulated_properties import (  # noqa: PLC0415 - only large systems
        findings_about_simulated_properties,
    )

    return [*known, *findings_about_simulated_properties(analysis, path, expected)]


def _late(analysis: Analysis, path: str, nodes: ByNumber, reached: Reached) -> list[tuple[str, Finding]]:
    from roaml.project.late_children import late_children  # noqa: PLC0415 - few systems have something to be explained

    return list(late_children(analysis, path, nodes, reached))


def unobserved(
    analysis: Analysis, path: str, findings: Iterable[tuple[str, Finding]]
) -> Mapping[str, tuple[Finding, ...]]:
    """Path of a file -> what replaces the findings in it about waits that depend on the order of requests, if simulated
    runs of the system never stand still.

    Args:
        findings: the paths of files, and the findings of the rules in them.
    """
    waits = [
        (file, finding) for file, finding in findings if isinstance(finding.facts, answer_needs_time.DependsOnOrder)
    ]
    if not waits:
        return {}
    from roaml.project.simulation import runs_without_standstill  # noqa: PLC0415 - few systems have such findings

    expanded = analysis.expanded(path)
    runs = runs_without_standstill(analysis if expanded is None else expanded.analysis, path)
    replaced: dict[str, tuple[Finding, ...]] = {}
    for file, finding in waits if runs else ():
        replaced[file] = (*replaced.get(file, ()), answer_needs_time.unobserved(finding, runs))
    return replaced


def without_consequences(
    found: Mapping[str, tuple[Finding, ...]], others: Collection[str]
) -> Mapping[str, tuple[Finding, ...]]:
    """The findings without conditions that may never hold because of another finding.

    Args:
        found: path of a file -> the findings in it.
        others: the codes of the warnings about the system that need no exploration.
    """
    if STALLS.isdisjoint(others):
        return found
    return {path: tuple(f for f in own if f.code != never_taken.RULE.code) for path, own in found.items()}


Content: TypeAlias = "tuple[tuple[SourceFile | None, ...], object]"
"""The texts on which the findings of a system depend, and the data files."""


def content_of(analysis: Analysis, path: str) -> Content:
    """What the findings of a system depend on, as a value that is compared."""
    expanded = analysis.expanded(path)
    data = () if expanded is None else expanded.expansion.data
    files = dict.fromkeys((*analysis.files_of(path), *analysis.interface_files_of(path)))
    return tuple(map(analysis.source, files)), data


def still_true(
    findings: Iterable[Finding], path: str, content: Content, now: Callable[[str], SourceFile | None]
) -> tuple[Finding, ...]:
    """The findings in a file that an exploration has found before other files of the system were changed; none if the
    file was changed itself.

    Args:
        content: the content at the exploration.
        now: path of a file -> its text now.
    """
    unchanged = {source.path for source in content[0] if source is not None and source == now(source.path)}
    if path not in unchanged:
        return ()
    return tuple(
        replace(finding, related=tuple(r for r in finding.related if _is_in(r, unchanged))) for finding in findings
    )


def _is_in(related: Related, paths: Collection[str]) -> bool:
    return not isinstance(related.place, Location) or related.place.path in paths


def _parts(size: Size) -> int:
    return sum(share.count for share in size.parts)


def _all(
    analysis: Analysis,
    system: System,
    nodes: ByNumber,
    reached: Reached,
    missed: Callable[[Instance], bool],
    blame: Blame,
) -> Iterator[tuple[str, Finding]]:
    """The paths of files, and the findings in them."""
    from roaml.project.unticked import never_ticked_nodes  # noqa: PLC0415

    yield from never_ticked_nodes(analysis, system, nodes, reached, missed, blame)
    yield from blame.for_leaves([number for number, is_ticked in reached.ticks.items() if is_ticked])
    yield from blame.for_clients()


def _merged(found: Iterable[tuple[str, Finding]]) -> Iterator[tuple[str, Finding]]:
    """Findings in files; those that differ only in their related places become one."""
    known: dict[tuple[str, str, Span, str], Finding] = {}
    for path, finding in found:
        key = (path, finding.code, finding.span, finding.message)
        related = known[key].related if key in known else ()
        known[key] = replace(finding, related=tuple(dict.fromkeys((*related, *finding.related))))
    return ((key[0], finding) for key, finding in known.items())
