# SPDX-License-Identifier: Apache-2.0
"""The rule `mixed-entries`, which mixed_entries.md describes."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.forest.entries import Use
from roaml.forest.forest import Forest
from roaml.forest.names import entry_of
from roaml.forest.ports import ports_of
from roaml.model.tree import PortSetting, TreeNode
from roaml.rules.rule import Rule, TreeContext, replacements
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of
from roaml.rules.support.unread_entries import unread_entries
from roaml.rules.support.words import Hole, difference, holes, words_of
from roaml.text import Location, TextEdit


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes:
        if not forest.calls_tree(node):
            yield from _half_exchanged(node)
    found = list(_unread(context, forest))
    yield from found
    reported = {finding.span for finding in found}
    yield from (finding for finding in _passed_over(context, forest) if finding.span not in reported)


def _half_exchanged(node: TreeNode) -> Iterator[Finding]:
    """Report two ports that are bound to the entries with each other's names, if two similar ports of the node have
    those with their own names."""
    bound = {s.attribute.name: (s, entry) for s in ports_of(node) if (entry := entry_of(s)) is not None}
    straight = {
        difference(a, b) for a, b in itertools.permutations(bound, 2) if _is_own(bound, a) and _is_own(bound, b)
    }
    for (port, (setting, entry)), (other, (other_setting, other_entry)) in itertools.combinations(bound.items(), 2):
        if entry == other and other_entry == port and difference(port, other) in straight - {None}:
            message = (
                f"the ports `{port}` and `{other}` are bound to each other's entries, unlike similar ports of this "
                "node; exchange them"
            )
            edits = (
                TextEdit(setting.value.span, other_setting.value.value),
                TextEdit(other_setting.value.span, setting.value.value),
            )
            related = [Related(other_setting.value.span, "the other port")]
            yield RULE.at(setting.value.span, message, Fix("Exchange the entries", edits), related=related)


def _is_own(bound: dict[str, tuple[PortSetting, str]], port: str) -> bool:
    return bound[port][1] == port


def _unread(context: TreeContext, forest: Forest) -> Iterator[Finding]:
    """Report a port that reads an entry with the word of another one, although nothing reads the entry with its own
    word: `controller_id="{selected_planner}"` beside an unread `selected_controller`."""
    uses: dict[tuple[str, str], list[Use]] = defaultdict(list)
    for use in entries_of(forest).uses:
        uses[use.tree, use.name].append(use)
    own = {node for _, node in forest.own_nodes}
    unread: dict[tuple[str, Hole, str], list[str]] = defaultdict(list)
    for (tree, name), of_entry in uses.items():
        if all(use.reads is False and use.writes for use in of_entry):
            for hole, word in holes(name):
                unread[tree, hole, word].append(name)
    for (tree, name), of_entry in uses.items():
        readers = [use for use in of_entry if use.reads]
        for use in readers if len(readers) > 1 else ():
            if use.node not in own or use.writes:
                continue
            for other in _meant(unread, tree, name, use.port):
                message = (
                    f"the port `{use.port}` reads `{{{name}}}`, although nothing reads `{{{other}}}`; did you mean "
                    "that?"
                )
                related = [Related(uses[tree, other][0].span, f"`{other}` is written")]
                fixes = replacements(use.span, (f"{{{other}}}",))
                yield RULE.at(use.span, message, *fixes, related=related if use.path == context.source.path else [])


def _meant(unread: Mapping[tuple[str, Hole, str], Sequence[str]], tree: str, name: str, port: str) -> Iterator[str]:
    """The unread entries of a tree with the word of a port in the place of another word of the entry `name`."""
    words = dict.fromkeys(words_of(port))
    for hole, own in holes(name):
        for word in words if own not in words else ():
            yield from unread.get((tree, hole, word), ())


def _passed_over(context: TreeContext, forest: Forest) -> Iterator[Finding]:
    """Report a port, also of a subtree, that reads another entry although nothing reads the one with its name."""
    for unread in unread_entries(forest).values():
        use = unread.writer.use
        if unread.reader is not None and unread.reader[0] == context.source.path:
            setting = unread.reader[1]
            message = (
                f"this port reads `{setting.value.value}`, although nothing reads `{{{use.name}}}`, which `{use.port}` "
                f"of `{use.node.type_name}` writes; did you mean that?"
            )
            related = [Related(Location(use.path, use.span), f"`{use.name}` is written")]
            fixes = replacements(setting.value.span, (f"{{{use.name}}}",))
            yield RULE.at(setting.value.span, message, *fixes, related=related)


RULE = Rule(
    "mixed-entries",
    Severity.WARNING,
    "A port of a node is bound to the entry of another port.",
    tree=check,
)
