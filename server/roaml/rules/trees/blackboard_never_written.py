# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-never-written`, which blackboard_never_written.md describes."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.entries import Entries, Key, Use
from roaml.forest.forest import Forest
from roaml.libraries import LIBRARIES, library
from roaml.model.gaps import GapAct
from roaml.model.system import System
from roaml.roles import Direction
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean, replacements
from roaml.rules.support.blackboard import described, places, renamings
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import forest_of
from roaml.suggest import nearest_name


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is not None:
        yield from _of_system(context, context.system)
    elif (forest := forest_of(context)) is not None:
        yield from _alone(context, forest)


def _of_system(context: TreeContext, system: System) -> Iterator[Finding]:
    board = system.blackboard
    set_ = [name for name, ports in board.items() if any(bound.port.written for bound in ports)]
    for variable, ports in board.items():
        entry = system.entries.get(variable)
        if variable in set_ or (entry is not None and entry.written) or system.may(GapAct.VARIABLE, variable):
            continue
        if variable in _hosted() and not any(bound.automaton.path for bound in ports):
            continue
        close = close_names(variable, set_)
        for bound, span, written in places(context, variable, ports):
            if bound.port.direction is Direction.OUT:
                yield RULE.at(span, f"`{bound.automaton.outline.name}` never writes its port `{bound.port.key}`")
            else:
                message = f"no node writes {described(variable, written)}{did_you_mean(close)}"
                yield RULE.at(span, message, *renamings(span, written, variable, close))


@functools.cache
def _hosted() -> frozenset[str]:
    """The blackboard entries that the programs of libraries set, for example those of Nav2."""
    return frozenset(entry for name in LIBRARIES for entry in library(name).entries)


# ------------------------------------------------------------ trees without a system


def _alone(context: TreeContext, forest: Forest) -> Iterator[Finding]:
    entries = entries_of(forest)
    executed = forest.executed
    by_entry = entries.by_entry
    written = {key for key, uses in by_entry.items() if any(use.writes is not False for use in uses)}
    names: dict[str, dict[str, Key]] = {}
    for key in written:
        for use in by_entry[key]:
            names.setdefault(use.tree, {}).setdefault(use.name, key)
    misspelled: dict[Use, Use] = {}
    for key, uses in by_entry.items():
        hosted = any(use.name.removeprefix("@") in forest.host_entries for use in uses)
        if key in written or not any(use.reads for use in uses):
            continue
        if any(entries.is_intended(use.tree, use.name) for use in uses):
            continue  # port-value reports the output port that should write the entry
        for use in uses:
            if use.path == context.source.path and _is_outermost(forest, entries, use) and use.tree in executed:
                known = names.get(use.tree, {})
                near = nearest_name(use.name, known)
                is_right = hosted or len(uses) > 1 or use.name in _keys(use)
                writer = _only_written(by_entry[known[near]]) if near is not None and is_right else None
                if writer is not None and writer.path == use.path:
                    misspelled.setdefault(writer, use)
                elif not hosted:
                    yield _unwritten(use, near)
    for writer, reader in misspelled.items():
        yield _unread(writer, reader)


def _is_outermost(forest: Forest, entries: Entries, use: Use) -> bool:
    """Whether a use reads an entry, or passes it to a subtree, in the outermost tree that has a name for the entry."""
    if use.script or "{" in use.name or not (use.reads or use.remaps):
        return False
    return (use.tree, use.name) not in entries.remapped and not _is_parameter(forest, use)


def _is_parameter(forest: Forest, use: Use) -> bool:
    """Whether the model of a subtree has a port for an entry; missing-port reports a port that is not set."""
    model = forest.subtree_models.get(use.tree)
    port = model.port(use.name) if model is not None else None
    return port is not None and port.direction.reads


def _keys(use: Use) -> set[str]:
    """The attributes of the node that name the entry, as in `path="{path}"`, where the name is certainly intended."""
    return {attribute.name for attribute in use.node.element.attributes if attribute.value_span == use.span}


def _only_written(uses: Iterable[Use]) -> Use | None:
    """The place that writes an entry, if its name is written there and nothing reads the entry."""
    writers = [use for use in uses if use.writes]
    is_read = any(use.reads is not False or use.remaps for use in uses)
    return None if is_read or len(writers) != 1 or writers[0].script else writers[0]


def _unwritten(use: Use, near: str | None) -> Finding:
    close = (near,) if near else ()
    hint = did_you_mean(close) or "; the program that runs the tree must set it"
    fixes = replacements(use.span, tuple(f"{{{name}}}" for name in close))
    severity = Severity.WARNING if close else Severity.INFORMATION
    return RULE.at(use.span, f"no node writes {described(use.name, use.name)}{hint}", *fixes, severity=severity)


def _unread(writer: Use, reader: Use) -> Finding:
    hint = did_you_mean((reader.name,))
    message = f"no node reads {described(writer.name, writer.name)}, and no node writes `{reader.name}`{hint}"
    related = [Related(reader.span, f"`{reader.name}` is read here")]
    fixes = replacements(writer.span, (f"{{{reader.name}}}",))
    return RULE.at(writer.span, message, *fixes, severity=Severity.WARNING, related=related)


RULE = Rule("blackboard-never-written", Severity.ERROR, "A blackboard variable is read but never written.", tree=check)
