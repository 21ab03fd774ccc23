# SPDX-License-Identifier: Apache-2.0
"""Random trees over all nodes of the libraries, as data, as XML, and as nodes of `library_model`."""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, TypeAlias, TypeVar
from xml.sax.saxutils import quoteattr

import library_model

import kept_strategies as st
from roaml.libraries import library_node

Table: TypeAlias = Mapping[str, Mapping[str, Sequence[str]]]
"""Types of nodes, with the ports of each and what they may contain."""
T = TypeVar("T")

ENTRIES = {"x": 0, "y": 1, "k": 0}
"""The entries that all random trees use, with their first values."""


_NAME = re.compile(rf"\b({'|'.join(ENTRIES)})\b")


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
CONTROLS: Table = {
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
    **{
        f"Switch{count}": {
            "variable": ("{x}", "{y}", "2"),
            **{f"case_{case}": (str(case), "{y}", "7") for case in range(1, count + 1)},
        }
        for count in (3, 4, 5, 6)
    },
    "TryCatch": {"catch_on_halt": ("true", "false")},
}
NAV2_CONTROLS: Table = {
    "PipelineSequence": {},
    "RecoveryNode": {"number_of_retries": ("0", "1", "2", "{x}")},
    "RoundRobin": {"wrap_around": ("true", "false")},
    "NonblockingSequence": {},
    "PersistentSequence": {"current_child_idx": ("{k}",)},
}
DECORATORS: dict[str, Mapping[str, Sequence[str]]] = {
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
    "SubTree": {"x": ("{x}", "{y}"), "y": ("{y}", "{x}"), "_autoremap": ("true",)},
}
TIMED: Table = {
    "Delay": {"delay_msec": ("0", "100", "250")},
    "Timeout": {"msec": ("0", "100", "250")},
}
NAV2_DECORATORS: Table = {
    "RateController": {"hz": ("10.0", "5.0", "3.0")},
    "SingleTrigger": {},
    "GoalUpdater": {},
}
LEAVES: Table = {
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
SLEEP: Table = {"Sleep": {"msec": ("0", "100", "200")}}
WORLD_CONTROLS: Table = {"PauseResumeController": {}}
WORLD_DECORATORS: Table = {
    "DistanceController": {"distance": ("1.0",)},
    "GoalUpdatedController": {},
    "SpeedController": {"min_rate": ("1.0", "2.0"), "max_rate": ("5.0", "10.0")},
    "PathLongerOnApproach": {},
}
"""Nodes that ask about the world, where the same event occurs always or never."""
DECORATORS |= {
    name: kind.PORTS
    for name, kind in vars(library_model).items()
    if isinstance(kind, type) and issubclass(kind, library_model.Decorator) and library_node(name) is not None
    if name not in {**DECORATORS, **TIMED, **NAV2_DECORATORS, **WORLD_DECORATORS}
}
COUNTS = {
    "IfThenElse": (2, 3),
    "WhileDoElse": (2, 3),
    **{f"Switch{count}": (count + 1, count + 1) for count in range(2, 7)},
    "PauseResumeController": (1, 4),
    "TryCatch": (2, 3),
    "RecoveryNode": (2, 2),
}


class Choices(Protocol):
    """Where a random tree takes its choices from: hypothesis, or a seed."""

    def one_of(self, values: Sequence[T]) -> T: ...


@dataclass(frozen=True)
class SeededChoices:
    source: random.Random

    def one_of(self, values: Sequence[T]) -> T:
        return self.source.choice(values)


_NAME = re.compile(rf"\b({'|'.join(ENTRIES)})\b")


@dataclass(frozen=True)
class DrawnChoices:
    draw: st.DrawFn

    def one_of(self, values: Sequence[T]) -> T:
        return self.draw(st.sampled_from(values))


@dataclass(frozen=True)
class Kinds:
    """The nodes of random trees."""

    controls: Table
    decorators: Table
    leaves: Table

    def tree(self, choices: Choices, depth: int = 3, is_root: bool = True) -> Drawn:
        kinds = ["control", "control", "control", "decorator", "decorator"]
        kind = "leaf" if depth == 0 else choices.one_of(kinds if is_root else ["leaf", *kinds])
        table = {"leaf": self.leaves, "control": self.controls, "decorator": self.decorators}[kind]
        type_ = choices.one_of(sorted(table))
        least, most = COUNTS.get(type_, (1, 3)) if kind == "control" else (int(kind == "decorator"),) * 2
        count = choices.one_of(range(least, most + 1))
        ports = [(key, choices.one_of(values)) for key, values in table[type_].items()]
        if choices.one_of(range(6)) == 0:
            key = choices.one_of(sorted(ATTRIBUTES))
            ports.append((key, choices.one_of(ATTRIBUTES[key])))
        return Drawn(type_, tuple(ports), tuple(self.tree(choices, depth - 1, False) for _ in range(count)))


ANY = Kinds({**CONTROLS, **NAV2_CONTROLS}, {**DECORATORS, **TIMED, **NAV2_DECORATORS}, {**LEAVES, **SLEEP})
"""All nodes but those that ask about the world."""
WITH_WORLD = Kinds({**ANY.controls, **WORLD_CONTROLS}, {**ANY.decorators, **WORLD_DECORATORS}, ANY.leaves)

OF_OLD_VERSIONS = replace(ANY, controls={name: ports for name, ports in ANY.controls.items() if name != "TryCatch"})
"""The nodes that all versions of BehaviorTree.CPP 4 have."""


def trees(kinds: Kinds) -> st.SearchStrategy[Drawn]:
    @st.composite
    def tree(draw: st.DrawFn) -> Drawn:
        return kinds.tree(DrawnChoices(draw))

    return tree()


def as_xml(root: Drawn) -> str:
    """A file with the tree; nodes are named `leaf<n>` in pre-order."""
    counter = itertools.count()
    subtrees: list[str] = []
    main = "\n".join(['<BehaviorTree ID="Main">', *_element(root, counter, subtrees), "</BehaviorTree>"])
    models = '<TreeNodesModel><Condition ID="Check"/></TreeNodesModel>'
    return "\n".join(['<root BTCPP_format="4" main_tree_to_execute="Main">', main, *subtrees, models, "</root>"])


def _element(drawn: Drawn, counter: Iterator[int], subtrees: list[str]) -> Iterator[str]:
    number = next(counter)
    ports = "".join(f" {key}={quoteattr(value)}" for key, value in drawn.ports)
    if is_program_leaf(drawn):
        yield f'<{drawn.type} name="leaf{number}"{ports}/>'
        return
    children = [line for child in drawn.children for line in _element(child, counter, subtrees)]
    if drawn.type == "SubTree":
        yield f'<SubTree ID="Sub{number}"{ports}/>'
        subtrees.append("\n".join([f'<BehaviorTree ID="Sub{number}">', *children, "</BehaviorTree>"]))
        return
    yield f"<{drawn.type}{ports}>"
    yield from children
    yield f"</{drawn.type}>"


def as_nodes(root: Drawn, world: library_model.World) -> library_model.Node:
    counter = itertools.count()

    def build(drawn: Drawn, names: Mapping[str, str]) -> library_model.Node:
        """`names` are the entries outside that the names of the tree stand for."""

        def outside(text: str) -> str:
            return _NAME.sub(lambda match: names[match[0]], text)

        name = f"leaf{next(counter)}"
        ports = {key: outside(value) for key, value in drawn.ports}
        inner = names
        if drawn.type == "SubTree":
            inner = {entry: ports[entry].strip("{}") if entry in ports else names[entry] for entry in ENTRIES}
        children = [build(child, inner) for child in drawn.children]
        return library_model.node_class(drawn.type)(world, name, ports, children)

    return build(root, {entry: entry for entry in ENTRIES})


def is_program_leaf(drawn: Drawn) -> bool:
    return drawn.type == "Check" or drawn.type.startswith("Act")
