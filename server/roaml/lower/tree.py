# SPDX-License-Identifier: Apache-2.0
"""The automaton of the tree root, which ticks the topmost node at the rate of the tree
(docs/spec/plain-scxml.md#tree-root)."""

from __future__ import annotations

from roaml.expr.tree import Expr
from roaml.lower.build import equal, event_data, integer
from roaml.lower.interfaces import tree_event
from roaml.lower.program import TranslatableSystem
from roaml.model.expand import ROOT_NUMBER
from roaml.scxml.events import Role, ScxmlEvent
from roaml.scxml.model import Automaton, Send, State, Target, Transition
from roaml.scxml.names import STATUSES, TREE_HAS_FINISHED, TREE_ROOT_PREFIX, TreeEventKind

ANSWER = tree_event(ROOT_NUMBER, TreeEventKind.RESPONSE)


def _stem(program: TranslatableSystem) -> str:
    """The name of the tree file without its extension."""
    return program.system.tree_paths[0].replace("\\", "/").rpartition("/")[2].removesuffix(".xml")


def tick_timer(program: TranslatableSystem) -> tuple[str, str]:
    """The name of the automaton that ticks the tree, and the name of the timer that triggers it."""
    return f"{TREE_ROOT_PREFIX}{_stem(program)}", f"{_stem(program)}_tick"


def tree_root(program: TranslatableSystem, tick: ScxmlEvent) -> Automaton:
    """The automaton of the tree root. `tick` is the event of the timer of the tree."""
    origin = program.node(ROOT_NUMBER)

    def on(event: ScxmlEvent, target: str, cond: Expr | None = None, *body: Send) -> Transition:
        return Transition(event, cond, (Target(target, 1.0, body, origin),), origin)

    idle = (
        on(tick, "wait_tick_res", None, Send(tree_event(ROOT_NUMBER, TreeEventKind.TICK), (), origin)),
        on(ANSWER, "error"),
    )
    running = equal(event_data("status"), integer(STATUSES["RUNNING"]))
    transitions: dict[str, tuple[Transition, ...]] = {"idle": idle}
    if program.parameters.tick_if_not_running and program.library is not None:
        # BehaviorTree.CPP halts the tree after it has ended.
        reset = Send(tree_event(ROOT_NUMBER, TreeEventKind.HALT), (), origin)
        transitions["wait_tick_res"] = (on(ANSWER, "idle", running), on(ANSWER, "wait_reset", None, reset))
        transitions["wait_reset"] = (on(tree_event(ROOT_NUMBER, TreeEventKind.HALT_RESPONSE), "idle"),)
    elif program.parameters.tick_if_not_running:
        transitions["wait_tick_res"] = (on(ANSWER, "idle"),)
    else:
        transitions["wait_tick_res"] = (on(ANSWER, "idle", running), on(ANSWER, TREE_HAS_FINISHED))
    transitions |= {TREE_HAS_FINISHED: (), "error": ()}
    states = tuple(State(name, (), (), known, origin) for name, known in transitions.items())
    return Automaton(tick_timer(program)[0], Role.TREE_ROOT, "idle", (), states, origin)
