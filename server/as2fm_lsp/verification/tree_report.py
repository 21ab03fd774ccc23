# SPDX-License-Identifier: Apache-2.0
"""Reports about trees with mocks, for users and programs."""

from __future__ import annotations

import bisect
import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from as2fm_lsp.verification.status_table import status_table
from roaml.durations import AT_ONCE, moment
from roaml.lower.programs.executed import ExecutedNode
from roaml.lower.programs.nodes import EVENT_PROBABILITY
from roaml.mocks.network import MockedTree
from roaml.scxml.names import TREE_PREFIX, TreeEventKind, sent_by, tree_event_name
from roaml.smc.program import TRUE
from roaml.smc.record import SELECTED
from roaml.smc.story import Story
from roaml.text import Location
from roaml.verification.tree_outcome import COUNTERS, Influence, Measured, TreeOutcome
from roaml.views.cause import cause
from roaml.views.turns import Turn, turns

MAX_LEAVES, MAX_COUNTERS = 2, 2
"""The numbers of influences, and of recoveries and failed attempts, that a report states unless it is whole."""
_ONE = dict(zip(COUNTERS, ("recovery", "failed attempt"), strict=True))
"""Counter -> its name after the number 1."""
NEVER = 1e-9
"""The probability below which an exact report does not state that the tree may still run at the end of the time."""
MIN_NORMAL_TRACES = 30
"""If fewer traces than this succeed, or fewer fail, the intervals of influences are only approximate."""
RAISED_BY = 0.01
"""The change of the probability of a mock for which the report states the influence."""
NEGLIGIBLE = 0.0001
"""The change of the probability of success below which the report states that there is almost no difference."""
MAX_LINES = 40
"""The maximum number of shown lines of a trace; the lines in its middle are folded."""

PlaceOf = Callable[[Location], str]


def as_text(mocked: MockedTree, outcome: TreeOutcome, place_of: PlaceOf, *, is_whole: bool = False) -> str:
    """The measurements of a tree for users. The probability of success is not among them, because it is reported as the
    result of a property. `is_whole` selects all leaves and counters, each in its own line; otherwise, each kind has one
    line with the first of them."""
    return "".join(f"{line}\n" for line in _lines(mocked, outcome, place_of, is_whole))


def not_measured(reason: str) -> str:
    """A line that states why there are no measurements, although all states were to be explored."""
    return (
        f"  not computed: times, recoveries and influences, because {reason}; omit --exhaustive to estimate them from "
        "traces\n"
    )


def assumptions(mocked: MockedTree) -> str:
    """A line with the assumptions of the results: the number of leaves with mocks, the tick rate, the maximum time, the
    time of a tick, and the probability of events without a mock."""
    options = mocked.options
    leaves, nodes = len(mocked.leaves), len(mocked.tree.nodes)
    known = [leaf for leaf in mocked.leaves if leaf.is_known]
    certain = f" ({len(known)} that are known to succeed)" if known else ""
    text = (
        f"{nodes} {'node' if nodes == 1 else 'nodes'}, "
        f"{leaves} {'leaf' if leaves == 1 else 'leaves'} with mocks{certain}; "
        f"ticked at {float(options.rate):g} Hz, for at most {options.max_time / 1e9:g} s"
    )
    if (options.reaction_time or AT_ONCE).is_instant:
        text += "; a tick takes no time"
    if cut := [leaf.drawn.cut for leaf in mocked.leaves if leaf.drawn is not None]:
        text += "; drawn durations are rounded up to ticks"
        if max(cut) > 0:
            text += f", and the most extreme ones, with a probability of at most {max(cut):.1g}, are cut"
    if likes := _likes(mocked):
        text += f"; executed like nodes of the library: {likes}"
    if mocked.assumed:
        names = ", ".join(f"`{node.name}`" for node in mocked.assumed)
        text += f"; at each tick, the event of {names} has the probability {EVENT_PROBABILITY:g} (no mock)"
    for entry, (type_, port) in mocked.overwritten.items():
        text += (
            f"; the mock of `{type_}` overwrites the entry `{entry}`, which the tree sets: declare its port `{port}` "
            "as `<input_port>` in `<TreeNodesModel>` if it only reads the entry"
        )
    return text


def _likes(mocked: MockedTree) -> str:
    """The nodes that are executed like nodes of libraries, by their types, or by their names if those of a type
    differ; "" if there are none."""
    likes: dict[str, dict[str, str]] = {}
    for node in mocked.tree.nodes:
        if node.own_type:
            likes.setdefault(node.own_type, {})[node.name] = node.like
    shown: dict[str, str] = {}
    for type_, names in likes.items():
        same = set(names.values())
        shown |= {type_: same.pop()} if len(same) == 1 else names
    return ", ".join(f"`{own}` as `{like}`" for own, like in shown.items())


def _lines(mocked: MockedTree, outcome: TreeOutcome, place_of: PlaceOf, is_whole: bool) -> Iterator[str]:
    if outcome.reason:
        yield f"  estimated from traces, because {outcome.reason}"
    is_unfinished = outcome.unfinished.value > NEVER
    if is_unfinished or outcome.exceptions.value:
        yield f"  the tree fails: {_interval(outcome.failure)}"
    if is_unfinished:
        yield f"  not ended when the time ends: {_interval(outcome.unfinished)}"
    if outcome.exceptions.value:
        yield f"  ended by an exception of the library: {_interval(outcome.exceptions)}"
    if outcome.time is not None:
        yield f"  time until success: {_time(outcome.time)}; {', '.join(_quantiles(outcome))}"
    shown = _shown([node for node, _, _ in outcome.counts], place_of)
    counts = [
        f"{_counted(value, counter)} of {shown[node.number]}"
        for node, counter, value in outcome.counts
        if value.value or is_whole
    ]
    yield from _listed("in a run, on average", counts, MAX_COUNTERS, is_whole)
    if not outcome.influences and not outcome.is_exact and any(0 < leaf.probability < 1 for leaf in mocked.leaves):
        yield (
            "  the influence of the leaves cannot be estimated, because all traces had the same outcome; more traces "
            "(--max-traces) may have other outcomes"
        )
    if outcome.influences and outcome.is_exact and outcome.success.value == 0:
        yield "  influence of the leaves: none, because the tree does not succeed, whatever they return"
    elif outcome.influences:
        note = (
            f" (only {outcome.rare} traces differ from the others: the intervals are approximate)"
            if outcome.rare is not None and outcome.rare < MIN_NORMAL_TRACES
            else ""
        )
        shown = _shown([influence.leaf.node for influence in outcome.influences], place_of)
        influences = [_influence(influence, shown) for influence in outcome.influences]
        yield from _listed(f"influence on the probability of success{note}", influences, MAX_LEAVES, is_whole)


def _shown(nodes: Iterable[ExecutedNode], place_of: PlaceOf) -> dict[int, str]:
    """Number of a node -> the node with its place, and with its number if another node of this name has the same place,
    because a tree is used several times."""
    shown = {node.number: (node.name, place_of(node.origin)) for node in nodes}
    count = Counter(shown.values())
    return {
        number: f"{name} ({place}{f', {TREE_PREFIX}{number}' if count[name, place] > 1 else ''})"
        for number, (name, place) in shown.items()
    }


def _listed(title: str, parts: Sequence[str], most: int, is_whole: bool) -> Iterator[str]:
    """Some parts with a title: the first ones in one line, or all of them, each in its line, if the report is whole."""
    if is_whole and len(parts) > 1:
        yield f"  {title}:"
        yield from (f"    {part}" for part in parts)
    elif parts:
        more = len(parts) - most
        end = f"; … {more} more (--verbose)" if more > 0 else ""
        yield f"  {title}: {'; '.join(parts[:most])}{end}"


def _counted(value: Measured, counter: str) -> str:
    """A number of events with its unit, such as `1 recovery`."""
    count = _count(value)
    return f"{count} {_ONE[counter] if count.split()[-1] == '1' else counter.replace('_', ' ')}"


def _count(value: Measured) -> str:
    return f"in all traces {value.value:g}" if _is_constant(value) else _interval(value)


def _quantiles(outcome: TreeOutcome) -> Iterator[str]:
    """Quantiles of the time, such as `50 % within 8 s`; those with the same time together."""
    times = [_interval(Measured(quantile.value, quantile.bounds)) for quantile in outcome.quantiles]
    shares = [f"{quantile.share * 100:g}" for quantile in outcome.quantiles]
    for time, group in itertools.groupby(zip(shares, times, strict=True), key=lambda pair: pair[1]):
        *others, last = (share for share, _ in group)
        yield f"{', '.join(others)}{' and ' if others else ''}{last} % within {time} s"


def _influence(influence: Influence, shown: Mapping[int, str]) -> str:
    """What a small change of the probability of a mock does, such as `raising Grasp (tree.xml:5) from 0.9 to 0.91 adds
    0.008`."""
    node, before = influence.leaf.node, influence.leaf.probability
    change = RAISED_BY if before + RAISED_BY <= 1 else 1 - before
    low, value, high = (change * v for v in (influence.bounds.lower, influence.value, influence.bounds.upper))
    raised = f"raising {shown[node.number]} from {before:.6g} to {before + change:.6g}"
    if abs(value) < NEGLIGIBLE and abs(low) < NEGLIGIBLE and abs(high) < NEGLIGIBLE:
        return f"{raised} makes almost no difference (less than {NEGLIGIBLE:g})"
    if low == high:
        return f"{raised} {'adds' if value > 0 else 'takes away'} {abs(value):.2g}"
    if low <= 0 <= high:
        return f"{raised} makes no difference that these traces show ({low:.2g} to {high:.2g})"
    least, most = sorted((abs(low), abs(high)))
    return f"{raised} {'adds' if value > 0 else 'takes away'} about {abs(value):.2g} ({least:.2g} to {most:.2g})"


def _time(mean: Measured) -> str:
    if _is_constant(mean):
        return f"{mean.value:.4g} s in all traces that succeed"
    return f"mean {_interval(mean)} s"


def _is_constant(mean: Measured) -> bool:
    """Whether a mean is that of equal values, from which no interval follows."""
    return math.isinf(mean.bounds.upper)


def _interval(measured: Measured) -> str:
    value, bounds = measured.value, measured.bounds
    if bounds.lower == bounds.upper:
        return f"{value:.4g}"
    upper = "∞" if math.isinf(bounds.upper) else f"{bounds.upper:.4g}"
    return f"{value:.4g} ({bounds.lower:.4g} to {upper})"


def story_as_text(
    mocked: MockedTree, story: Story, place_of: PlaceOf, *, has_table: bool = False, is_whole: bool = False
) -> str:
    """Why the tree succeeds or fails in a trace, in one sentence, and the statuses that leaves return.

    The statuses are in the order of the trace, with their times. Successes of leaves that always succeed are omitted.
    Of more than `MAX_LINES` statuses, the middle ones are omitted unless `is_whole`.

    Args:
        has_table: whether a table follows with the statuses that each node returns.
    """
    nodes = {node.automaton: node for node in mocked.tree.nodes}
    uncertain = {leaf.node.automaton for leaf in mocked.leaves if leaf.probability < 1}
    leaf_turns = [
        turn
        for turn in turns(story)
        if turn.automaton in nodes
        and not turn.is_answered
        and _has_ended(turn)
        and (turn.automaton in uncertain or turn.status == "FAILURE")
    ]
    ticks = [
        step.number
        for step in story.steps
        if sent_by(step.action or "") == tree_event_name(mocked.tree.root, TreeEventKind.TICK)
    ]
    rows = []
    for turn in leaf_turns:
        node = nodes[turn.automaton]
        # Only a trace of a reduced state space has no clock.
        counted = float(bisect.bisect(ticks, turn.number) * mocked.options.tick_time)
        seconds = counted if turn.time is None else turn.time
        rows.append((moment(seconds), node.name, turn.status, place_of(node.origin)))
    widths = [max((len(row[i]) for row in rows), default=0) for i in range(3)]
    lines = [
        f"  {row[0]:>{widths[0]}}  {row[1]:<{widths[1]}}  {row[2]:<{widths[2]}}  {row[3]}".rstrip() for row in rows
    ]
    if len(lines) > MAX_LINES and not is_whole:
        folded = len(lines) - MAX_LINES
        lines[MAX_LINES // 2 : -MAX_LINES // 2] = [f"  … {folded} more statuses (--verbose) …"]
    failures = sum(turn.status == "FAILURE" and turn.automaton in uncertain for turn in leaf_turns)
    independent = f"; its {failures} failures happen by chance, independently of each other" if failures > 1 else ""
    outcome = "with" if story.recording.verdict == TRUE else "without"
    number = story.recording.trace
    article = "a" if number == SELECTED else "the shortest"
    head = f"{article} trace {outcome} success{f' (trace {number})' if number >= 0 else ''}{independent}:"
    why = cause(story, place_of)
    table = status_table(story, mocked.tree.nodes, place_of, is_whole=is_whole) if has_table else []
    return "".join(f"{line}\n" for line in (*([why] if why else []), head, *lines, *table))


def _has_ended(turn: Turn) -> bool:
    """Whether a leaf returns SUCCESS or FAILURE in a turn, and does not only repeat the status of an earlier tick."""
    ended = ("SUCCESS", "FAILURE")
    return turn.status in ended and not turn.parts[0].source.upper().startswith(ended)


def as_row(mocked: MockedTree, outcome: TreeOutcome) -> dict[str, Any]:
    """The measurements of a tree as a value for JSON."""
    return {
        "nodes": len(mocked.tree.nodes),
        "tick_rate": float(mocked.options.rate),
        "max_time": mocked.options.max_time / 1e9,
        "exact": outcome.is_exact,
        "traces": outcome.traces,
        "success": _row(outcome.success),
        "failure": _row(outcome.failure),
        "unfinished": _row(outcome.unfinished),
        "exceptions": _row(outcome.exceptions),
        "time": None if outcome.time is None else _row(outcome.time),
        "quantiles": [{"share": q.share, **_row(Measured(q.value, q.bounds))} for q in outcome.quantiles],
        **{
            counter: [
                {"node": node.name, "number": node.number, **_row(value)}
                for node, known, value in outcome.counts
                if known == counter
            ]
            for counter in COUNTERS
        },
        "influences": [
            {
                "node": i.leaf.node.name,
                "number": i.leaf.node.number,
                "probability": i.leaf.probability,
                **_row(Measured(i.value, i.bounds)),
            }
            for i in outcome.influences
        ],
        "drawn_durations": [
            {"node": leaf.node.name, "number": leaf.node.number, "mock": leaf.mock.behaviour(), "cut": leaf.drawn.cut}
            for leaf in mocked.leaves
            if leaf.drawn is not None
        ],
        "like": [
            {"node": n.name, "number": n.number, "type": n.own_type, "like": n.like}
            for n in mocked.tree.nodes
            if n.own_type
        ],
        "assumed": [{"node": n.name, "number": n.number, "probability": EVENT_PROBABILITY} for n in mocked.assumed],
    }


def _row(measured: Measured) -> dict[str, Any]:
    lower, upper = measured.bounds
    return {
        "value": measured.value,
        "lower": lower if math.isfinite(lower) else None,
        "upper": upper if math.isfinite(upper) else None,
    }
