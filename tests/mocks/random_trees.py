# SPDX-License-Identifier: Apache-2.0
"""Random trees over all nodes of the libraries, as data, as XML, and as nodes of `library_model`."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import library_model
from hypothesis import strategies as st

ENTRIES = {"x": 0, "y": 1, "k": 0}
"""The entries that all random trees use, with their first values."""


@dataclass(frozen=True)
class Drawn:
    """A node of a random tree."""

    type: str
    ports: tuple[tuple[str, str], ...] = ()
    children: tuple[Drawn, ...] = ()


CONDITIONS = ("x < 2", "y == 1", "x >= 1 && y == 1", "x + y > 2", "x != y")
ACTIONS = ("x += 1", "y := 1 - y", "x := 0", "x += 1; y := 0", "k := k")
ATTRIBUTES = {
    **dict.fromkeys(("_failureIf", "_successIf", "_skipIf", "_while"), CONDITIONS),
    **dict.fromkeys(("_onSuccess", "_onFailure", "_onHalted", "_post"), ACTIONS),
}
CONTROLS: dict[str, dict[str, tuple[str, ...]]] = {
    "Sequence": {},
    "Fallback": {},
    "AsyncSequence": {},
    "AsyncFallback": {},
    "SequenceWithMemory": {},
    "ReactiveSequence": {},
    "ReactiveFallback": {},
    "Parallel": {"success_count": ("-1", "-2", "1", "2", "{x}"), "failure_count": ("1", "-1", "2")},
    "ParallelAll": {"max_failures": ("0", "1", "-1", "2")},
    "IfThenElse": {},
    "WhileDoElse": {},
    "Switch2": {"variable": ("{x}", "{y}"), "case_1": ("1", "2"), "case_2": ("0", "3")},
    "TryCatch": {"catch_on_halt": ("true", "false")},
}
NAV2_CONTROLS: dict[str, dict[str, tuple[str, ...]]] = {
    "PipelineSequence": {},
    "RecoveryNode": {"number_of_retries": ("0", "1", "2", "{x}")},
    "RoundRobin": {"wrap_around": ("true", "false")},
    "NonblockingSequence": {},
    "PersistentSequence": {"current_child_idx": ("{k}",)},
}
DECORATORS: dict[str, dict[str, tuple[str, ...]]] = {
    "Inverter": {},
    "ForceSuccess": {},
    "ForceFailure": {},
    "KeepRunningUntilFailure": {},
    "Repeat": {"num_cycles": ("0", "1", "3", "{x}")},
    "RetryUntilSuccessful": {"num_attempts": ("0", "1", "3", "{x}")},
    "RunOnce": {"then_skip": ("true", "false")},
    "Precondition": {"if": CONDITIONS, "else": ("SUCCESS", "FAILURE", "RUNNING", "SKIPPED")},
    "LoopInt": {"queue": ("1;2", "0"), "if_empty": ("SUCCESS", "FAILURE", "SKIPPED"), "value": ("{x}",)},
    "SkipUnlessUpdated": {"entry": ("x", "{y}")},
    "WaitValueUpdate": {"entry": ("x", "{y}")},
}
TIMED: dict[str, dict[str, tuple[str, ...]]] = {
    "Delay": {"delay_msec": ("0", "100", "250")},
    "Timeout": {"msec": ("0", "100", "250")},
}
NAV2_DECORATORS: dict[str, dict[str, tuple[str, ...]]] = {
    "RateController": {"hz": ("10.0", "5.0", "3.0")},
    "SingleTrigger": {},
    "GoalUpdater": {},
}
LEAVES: dict[str, dict[str, tuple[str, ...]]] = {
    "Check": {},
    "Act0": {},
    "Act1": {},
    "Act2": {},
    "Act3": {},
    "AlwaysSuccess": {},
    "AlwaysFailure": {},
    "Script": {"code": ACTIONS},
    "ScriptCondition": {"code": CONDITIONS},
    "SetBlackboard": {"value": ("0", "1", "2", "{x}"), "output_key": ("y",)},
    "WasEntryUpdated": {"entry": ("x", "{y}")},
}
SLEEP: dict[str, dict[str, tuple[str, ...]]] = {"Sleep": {"msec": ("0", "100", "200")}}
COUNTS = {"IfThenElse": (2, 3), "WhileDoElse": (2, 3), "Switch2": (3, 3), "TryCatch": (2, 3), "RecoveryNode": (2, 2)}
ALL = {**CONTROLS, **NAV2_CONTROLS, **DECORATORS, **TIMED, **NAV2_DECORATORS, **LEAVES, **SLEEP}


def trees(
    controls: dict[str, dict[str, tuple[str, ...]]],
    decorators: dict[str, dict[str, tuple[str, ...]]],
    leaves: dict[str, dict[str, tuple[str, ...]]],
    depth: int = 3,
) -> st.SearchStrategy[Drawn]:
    @st.composite
    def node(draw: st.DrawFn, left: int) -> Drawn:
        kinds = ["leaf"] if left == 0 else ["leaf", "control", "control", "control", "decorator", "decorator"]
        kind = draw(st.sampled_from(kinds)) if left < depth else draw(st.sampled_from(kinds[1:]))
        table = {"leaf": leaves, "control": controls, "decorator": decorators}[kind]
        type_ = draw(st.sampled_from(sorted(table)))
        least, most = COUNTS.get(type_, (1, 3)) if kind == "control" else (int(kind == "decorator"),) * 2
        count = draw(st.integers(least, most))
        ports = [(key, draw(st.sampled_from(values))) for key, values in table[type_].items()]
        if draw(st.integers(0, 5)) == 0:
            key = draw(st.sampled_from(sorted(ATTRIBUTES)))
            ports.append((key, draw(st.sampled_from(ATTRIBUTES[key]))))
        return Drawn(type_, tuple(ports), tuple(draw(node(left - 1)) for _ in range(count)))

    return node(depth)


def as_xml(root: Drawn) -> str:
    """A file with the tree; leaves of the program are named `leaf<n>` in pre-order."""
    counter = itertools.count()
    lines = ['<root BTCPP_format="4" main_tree_to_execute="Main">', '<BehaviorTree ID="Main">']
    lines += _element(root, counter)
    models = '<TreeNodesModel><Condition ID="Check"/></TreeNodesModel>'
    return "\n".join([*lines, "</BehaviorTree>", models, "</root>"])


def _element(drawn: Drawn, counter: Iterator[int]) -> Iterator[str]:
    name = f"leaf{next(counter)}"
    ports = "".join(f" {key}={quoteattr(value)}" for key, value in drawn.ports)
    if is_program_leaf(drawn):
        yield f'<{drawn.type} name="{name}"{ports}/>'
        return
    yield f"<{drawn.type}{ports}>"
    for child in drawn.children:
        yield from _element(child, counter)
    yield f"</{drawn.type}>"


def as_nodes(root: Drawn, world: library_model.World) -> library_model.Node:
    counter = itertools.count()

    def build(drawn: Drawn) -> library_model.Node:
        name = f"leaf{next(counter)}"
        children = [build(child) for child in drawn.children]
        return library_model.node_class(drawn.type)(world, name, dict(drawn.ports), children)

    return build(root)


def is_program_leaf(drawn: Drawn) -> bool:
    return drawn.type == "Check" or drawn.type.startswith("Act")
