# SPDX-License-Identifier: Apache-2.0
"""The automaton of the tree root, which ticks the topmost node at the rate of the tree
(docs/spec/plain-scxml.md#tree-root)."""

from __future__ import annotations

from roaml.expr.tree import Expr
from roaml.lower.build import equal, event_data, integer
from roaml.lower.interfaces import tree_event
from roaml.lower.program import TranslatableSystem
from roaml.model.expand import Instance
from roaml.scxml.events import Role, ScxmlEvent
from roaml.scxml.model import Automaton, Send, State, Target, Transition
from roaml.scxml.names import STATUSES, TREE_HAS_FINISHED, TREE_ROOT_PREFIX, TreeEventKind


def _word(program: TranslatableSystem, root: Instance) -> str:
    """The name of the tree in the system; without one, the name of its file without its extension."""
    return root.tree or program.system.tree_paths[0].replace("\\", "/").rpartition("/")[2].removesuffix(".xml")


def tick_timer(program: TranslatableSystem, root: Instance) -> tuple[str, str]:
    """The name of the automaton that ticks a tree, and the name of the timer that triggers it."""
    return f"{TREE_ROOT_PREFIX}{_word(program, root)}", f"{_word(program, root)}_tick"


def tree_root(program: TranslatableSystem, root: Instance, tick: ScxmlEvent) -> Automaton:
    """The automaton that ticks the tree with the topmost node `root`. `tick` is the event of the timer of the tree."""
    origin, number = program.node(root.number), root.number
    answer = tree_event(number, TreeEventKind.RESPONSE)

    def on(event: ScxmlEvent, target: str, cond: Expr | None = None, *body: Send) -> Transition:
        return Transition(event, cond, (Target(target, 1.0, body, origin),), origin)

    idle = (
        on(tick, "wait_tick_res", None, Send(tree_event(number, TreeEventKind.TICK), (), origin)),
        on(answer, "error"),
    )
    running = equal(event_data("status"), integer(STATUSES["RUNNING"]))
    transitions: dict[str, tuple[Transition, ...]] = {"idle": idle}
    if program.parameters.tick_if_not_running and program.library is not None:
        # BehaviorTree.CPP halts the tree after it has ended.
        reset = Send(tree_event(number, TreeEventKind.HALT), (), origin)
        transitions["wait_tick_res"] = (on(answer, "idle", running), on(answer, "wait_reset", None, reset))
        transitions["wait_reset"] = (on(tree_event(number, TreeEventKind.HALT_RESPONSE), "idle"),)
    elif program.parameters.tick_if_not_running:
        transitions["wait_tick_res"] = (on(answer, "idle"),)
    else:
        transitions["wait_tick_res"] = (on(answer, "idle", running), on(answer, TREE_HAS_FINISHED))
    # A tree that has ended does not stop the clock for the other trees.
    ignored = (on(tick, TREE_HAS_FINISHED),) if len(program.system.roots) > 1 else ()
    transitions |= {TREE_HAS_FINISHED: ignored, "error": ()}
    states = tuple(State(name, (), (), known, origin) for name, known in transitions.items())
    return Automaton(tick_timer(program, root)[0], Role.TREE_ROOT, "idle", (), states, origin)
