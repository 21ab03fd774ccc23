# SPDX-License-Identifier: Apache-2.0
"""The rule `duplicate-model`, which duplicate_model.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.edit.elements import removal
from roaml.model.globals import event_names
from roaml.model.kinds import FileKind
from roaml.model.system import System
from roaml.model.system_file import TREE_ATTRIBUTE, ListedFile, SystemSection, are_named
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, SystemContext
from roaml.rules.support.odd_values import odd_inputs
from roaml.scxml.names import is_generated, sanitise
from roaml.text import Span


def check(context: SystemContext) -> Iterator[Finding]:
    """Report names that two ROS nodes or two plugins have, and names of ROS nodes that the translation gives to other
    automata."""
    outlines = dict((*context.system.nodes, *context.system.plugins))
    first: dict[tuple[SystemSection, str, str], ListedFile] = {}
    odd: set[Span] | None = None
    generated = _generated(context.system)
    for listed in context.files:
        outline = outlines.get(listed.path) if listed.required_kind is FileKind.MACHINE else None
        if outline is None or listed.input.src is None or not outline.name:
            continue
        if listed.input.element.get(TREE_ATTRIBUTE) is not None and not are_named(context.files):
            continue  # the copies for trees with one name are no mistake; `input-count` reports the names
        key = (listed.input.section, outline.name)
        before = first.get((*key, "")) or first.setdefault((*key, listed.input.tree), listed)
        if before is not listed and listed.input.section is not SystemSection.NODE_MODELS:
            odd = {value.text.span for value in odd_inputs(context.files)} if odd is None else odd
            if listed.input.src.span in odd:
                continue  # the file of another plugin, which inconsistent-value reports
        if before is not listed:
            yield _finding(context, listed, before, outline.name)
        elif listed.input.section is SystemSection.NODE_MODELS and (reason := _taken(outline.name, generated)):
            named = Related(Symbol(listed.path, SymbolKind.MACHINE, outline.name), "named here")
            message = f"the node has the same name as {reason}: `{outline.name}`; rename the node"
            yield RULE.at(listed.input.src.span, message, related=[named])


def _generated(system: System) -> dict[str, str]:
    """The names of automata that the translation adds for events and threads, with phrases for them."""
    generated = {
        event: f"the event `{event}`, which is an automaton of the translation"
        for event in event_names(system, lambda kind, name: None)
    }
    for automaton in system.automata:
        for thread in automaton.outline.threads:
            servers = (use for use in automaton.outline.interfaces if use.handle == thread.server)
            for name in filter(None, map(automaton.interface_name, servers)):
                words = f"a thread of the action `{name}`"
                generated.update({f"{sanitise(name)}_thread_{k}": words for k in range(min(thread.count, MAX_THREADS))})
    return generated


MAX_THREADS = 1000
"""The maximum number of threads whose names are checked; `model-too-large` reports systems with more."""


def _taken(name: str, generated: Mapping[str, str]) -> str:
    if is_generated(name):
        return "an automaton that the translation adds for services, actions, the tree or the clock"
    return generated.get(name, "")


def _finding(context: SystemContext, listed: ListedFile, before: ListedFile, name: str) -> Finding:
    src, earlier = listed.input.src, before.input.src
    assert src is not None
    assert earlier is not None
    first = Related(earlier.span, "the first `<input>`")
    kind_name = "node" if listed.input.section is SystemSection.NODE_MODELS else "plugin"
    if before.path == listed.path:
        # A plugin that is listed twice still exists once; a node would exist twice.
        same = f", so there would be two nodes `{name}`" if kind_name == "node" else ""
        remove = Fix("Remove this `<input>`", (removal(context.source.text, listed.input.element.span),), safe=True)
        severity = Severity.ERROR if kind_name == "node" else Severity.WARNING
        named = ", or give it another `name`" if kind_name == "node" else ""
        message = f"`{src.value}` is listed twice{same}; remove this `<input>`{named}"
        return RULE.at(src.span, message, remove, severity=severity, related=[first])
    place = Related(Symbol(listed.path, SymbolKind.MACHINE, name), "named here")
    message = f"there are two {kind_name}s `{name}`, here and in `{earlier.value}`; rename one of them"
    return RULE.at(src.span, message, related=[first, place])


RULE = Rule("duplicate-model", Severity.ERROR, "Two machines of a system have the same name.", system=check)
