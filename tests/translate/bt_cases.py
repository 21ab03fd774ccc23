# SPDX-License-Identifier: Apache-2.0
"""Trees that show what the built-in nodes do: one table that goes through their settings, and any small tree."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from bt_trees import Setup, Tree, leaf, node, writer

import kept_strategies as st

SCRIPTS = (
    "SSFRRSRFFS",
    "FFFSSRRSFRRFR",
    "RFSRSSFFR",
    "FRFFFSSRRRS",
    "RFFSSSRFRRSFSF",
    "SSFFRFSFRSRRRFR",
    "SSSSRSFRRFFF",
)
"""In each, every answer is followed by every other; they have different lengths, so that all answers meet."""

GATE = "SSRSRFSFSFSSSSFSSSS"

WRITERS = {
    "n": writer("n", 1, 2, 1, 0, -1),
    "m": writer("m", 1, 1, 2, 0),
    "msec": writer("msec", 2000, 0, 1000, 1),
    "few": writer("few", 2, -1, 0, 3, 1),
    "least": writer("least", 1, 2),
    "yes": writer("yes", "true", "false", "false"),
    "word": writer("word", "a", "b", "", "ab"),
}
"""For each variable a leaf that keeps changing it."""


def gated(tree: Tree) -> Tree:
    """`tree`, halted whenever it has answered and now and then while it runs, beside what writes its variables."""
    return node("ReactiveSequence", *_writers(tree), leaf(GATE), tree)


def ungated(tree: Tree) -> Tree:
    """`tree`, ticked again when it has answered; it is never halted if it uses no variables."""
    writers = _writers(tree)
    return node("ReactiveSequence", *writers, tree) if writers else tree


def _writers(tree: Tree) -> list[Tree]:
    return [WRITERS[name] for name in sorted(tree.variables)]


def leaves(count: int) -> list[Tree]:
    return [leaf(script) for script in SCRIPTS[:count]]


def cases() -> Iterator[Tree]:
    """Every node with the numbers of children and the settings that make a difference."""
    yield node("AlwaysSuccess")
    yield node("AlwaysFailure")
    yield node("Sequence", leaf("SRSF"), leaf("SRSF"))
    for kind in ("Sequence", "Fallback", "SequenceWithMemory", "SequenceStar", "ReactiveSequence", "ReactiveFallback"):
        for count in (1, 2, 3):
            yield node(kind, *leaves(count))
    for count in (2, 3):
        yield node("IfThenElse", *leaves(count))
    yield node("Inverter", *leaves(1))
    for least, most in ((-1, 1), (-2, -1), (-9, 2), (0, 1), (2, 0), (-1, -2), ("{n}", 3), (-1, "{n}")):
        yield node("Parallel", leaf("RRFS"), leaf("RSF"), leaf("RRRS"), success_count=least, failure_count=most)
    for count, least, most in ((1, 1, 1), (2, 1, 1), (2, 1, 2), (2, 2, 1), (2, 2, 2), (3, 2, 2), (3, 3, 2), (3, 1, 3)):
        yield node("Parallel", *leaves(count), success_threshold=least, failure_threshold=most)
        yield node("Parallel", *leaves(count), success_count=least, failure_count=most)
    yield node("Parallel", *leaves(2))
    for count in (0, 1, 3, -1, "{few}"):
        yield node("Repeat", leaf("SSRFSRS"), num_cycles=count)
        yield node("RetryUntilSuccessful", leaf("FRFFRSR"), num_attempts=count)
    yield node("RetryUntilSuccesful", *leaves(1), num_attempts=2)
    for one, other, answer in (
        (2, 2, 2),
        (2, 3, 1),
        (2, 3, 2),
        (2, 3, 3),
        ("{n}", 1, 2),
        (1, "{n}", 3),
        ("{n}", "{m}", 1),
    ):
        yield node("BlackboardCheckInt", *leaves(1), value_A=one, value_B=other, return_on_mismatch=answer)
    check = node("BlackboardCheckInt", *leaves(1), value_A="{n}", value_B=1, return_on_mismatch=2)
    for value in (1, -7, "{m}"):
        yield node("Sequence", node("SetBlackboard", value=value, output_key="{n}"), check)


# ------------------------------------------------------------------- any trees

setups = st.builds(Setup, st.just(10), st.sampled_from((Fraction(1), Fraction(4), Fraction(5, 2))), st.booleans())

CHILDREN = {
    **dict.fromkeys(("Sequence", "Fallback", "SequenceWithMemory", "ReactiveSequence", "ReactiveFallback"), (1, 3)),
    "Parallel": (1, 3),
    "IfThenElse": (2, 3),
    **dict.fromkeys(("Inverter", "Repeat", "RetryUntilSuccessful", "BlackboardCheckInt"), (1, 1)),
}
"""Nodes, and the least and greatest number of their children."""

_numbers = st.sampled_from((-1, 0, 1, 2, "{n}", "{m}"))
_cycles = st.sampled_from((-1, 0, 1, 2, 3, "{few}"))


def ports_of(kind: str, count: int) -> st.SearchStrategy[dict[str, object]]:
    """Settings of a node with so many children."""
    counts = st.one_of(st.integers(-count - 1, count), st.just("{n}"))
    match kind:
        case "Parallel":
            return st.fixed_dictionaries({}, optional={"success_count": counts, "failure_threshold": counts})
        case "Repeat":
            return st.fixed_dictionaries({"num_cycles": _cycles})
        case "RetryUntilSuccessful":
            return st.fixed_dictionaries({"num_attempts": _cycles})
        case "BlackboardCheckInt":
            answers = st.integers(1, 3)
            return st.fixed_dictionaries({"value_A": _numbers, "value_B": _numbers, "return_on_mismatch": answers})
    return st.just({})


_scripted = st.text("SFR", min_size=1, max_size=6).map(leaf)
_leaves = st.one_of(
    _scripted,
    _scripted,
    _scripted,
    st.sampled_from((node("AlwaysSuccess"), node("AlwaysFailure"))),
    _numbers.map(lambda value: node("SetBlackboard", value=value, output_key="{n}")),
)


@st.composite
def parts(draw: st.DrawFn, depth: int) -> Tree:
    if depth == 0 or draw(st.integers(0, 4)) == 0:
        return draw(_leaves)
    kind = draw(st.sampled_from(sorted(CHILDREN)))
    least, most = CHILDREN[kind]
    children = draw(st.lists(parts(depth - 1), min_size=least, max_size=most))
    return replace(node(kind, *children, **draw(ports_of(kind, len(children)))), apart=draw(st.integers(0, 4)) == 0)


trees = parts(3).map(lambda tree: gated(tree) if tree.variables else tree)
"""Trees of at most three levels, some parts of which stand apart, beside what writes their variables."""
