# SPDX-License-Identifier: Apache-2.0
"""The rule `blackboard-never-written`, which blackboard_never_written.md describes."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.cpp_types import ANY, SIMPLE_TYPES
from roaml.forest.entries import BoundUse, Entries, Use
from roaml.forest.forest import Forest
from roaml.libraries import library_node
from roaml.model.expand import node_at
from roaml.model.gaps import GapAct
from roaml.model.tree import is_variable_name
from roaml.roles import Direction
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean, replacements
from roaml.rules.support.blackboard import described
from roaml.rules.support.entries import entries_of, is_of_subtree
from roaml.rules.support.forest import trees_of
from roaml.suggest import nearest_name


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    entries = entries_of(forest)
    written = {key for key, uses in entries.by_entry.items() if any(bound.use.writes is not False for bound in uses)}
    names = _names(entries, written)
    reported: set[Use] = set()
    misspelled: dict[Use, Use] = {}
    overwriting: dict[Use, Use] = {}
    for key, uses in entries.by_entry.items():
        if key in written or not _is_needed(forest, entries, uses):
            continue
        is_hosted = _is_hosted(forest, uses)
        for bound in uses:
            use = bound.use
            if use in reported or use.path != context.source.path or not _is_outermost(forest, bound):
                continue
            if _is_output(forest, use):
                reported.add(use)
                yield RULE.at(use.span, f"`{_name(use)}` never writes its port `{use.port}`")
                continue
            known = {name: key for name, key in names.get(use.tree, {}).items() if name != use.name}
            close = _close(forest, use.name, known)
            if forest.system is None:
                is_right = is_hosted or len({other.use for other in uses}) > 1 or use.name == use.port
                writer = _only_written(entries.by_entry[known[close[0]]]) if close and is_right else None
                if writer is not None and writer.path == use.path:
                    misspelled.setdefault(writer, use)
                    continue
            diverted = _diverted(forest, entries, use) if forest.system is None and not is_hosted else None
            if diverted is not None:
                overwriting.setdefault(diverted, use)
            elif not is_hosted:
                reported.add(use)
                close = close or _only_unread(entries, names, written, bound)
                yield _unset(context, bound, entries) or _unwritten(forest, bound, close)
    for writer, reader in misspelled.items():
        yield _unread(writer, reader)
    for writer, reader in overwriting.items():
        yield _overwritten(writer, reader)


def _names(entries: Entries, written: set[str]) -> Mapping[str, Mapping[str, str]]:
    """Name of a tree -> name of a written entry in it -> key of the entry. The order is that of execution."""
    names: dict[str, dict[str, str]] = {}
    for key, uses in entries.by_entry.items():
        for bound in uses if key in written else ():
            names.setdefault(bound.use.tree, {}).setdefault(bound.use.name, key)
    return names


def _is_needed(forest: Forest, entries: Entries, uses: tuple[BoundUse, ...]) -> bool:
    """Whether a node needs that the entry is written, and no other finding can be the reason why it is not."""
    is_read = any(bound.use.reads or bound.use.remaps for bound in uses)
    if not is_read and not any(_is_output(forest, bound.use) and not _is_of_library(bound.use) for bound in uses):
        return False
    if any(entries.is_intended(bound.use.tree, bound.use.name) for bound in uses):
        return False  # port-value reports the output port that should write the entry
    variable = uses[0].variable
    return _is_valid(forest, variable) and (forest.system is None or not forest.system.may(GapAct.VARIABLE, variable))


def _is_valid(forest: Forest, name: str) -> bool:
    """Whether a name can be that of an entry; port-value reports other names."""
    return is_variable_name(name) if forest.system is not None else "{" not in name


def _is_hosted(forest: Forest, uses: Iterable[BoundUse]) -> bool:
    """Whether the program that executes the trees sets the entry, as that of Nav2 does."""
    is_known = any(bound.use.name.removeprefix("@") in forest.host_entries for bound in uses)
    declared = (forest.known_node(bound.use.node) for bound in uses)
    return is_known and not any(node is not None and forest.is_machine(node) for node in declared)


def _is_output(forest: Forest, use: Use) -> bool:
    """Whether a use is an output port that the machine of the node never writes."""
    if forest.system is None or use.script or use.remaps or use.writes is not False:
        return False
    known = forest.known_node(use.node)
    port = known.port(use.port) if known is not None else None
    return port is not None and port.direction is Direction.OUT


def _is_of_library(use: Use) -> bool:
    """Whether a library has a node with this output port. A plugin in its place may omit unread outputs."""
    node = library_node(_name(use))
    port = node.port(use.port) if node is not None else None
    return port is not None and port.direction is Direction.OUT


def _is_outermost(forest: Forest, bound: BoundUse) -> bool:
    """Whether a use reads an entry, or passes it to a subtree, in the outermost tree that has a name for the entry."""
    use = bound.use
    if not bound.executed or use.script or not _is_valid(forest, use.name):
        return False
    if not (use.reads or use.remaps or _is_output(forest, use)):
        return False
    return use.name not in bound.frame.remapped and not _is_parameter(forest, use)


def _is_parameter(forest: Forest, use: Use) -> bool:
    """Whether the model of a subtree has a port for an entry; missing-port reports a port that is not set."""
    model = forest.subtree_models.get(use.tree) if forest.system is None else None
    port = model.port(use.name) if model is not None else None
    return port is not None and port.direction.reads


def _close(forest: Forest, name: str, known: Mapping[str, str]) -> tuple[str, ...]:
    """The written entries with similar names. Without a system, the name may be right."""
    if forest.system is not None:
        return close_names(name, known)
    near = nearest_name(name, known)
    return () if near is None else (near,)


def _only_written(uses: Iterable[BoundUse]) -> Use | None:
    """The place that writes an entry, if its name is written there and nothing reads the entry."""
    places = {bound.use: None for bound in uses}
    writers = [use for use in places if use.writes]
    is_read = any(use.reads is not False or use.remaps for use in places)
    return None if is_read or len(writers) != 1 or writers[0].script else writers[0]


def _only_unread(
    entries: Entries, names: Mapping[str, Mapping[str, str]], written: Collection[str], reader: BoundUse
) -> tuple[str, ...]:
    """The name of the only entry of a tree that a port of the same type writes and nothing reads, if `reader` is the
    only port of this type in the tree that reads an entry which nothing writes. Ports of a type that many ports have
    must also have the same name."""
    tree, type_ = reader.use.tree, reader.use.type
    lacking = {
        bound.use.name
        for key, uses in entries.by_entry.items()
        for bound in uses
        if key not in written and bound.use.tree == tree and bound.use.type == type_
    }
    if type_ == ANY or lacking != {reader.use.name}:
        return ()
    writers = {name: _only_written(entries.by_entry[key]) for name, key in names.get(tree, {}).items()}
    unread = [use for use in writers.values() if use is not None and use.tree == tree and use.type == type_]
    is_alike = len(unread) == 1 and (type_ not in SIMPLE_TYPES or unread[0].port == reader.use.port)
    return (unread[0].name,) if is_alike else ()


def _diverted(forest: Forest, entries: Entries, reader: Use) -> Use | None:
    """The only output port in the tree of `reader` that probably should write its entry: it has the type of the entry,
    but writes one that another node or the program writes, too. It also has the name of the entry, or its node reads
    and writes the same entry."""
    if reader.type == ANY:
        return None
    named: dict[Use, None] = {}
    in_place: dict[Use, None] = {}
    for uses in entries.by_entry.values():
        writers = {bound.use.node for bound in uses if bound.use.writes}
        if len(writers) < 2 and not (writers and _is_hosted(forest, uses)):
            continue
        readers = {bound.use.node for bound in uses if bound.use.reads and not bound.use.writes}
        for use in (bound.use for bound in uses):
            is_output = use.writes and not use.reads and not use.script and not use.remaps and not use.is_default
            if not is_output or use.tree != reader.tree or use.path != reader.path or use.type != reader.type:
                continue
            if use.port == reader.name != use.name:
                named[use] = None
            elif use.node in readers and use.node is not reader.node:
                in_place[use] = None
    found = list(named or in_place)
    return found[0] if len(found) == 1 else None


def _unwritten(forest: Forest, bound: BoundUse, close: tuple[str, ...]) -> Finding:
    use, certain = bound.use, forest.system is not None
    is_inner = is_of_subtree(forest, bound)
    remedy = "pass it to the subtree" if is_inner else "the program that runs the tree must set it"
    hint = did_you_mean(close) or ("" if certain else f"; {remedy}")
    fixes = () if use.is_default else replacements(use.span, tuple(f"{{{name}}}" for name in close))
    severity = Severity.ERROR if certain else Severity.WARNING if close or is_inner else Severity.INFORMATION
    variable = bound.variable.removeprefix(bound.frame.board)
    return RULE.at(use.span, f"no node writes {described(variable, use.name)}{hint}", *fixes, severity=severity)


def _unset(context: TreeContext, bound: BoundUse, entries: Entries) -> Finding | None:
    """The finding at a `<SubTree>` that does not set an entry of its tree, if another one does."""
    frame, name = bound.frame, bound.use.name
    if frame.use is None or frame.use.path != context.source.path or context.trees is None:
        return None
    other = next(
        (
            inner.frame
            for uses in entries.by_entry.values()
            for inner in uses
            if inner.frame is not frame and inner.frame.tree is frame.tree and name in inner.frame.remapped
        ),
        None,
    )
    node = node_at(context.file, frame.use)
    if other is None or other.use is None or node is None:
        return None
    message = (
        f"this `<SubTree>` does not set `{name}`, unlike another one of the tree `{bound.use.tree}`, in which no node "
        "writes it; set it"
    )
    setting = node_at(context.file, other.use) if other.use.path == context.source.path else None
    related = [Related(bound.use.span, f"`{name}` is needed here")]
    related += [Related(setting.element.name_span, "set here")] if setting is not None else []
    severity = Severity.ERROR if context.trees.system is not None else Severity.WARNING
    return RULE.at(node.element.name_span, message, severity=severity, related=related)


def _overwritten(writer: Use, reader: Use) -> Finding:
    """The finding at an output port that writes an entry of others, instead of the one of `reader`."""
    hint = did_you_mean((reader.name,))
    message = (
        f"`{writer.port}` overwrites {described(writer.name, writer.name)}, which is also written elsewhere, and no "
        f"node writes `{reader.name}`{hint}"
    )
    related = [Related(reader.span, f"`{reader.name}` is read here")]
    fixes = replacements(writer.span, (f"{{{reader.name}}}",))
    return RULE.at(writer.span, message, *fixes, severity=Severity.WARNING, related=related)


def _unread(writer: Use, reader: Use) -> Finding:
    hint = did_you_mean((reader.name,))
    message = f"no node reads {described(writer.name, writer.name)}, and no node writes `{reader.name}`{hint}"
    related = [Related(reader.span, f"`{reader.name}` is read here")]
    fixes = replacements(writer.span, (f"{{{reader.name}}}",))
    return RULE.at(writer.span, message, *fixes, severity=Severity.WARNING, related=related)


def _name(use: Use) -> str:
    return use.node.plugin.value if use.node.plugin is not None else ""


RULE = Rule("blackboard-never-written", Severity.ERROR, "A blackboard variable is read but never written.", tree=check)
