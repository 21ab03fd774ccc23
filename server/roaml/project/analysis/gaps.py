# SPDX-License-Identifier: Apache-2.0
"""The facts that a system may contain in files or parts of files that cannot be read."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from roaml.language import BEHAVIOR_TREE
from roaml.model.expand import StrayRemap, TreeFileOutline, is_whole, node_at, stray_remaps
from roaml.model.gaps import Gap, GapAct, InterfaceAct, PlacedGap
from roaml.model.kinds import MACHINE_EXTENSIONS, PROJECT_EXTENSION, FileKind
from roaml.model.system_file import ListedFile, SystemFile, SystemSection, are_named
from roaml.model.tree import blackboard_variable
from roaml.project.analysis.machines import Machines
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.systems import Systems
from roaml.project.analysis.tree_files import TreeFiles
from roaml.suggest import close_names
from roaml.text import Span


class Gaps:
    """The gaps of systems. An error in one file must not cause findings in the others."""

    def __init__(self, sources: SourceFiles, tree_files: TreeFiles, systems: Systems, machines: Machines) -> None:
        self._sources = sources
        self._tree_files = tree_files
        self._systems = systems
        self._machines = machines
        self._gaps: dict[str, tuple[tuple[str, PlacedGap], ...]] = {}

    def gaps(self, path: str) -> tuple[tuple[str, PlacedGap], ...]:
        """The facts that a system file, its trees and the unreadable files may contain. Each one has the path of its
        cause."""
        if path not in self._gaps:
            file = self._sources.system_file(path)
            self._gaps[path] = tuple(self._find_gaps(path, file, self._systems.listed(path))) if file else ()
        return self._gaps[path]

    def _find_gaps(
        self, path: str, file: SystemFile, listed: tuple[ListedFile, ...]
    ) -> Iterator[tuple[str, PlacedGap]]:
        root = file.element.name_span
        broken = self._sources.broken_at(path)
        if broken is not None:
            yield path, PlacedGap(Gap(GapAct.ANYTHING), broken)
        if SystemSection.NODE_MODELS in file.unread:
            yield path, PlacedGap(Gap(GapAct.ANYTHING), root)
        if SystemSection.BEHAVIOR_TREE in file.unread:
            yield path, PlacedGap(Gap(GapAct.NODE), root)
        for entry in listed:
            if entry.input.section is SystemSection.NODE_MODELS and not entry.usable:
                yield from ((path, PlacedGap(gap, entry.span)) for gap in self._of_missing_node(path, entry, listed))
        yield from ((path, PlacedGap(Gap(GapAct.ANYTHING), span)) for span in _unclear_trees(listed))
        yield from ((place, PlacedGap(Gap(GapAct.NODE), span)) for place, span in self._tree_gaps(path, file, listed))
        trees = tuple(dict.fromkeys(tree.files for tree in self._systems.executed_trees(path)))
        for stray in self._sources.memo.get("stray remaps", path, trees, partial(_stray_remaps, trees)):
            tree = self._sources.tree(stray.source.path)
            node = node_at(tree, stray.source) if tree else None
            key = next((s.key.span for s in node.ports if s.key.value == stray.key), None) if node else None
            outer = blackboard_variable(stray.outer)
            for name in (*stray.meant[:1], *((outer,) if outer and stray.meant else ())):
                if key is not None:
                    yield stray.source.path, PlacedGap(Gap(GapAct.REMAP, name), key)

    def _of_missing_node(self, system: str, missing: ListedFile, listed: tuple[ListedFile, ...]) -> Iterator[Gap]:
        """The facts of a ROS node whose file cannot be used: those of the file with the most similar name in the same
        folder; any fact if there is no such file."""
        taken = {file.path for file in listed}
        beside = [
            p for end in MACHINE_EXTENSIONS for p in self._sources.files.beside(missing.path, end) if p not in taken
        ]
        by_name = {_stem(p): p for p in beside}
        close = close_names(_stem(missing.path), by_name, 1) if missing.path else ()
        similar = by_name[close[0]] if close else ""
        if not similar or self._sources.machine(similar) is None:
            yield Gap(GapAct.ANYTHING)
            return
        outline = self._machines.outline(similar, system, self._machines.structs(system), {})
        yield from outline.gaps
        yield from (Gap(InterfaceAct(use.kind), use.name or None) for use in outline.interfaces)
        yield from (Gap(GapAct.SENDS, sent.event) for sent in outline.sent)
        yield from (Gap(GapAct.RECEIVES, received.event) for received in outline.received)

    def _tree_gaps(self, path: str, file: SystemFile, listed: tuple[ListedFile, ...]) -> Iterator[tuple[str, Span]]:
        """The positions (path and span) of the errors because of which some nodes of the executed tree are unknown."""
        listed_trees = [f for f in listed if f.required_kind is FileKind.TREE]
        section = file.element.find(SystemSection.BEHAVIOR_TREE.value)
        if not listed_trees:
            if section is not None:
                yield path, section.name_span
            return
        yield from ((path, file.span) for file in listed_trees if not file.usable)
        paths = self._systems.tree_paths(path)
        clear = True
        for tree_path in paths:
            tree, broken = self._sources.tree(tree_path), self._sources.broken_at(tree_path)
            assert tree is not None
            spans = [] if broken is None else [broken]
            spans += [misfit.element.name_span for misfit in self._sources.misfits(tree_path, BEHAVIOR_TREE)]
            spans += [behavior_tree.element.name_span for behavior_tree in tree.trees if len(behavior_tree.roots) != 1]
            for include in () if tree_path.endswith(PROJECT_EXTENSION) else tree.includes:
                target = self._tree_files.include_path(tree_path, include)
                if include.path and (target is None or self._sources.tree(target) is None):
                    spans.append(include.path.span)
            clear = clear and not spans
            yield from ((tree_path, span) for span in spans)
        if clear and paths:
            for files in dict.fromkeys(listed.files for listed in self._systems.executed_trees(path)):
                first = self._sources.tree(files[0].path)
                assert first is not None
                if not self._sources.memo.get("whole tree", (path, files[0].path), files, partial(is_whole, files)):
                    yield files[0].path, first.element.name_span


def _unclear_trees(listed: tuple[ListedFile, ...]) -> Iterator[Span]:
    """The inputs because of which the plugins of some trees are unknown: trees without a name of their own, and plugins
    of trees that do not exist."""
    trees = [file for file in listed if file.required_kind is FileKind.TREE]
    if not are_named(listed):
        yield trees[-1].input.element.name_span
    names = {file.input.tree for file in trees}
    for file in listed:
        if file.required_kind is FileKind.MACHINE and file.input.tree and file.input.tree not in names:
            yield file.input.element.name_span


def _stray_remaps(trees: tuple[tuple[TreeFileOutline, ...], ...]) -> tuple[StrayRemap, ...]:
    return tuple(dict.fromkeys(stray for files in trees for stray in stray_remaps(files)))


def _stem(path: str) -> str:
    """The name of a file without its extension."""
    return path.replace("\\", "/").rpartition("/")[2].rpartition(".")[0]
