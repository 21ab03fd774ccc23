# SPDX-License-Identifier: Apache-2.0
"""entry-never-written: see entry_never_written.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.forest.entries import Use
from roaml.rules.rule import Rule, TreeContext, did_you_mean, replacements
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import forest_of
from roaml.suggest import nearest_name


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    entries = entries_of(forest)
    by_entry = entries.by_entry()
    written = {key for key, uses in by_entry.items() if any(use.writes is not False for use in uses)}
    names: dict[str, list[str]] = {}
    for key in written:
        for use in by_entry[key]:
            names.setdefault(use.tree, []).append(use.name)
    for key, uses in by_entry.items():
        hosted = any(use.name.removeprefix("@") in forest.host_entries for use in uses)
        if key in written or hosted or not any(use.reads for use in uses):
            continue
        for use in uses:
            if use.path == context.source.path and use.reads and not use.script:
                yield _finding(use, names.get(use.tree, []))


def _finding(use: Use, names: list[str]) -> Finding:
    near = nearest_name(use.name, names)
    close = (near,) if near else ()
    hint = did_you_mean(close) or "; the program that runs the tree must set it"
    message = f"no tree writes the entry `{use.name}`{hint}"
    return RULE.at(use.span, message, *replacements(use.span, tuple(f"{{{name}}}" for name in close)))


RULE = Rule("entry-never-written", Severity.INFORMATION, "A blackboard entry is read but never written.", tree=check)
