# SPDX-License-Identifier: Apache-2.0
"""The ticks and halts that may arrive at a node of the tree of a system, from the programs of the nodes above it
(docs/spec/nodes.md)."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.libraries import library_node
from roaml.libraries.programs.statuses import RUNNING, SUCCESS
from roaml.model.behavior.phases import Phase
from roaml.model.expand import entered_uses
from roaml.model.node_effects import tree_effects
from roaml.model.system import System, SystemAutomaton

_AT_REST = frozenset((None, Phase.ENDED))
_STATUSES: frozenset[Phase | None] = _AT_REST | {Phase.RUNNING}
_PHASES = {RUNNING: Phase.RUNNING, SUCCESS: Phase.ENDED}

WITHOUT_RESETS = frozenset(("Inverter", "RetryUntilSuccessful"))
"""The nodes that do not reset a child that has ended, with the semantics of AS2FM (docs/spec/nodes.md#as2fm)."""


def statuses_at_tick(system: System, automaton: SystemAutomaton) -> frozenset[Phase | None]:
    """The statuses that a node may have when it is ticked: `RUNNING`, `ENDED`, or `None` if it was not ticked
    before."""
    if system.parameters.tick_if_not_running:
        return _STATUSES
    child = automaton
    for parent in _ancestors(system, automaton):
        if parent.path or tree_effects(system).on_child(parent, child).restarts:
            return _STATUSES
        child = parent
    return _STATUSES - {Phase.ENDED}


def statuses_at_halt(system: System, automaton: SystemAutomaton) -> frozenset[Phase | None]:
    """The statuses that a node may have when it is halted, as for `statuses_at_tick`; none if it is never halted."""
    is_reset = system.parameters.tick_if_not_running and system.is_library_tree
    halted: frozenset[Phase | None] = frozenset((Phase.ENDED,) if is_reset else ())
    nodes = [automaton, *_ancestors(system, automaton)]
    for parent, child in zip([None, *reversed(nodes)], reversed(nodes), strict=False):
        if parent is not None:
            halted = _halted(system, parent, child, halted)
        if _stops_itself(system, parent, child):
            halted |= {Phase.RUNNING}
    return halted


def _halted(
    system: System, parent: SystemAutomaton, child: SystemAutomaton, parent_halted: frozenset[Phase | None]
) -> frozenset[Phase | None]:
    """The statuses in which `parent` may halt its child, if it may itself be halted in the statuses `parent_halted`."""
    if parent.path:  # a plugin of the user
        return _STATUSES if parent.outline.plugin.halts_children else frozenset()
    effects = tree_effects(system).on_child(parent, child)
    if system.is_program(parent):
        halts = effects.halts | (effects.passes_halts if Phase.RUNNING in parent_halted else frozenset())
        return frozenset(_PHASES[status] for status in halts)
    # AS2FM resets all children, whatever their statuses are.
    node = library_node(parent.outline.name)
    resets = bool(parent_halted) or (node is not None and node.name not in WITHOUT_RESETS)
    is_running = RUNNING in effects.halts or Phase.RUNNING in parent_halted
    return (_AT_REST if resets else frozenset()) | ({Phase.RUNNING} if is_running else frozenset())


def _stops_itself(system: System, parent: SystemAutomaton | None, node: SystemAutomaton) -> bool:
    """Whether `_while` of a node, or of a `<SubTree>` around it and below `parent`, can halt the running node."""
    assert node.instance is not None
    around = None if parent is None or parent.instance is None else parent.instance.use
    entered = entered_uses(system.tree_uses, node.instance.use, around)
    scripts = [node.instance.scripts, *(system.tree_uses[use].scripts for use in entered)]
    return any(name == "_while" for given in scripts for name, _ in given)


def _ancestors(system: System, automaton: SystemAutomaton) -> Iterator[SystemAutomaton]:
    """The nodes above a node, the nearest first."""
    number = automaton.instance.parent if automaton.instance else None
    while number is not None and (above := system.by_instance.get(number)) is not None:
        yield above
        number = above.instance.parent if above.instance else None
