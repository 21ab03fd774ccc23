# SPDX-License-Identifier: Apache-2.0
"""duplicate-model: see duplicate_model.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.model.kinds import FileKind
from roaml.model.system_file import ListedFile
from roaml.rules.elements import removal
from roaml.rules.rule import Rule, SystemContext


def check(context: SystemContext) -> Iterator[Finding]:
    """Automata, and plugins among each other, need names of their own."""
    outlines = dict((*context.system.nodes, *context.system.plugins))
    first: dict[tuple[str, str], ListedFile] = {}
    for listed in context.files:
        outline = outlines.get(listed.path) if listed.wanted is FileKind.MACHINE else None
        if outline is None or listed.input.src is None or not outline.name:
            continue
        before = first.setdefault((listed.input.section, outline.name), listed)
        if before is not listed:
            yield _finding(context, listed, before, outline.name)


def _finding(context: SystemContext, listed: ListedFile, before: ListedFile, name: str) -> Finding:
    src, earlier = listed.input.src, before.input.src
    assert src is not None
    assert earlier is not None
    first = Related(earlier.span, "the first one")
    what = "node" if listed.input.section == "node_models" else "plugin"
    if before.path == listed.path:
        # Of a plugin that is listed twice there is still only one; of a node there would be two.
        same = f": there would be two nodes `{name}`" if what == "node" else ""
        remove = Fix("Remove this `<input>`", (removal(context.source.text, listed.input.element.span),), safe=True)
        severity = Severity.ERROR if what == "node" else Severity.WARNING
        message = f"`{src.value}` is listed twice{same}"
        return RULE.at(src.span, message, remove, severity=severity, related=[first])
    named = Related(Symbol(listed.path, "machine", name), "named here")
    return RULE.at(src.span, f"there are two {what}s `{name}`, here and in `{earlier.value}`", related=[first, named])


RULE = Rule("duplicate-model", Severity.ERROR, "Two machines of a system have the same name.", system=check)
