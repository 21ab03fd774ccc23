# SPDX-License-Identifier: Apache-2.0
"""What a check finds in the states that a whole system can reach.

A system without errors is translated and explored within limits, which are numbers of parts, states and steps, and not
times, so the findings do not depend on the speed of the machine. Nothing is reported about a system that is too large.
The search leaves out the order of independent steps: each step of a machine that is possible in the system also occurs
in the reduced search (docs/spec/reductions.md).

Machines that react at once reach a part of the states, so what never happens with the reaction time `any` never happens
then either. This smaller search comes first, and ends most checks: without a finding, or because it reaches a limit.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, TypeAlias

from roaml.diagnostics import Finding, Related
from roaml.interruption import checkpoint
from roaml.jani.expressions import Integer
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
from roaml.model.expand import Instance, NodeSource, node_at
from roaml.model.node_effects import statuses
from roaml.model.size import Size
from roaml.model.system import System
from roaml.model.tree import TreeNode
from roaml.project.analysis import Analysis
from roaml.project.optional_branches import ByNumber, ends_only_in_failure, is_required, reactive
from roaml.project.translation import network_of
from roaml.record import Record, replace
from roaml.rules.states import never_taken
from roaml.rules.trees import never_ticked
from roaml.scxml.names import STATUS_NAMES, TreeEventKind, read_tree_event, received_by
from roaml.text import Location, SourceFile, Span

if TYPE_CHECKING:
    from roaml.jani.model import Model
    from roaml.project.blame import Blame
    from roaml.project.explored_steps import ClientRequests, ExploredSteps, ExploredWay
    from roaml.smc.model import ModelChecker

CODES = frozenset((never_taken.RULE.code, never_ticked.RULE.code))
"""The codes of the rules that need an exploration."""
MAX_PARTS = 10_000
"""The maximum number of parts of a translation that is explored (`roaml.model.size.Size.parts`)."""
MAX_STATES, MAX_STEPS, MAX_BYTES = 10_000, 300_000, 1 << 28
"""The limits of one exploration. A typical one that reaches them takes 0.2 s."""


class Reached(Record, frozen=True):
    """What the steps in all reachable states are.

    Attributes:
        events: the events that an automaton can receive -> whether it receives them in some state.
        statuses: number of a node of the tree -> the statuses that it returns in some state.
        is_instant: whether this is only known if machines react at once.
        model: the model that was explored.
        steps: the steps of all automata.
    """

    events: Mapping[str, bool]
    statuses: Mapping[int, frozenset[str]]
    is_instant: bool
    model: Model
    steps: Callable[[], ExploredSteps]

    @property
    def ticks(self) -> Mapping[int, bool]:
        """The numbers of the nodes of the tree -> whether they are ticked."""
        ticks: dict[int, bool] = {}
        for event, is_received in self.events.items():
            tree = read_tree_event(event)
            if tree is not None and tree.kind is TreeEventKind.TICK:
                ticks[tree.number] = ticks.get(tree.number, False) or is_received
        return ticks


def findings_of(analysis: Analysis, path: str) -> Mapping[str, tuple[Finding, ...]] | None:
    """Path of a file -> the findings in it, for a system without errors; `None` if the system is too large to be
    explored."""
    expanded = analysis.expanded(path)
    plain = analysis if expanded is None else expanded.analysis
    system, size = plain.system(path), plain.size_of_translation(path)
    if system is None or size is None or not system.instances:
        return {}
    if _parts(size) > MAX_PARTS:
        return None
    known: list[tuple[str, Finding]] | None = None
    nodes = {instance.number: instance for instance in system.instances}
    missed = functools.cache(functools.partial(_is_missed, plain, path, nodes))
    for reached in _explored(plain, path):
        known = list(_merged(_all(plain, system, nodes, reached, missed)))
        if not known:
            break
    if known is None:
        return None
    found: dict[str, list[Finding]] = {}
    for place, finding in known:
        if expanded is None:
            found.setdefault(place, []).append(finding)
        else:
            source = expanded.location(Location(place, finding.span)).path
            found.setdefault(source, []).append(expanded.finding(place, finding))
    return {place: tuple(dict.fromkeys(findings)) for place, findings in found.items()}


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


def _explored(analysis: Analysis, path: str) -> Iterator[Reached]:
    """What a system reaches: first with machines that react at once, then with its own reaction time. The iterator ends
    before a search that has too many states."""
    from roaml.durations import AT_ONCE  # noqa: PLC0415 - the model checker is imported only if a system is explored
    from roaml.jani.reaction import ReactionError, reacting  # noqa: PLC0415
    from roaml.to_jani import translate  # noqa: PLC0415

    model = translate(network_of(analysis, path), (), ())
    checkpoint()
    metadata = model.metadata
    if metadata is not None and metadata.clock is not None and metadata.reaction_time.is_any:
        try:
            reached = _reached(reacting(model, AT_ONCE), is_instant=True)
        except ReactionError:
            return
        if reached is None:
            return
        yield reached
    reached = _reached(model, is_instant=False)
    if reached is not None:
        yield reached


def _reached(model: Model, *, is_instant: bool) -> Reached | None:
    """What a model reaches; `None` if it cannot be explored."""
    searched = _searched(model)
    if searched is None:
        return None
    events, returned = _events(*searched), _statuses(*searched)
    return Reached(events, returned, is_instant, model, lambda: _steps(model, *searched))


def _steps(model: Model, checker: ModelChecker, taken: bytes) -> ExploredSteps:
    from roaml.project.explored_steps import ExploredSteps  # noqa: PLC0415 - see `_explored`

    return ExploredSteps(model, _ways(checker, taken))


def _while_handled(model: Model, requests: ClientRequests) -> ExploredSteps | None:
    from roaml.project.request_context import steps_while_handled  # noqa: PLC0415 - only some findings need it

    return steps_while_handled(model, requests, _ways_of)


def _ways_of(model: Model) -> list[ExploredWay] | None:
    """The steps of a model; `None` if it cannot be explored."""
    searched = _searched(model)
    return None if searched is None else list(_ways(*searched))


def _searched(model: Model) -> tuple[ModelChecker, bytes] | None:
    """A model checker, and for each way of an edge whether it is taken. `None` if there are too many states, or if an
    undefined operation is executed, behind which no states are known."""
    from roaml.explicit.independence import can_be_reduced  # noqa: PLC0415
    from roaml.explicit.space import LimitError, StateLimits, explore  # noqa: PLC0415
    from roaml.smc.fault import FaultError  # noqa: PLC0415
    from roaml.smc.model import ModelChecker  # noqa: PLC0415
    from roaml.views.ends import marks  # noqa: PLC0415

    limits = StateLimits(states=MAX_STATES, bytes=MAX_BYTES, combinations=4_096, transitions=MAX_STEPS)
    try:
        checker = ModelChecker(model, (), marks(model))
        is_reduced = can_be_reduced(checker.program, checker.stuck.goal)
        space = explore(checker, checker.stuck, limits, lambda _: checkpoint(), is_reduced=is_reduced)
    except (FaultError, LimitError):
        return None
    if space.problem is not None:
        return None
    return checker, bytes(memoryview(space.search.taken))


def _ways(checker: ModelChecker, taken: bytes) -> Iterator[ExploredWay]:
    from roaml.project.explored_steps import ExploredWay  # noqa: PLC0415 - see `_explored`

    legend, automata = checker.legend, checker.automata
    for (edge, destination), (source, _), is_taken in zip(legend.ways, legend.moves, taken, strict=False):
        yield ExploredWay(automata[legend.locations[source][0]], edge, destination, is_taken != 0)


def _events(checker: ModelChecker, taken: bytes) -> Mapping[str, bool]:
    events: dict[str, bool] = {}
    for way, (edge, _) in enumerate(checker.legend.ways):
        event = received_by(edge.action or "")
        if event:
            events[event] = events.get(event, False) or taken[way] != 0
    return events


def _statuses(checker: ModelChecker, taken: bytes) -> Mapping[int, frozenset[str]]:
    """The numbers of the nodes of the tree -> the statuses that they return, as far as they send them as constants."""
    statuses: dict[int, frozenset[str]] = {}
    for way, (_, destination) in enumerate(checker.legend.ways):
        for assignment in destination.assignments if taken[way] else ():
            event, _, parameter = assignment.variable.rpartition("__")
            tree = read_tree_event(event) if parameter == "status" else None
            if tree is not None and isinstance(assignment.value, Integer):
                name = STATUS_NAMES.get(assignment.value.value, "")
                statuses[tree.number] = statuses.get(tree.number, frozenset()) | {name}
    return statuses


def _never_ticked(
    analysis: Analysis,
    system: System,
    by_number: ByNumber,
    reached: Reached,
    missed: Callable[[Instance], bool],
    blame: Blame,
) -> Iterator[tuple[str, Finding]]:
    """The paths of files, and findings about nodes in them that are never ticked although their parents are. A place
    that several instances share is reported if none of them is ticked.

    Args:
        missed: whether a node would be ticked if the nodes around it were reactive.
    """
    ticked = {number for number, is_ticked in reached.ticks.items() if is_ticked}
    known = reached.ticks.keys()
    places = {instance.source for instance in system.instances if instance.number in ticked}
    for instance in system.instances:
        before = _before(instance, by_number)
        if before is None or instance.source in places or before.number not in ticked or instance.number not in known:
            continue
        parent = by_number[before.parent] if before.parent is not None else None
        needed = never_ticked.needed(parent.plugin) if parent is not None else None
        if needed is None or not all(
            _decides(system, leaf, is_condition=needed is never_ticked.FAILS) for leaf in _leaves(before, by_number)
        ):
            continue
        is_missed = not _is_needed(system, by_number, reached, instance, before)
        if is_missed and not missed(instance):
            continue
        is_harmless = is_missed and not _has_failing_action(system, by_number, reached)
        node, earlier = _written(analysis, instance.source), _written(analysis, before.source)
        if node is None or earlier is None:
            continue
        related = [Related(Location(before.source.path, earlier.element.name_span), f"never returns {needed}")]
        effects = [*related, Related(Location(instance.source.path, node.element.name_span), "never ticked")]
        cause = None if is_missed else blame.for_status(before, needed, effects)
        yield cause or (
            instance.source.path,
            never_ticked.finding(
                node,
                earlier,
                needed,
                related,
                is_instant=reached.is_instant,
                is_missed=is_missed,
                is_harmless=is_harmless,
            ),
        )


def _is_needed(system: System, nodes: ByNumber, reached: Reached, instance: Instance, before: Instance) -> bool:
    """Whether the tree cannot succeed because a node is never ticked, or whether the node follows an action that never
    succeeds. Other nodes may be for cases that the environment does not contain."""
    if is_required(instance, nodes) or ends_only_in_failure(nodes, reached.statuses, instance):
        return True
    return any(RUNNING in statuses(system, leaf) for leaf in _leaves(before, nodes))


def _has_failing_action(system: System, nodes: ByNumber, reached: Reached) -> bool:
    failing = (nodes[number] for number, found in reached.statuses.items() if "FAILURE" in found)
    return any(not node.children and RUNNING in statuses(system, node) for node in failing)


def _is_missed(analysis: Analysis, path: str, nodes: ByNumber, instance: Instance) -> bool:
    """Whether a node that is never ticked would be ticked if the condition before it were checked again at every
    tick."""
    other = reactive(analysis, path, instance, nodes)
    return other is not None and any(again.ticks.get(instance.number, False) for again in _explored(other, path))


def _all(
    analysis: Analysis, system: System, nodes: ByNumber, reached: Reached, missed: Callable[[Instance], bool]
) -> Iterator[tuple[str, Finding]]:
    """The paths of files, and the findings in them."""
    from roaml.project.blame import Blame  # noqa: PLC0415 - see `_explored`

    blame = Blame(
        analysis,
        system,
        reached.steps(),
        is_instant=reached.is_instant,
        steps_while_handled=lambda requests: _while_handled(reached.model, requests),
    )
    yield from _never_ticked(analysis, system, nodes, reached, missed, blame)
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


def _written(analysis: Analysis, source: NodeSource) -> TreeNode | None:
    file = analysis.tree(source.path)
    return None if file is None else node_at(file, source)


def _before(instance: Instance, by_number: ByNumber) -> Instance | None:
    """The sibling before a node."""
    if instance.parent is None:
        return None
    siblings = by_number[instance.parent].children
    index = siblings.index(instance.number)
    return by_number[siblings[index - 1]] if index > 0 else None


def _leaves(instance: Instance, by_number: ByNumber) -> Iterator[Instance]:
    for child in instance.children:
        yield from _leaves(by_number[child], by_number)
    if not instance.children:
        yield instance


def _decides(system: System, leaf: Instance, *, is_condition: bool) -> bool:
    """Whether a leaf is written so that it may succeed or fail. One that cannot is a simplification of a node that can
    do both. An action that never fails is usual, too: its server represents an environment without failures."""
    possible = statuses(system, leaf)
    return possible.issuperset((SUCCESS, FAILURE)) and not (is_condition and RUNNING in possible)
