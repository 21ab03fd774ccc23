# SPDX-License-Identifier: Apache-2.0
"""The rule `script-name`, which script_name.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.forest.forest import Forest
from roaml.forest.scripts import script_attributes
from roaml.model.tree import Tree, nodes
from roaml.rules.rule import Rule, TreeContext, did_you_mean, replacements
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of
from roaml.rules.support.scripts import scripts
from roaml.script.names import names_in
from roaml.script.tree import Assignment, Name, Script, walk
from roaml.suggest import nearest_name


def check(context: TreeContext) -> Iterator[Finding]:
    yield from _untranslated(context)
    if (forest := trees_of(context)) is not None:
        yield from _uncreated(context, forest)


def _untranslated(context: TreeContext) -> Iterator[Finding]:
    """Report the names that the translation of the tree cannot read."""
    for name, span in {(refusal.unset, refusal.span): None for refusal in context.refusals if refusal.unset}:
        tree = next(
            tree for tree in context.file.trees if tree.element.span.start <= span.start < tree.element.span.end
        )
        created = _created(tree)
        if name in created:
            continue  # by a node that cannot be translated, which another rule reports
        close = tuple(filter(None, (nearest_name(name, created),)))
        hint = did_you_mean(close) or "; a script, a port or a `<SubTree>` of the tree must set it"
        yield RULE.at(span, f"{_NOTHING} `{name}`{hint}", *replacements(span, close), severity=Severity.ERROR)


def _created(tree: Tree) -> set[str]:
    """The names of the entries that the ports and scripts of a tree create."""
    ports = {setting.variable for node in nodes(tree) for setting in node.ports if setting.variable}
    scripts_of_tree = (script for node in nodes(tree) for script in script_attributes(node))
    return ports | {name for script in scripts_of_tree for name, use in names_in(script.value) if use == ":="}


_NOTHING = "nothing in the trees creates"


def _uncreated(context: TreeContext, forest: Forest) -> Iterator[Finding]:
    entries = entries_of(forest)
    created: set[str] = set()
    names: dict[str, list[str]] = {}
    for key, uses in entries.by_entry.items():
        if any(bound.use.creates for bound in uses):
            created.add(key)
            for bound in uses:
                names.setdefault(bound.use.tree, []).append(bound.use.name)
    for tree, _, script, problems in scripts(context):
        own = tree.id.value if tree.id else ""
        for name, operator in _names(script) if not problems else ():
            if not operator and forest.system is not None:
                continue  # `_untranslated` reports it
            plain = name.name.removeprefix("@")
            if entries.is_intended(own, name.name):
                continue  # port-value reports the output port that should create the entry
            if not entries.entries(own, name.name) <= created and plain not in forest.host_entries:
                yield _finding(name, operator, nearest_name(name.name, names.get(own, ())), _is_closed(forest, tree))


def _names(script: Script) -> Iterator[tuple[Name, str]]:
    """The names in a script, each with the operator that assigns to it; an empty string if it is only read."""
    targets: set[int] = set()
    for expr in walk(script):
        if isinstance(expr, Assignment):
            targets.add(id(expr.target))
            yield expr.target, expr.operator
        elif isinstance(expr, Name) and id(expr) not in targets:
            yield expr, ""


def _is_closed(forest: Forest, tree: Tree) -> bool:
    """Whether all uses of a tree are known: other files may remap its entries."""
    if forest.system is not None:
        return True
    if not forest.complete:
        return False
    return len(forest.trees) == 1 or (tree.id is not None and forest.main in forest.trees)


def _finding(name: Name, operator: str, near: str | None, closed: bool) -> Finding:
    close = (near,) if near else ()
    fixes = replacements(name.span, close)
    if operator:
        hint = did_you_mean(close) or "; write `:=` to create it, or set it in the program"
        message = f"`{operator}` needs an entry, and nothing creates `{name.name}`{hint}"
        return RULE.at(name.span, message, *fixes, severity=Severity.WARNING if closed else Severity.INFORMATION)
    hint = did_you_mean(close) or "; it may be an enumeration constant or an entry of the program"
    return RULE.at(name.span, f"{_NOTHING} `{name.name}`{hint}", *fixes)


RULE = Rule(
    "script-name", Severity.INFORMATION, "A script uses an entry that no script and no port creates.", tree=check
)
