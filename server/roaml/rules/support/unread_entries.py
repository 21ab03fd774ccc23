# SPDX-License-Identifier: Apache-2.0
"""Entries that are written and never read, although the trees show which entry should have been written or read.

The program that executes the trees may read any entry, so an unread entry alone is no mistake.
"""

from __future__ import annotations

import functools
import itertools
from collections import defaultdict
from collections.abc import Mapping

from roaml.forest.cpp_types import ANY
from roaml.forest.entries import BoundUse, Entries, Use
from roaml.forest.forest import Forest
from roaml.model.expand import Frame, node_at
from roaml.model.tree import PortSetting
from roaml.record import Record
from roaml.rules.support.constant_entries import constant_entries
from roaml.rules.support.entries import entries_of
from roaml.suggest import nearest_name

MAX_COMPARED = 300
"""The maximum number of entries with whose names that of an unread entry is compared, so that the time is linear."""


class Unread(Record, frozen=True, eq=False):
    """An entry that is written but never read.

    Attributes:
        writer: the place that writes it.
        meant: the entry that should probably be written instead; `None` if it is not known.
        value: the number that the entry `meant` always has, because nothing else changes it.
        reader: the attribute that should probably read the entry, with the path of its file; `None` if it is not known.
    """

    writer: BoundUse
    meant: str | None = None
    value: float = 0
    reader: tuple[str, PortSetting] | None = None


@functools.lru_cache(maxsize=1)
def unread_entries(forest: Forest) -> Mapping[str, Unread]:
    """Key of an entry -> why it should be read, or another one be written. The result for the last forest is cached,
    because several rules need it."""
    entries = entries_of(forest)
    search = _Search(forest, entries)
    found: dict[str, Unread] = {}
    for key, uses in entries.by_entry.items():
        first = uses[0]
        is_hosted = first.use.name.removeprefix("@") in forest.host_entries
        if is_hosted or not all(bound.executed and _only_writes(bound.use) for bound in uses):
            continue
        unread = search.misspelled(first) or search.passed_over(uses)
        if unread is not None:
            found[key] = unread
    return found


def _only_writes(use: Use) -> bool:
    return bool(use.writes) and use.reads is False and not (use.into or use.is_default)


class _Search:
    """Finds the entries that unread ones stand for. What many unread entries are compared with is collected once, so
    that the time is linear."""

    def __init__(self, forest: Forest, entries: Entries) -> None:
        self._forest = forest
        self._files = dict(forest.files)
        self._constant: dict[Frame, dict[str, str]] = defaultdict(dict)
        for key in constant_entries(forest):
            for bound in entries.by_entry[key]:
                if bound.use.reads or bound.use.remaps:
                    self._constant[bound.frame][bound.use.name] = key
        self._readers: dict[str, list[BoundUse]] = defaultdict(list)
        for bound in (bound for uses in entries.by_entry.values() for bound in uses):
            if bound.use.reads and not bound.use.writes and not bound.use.script:
                self._readers[bound.use.port].append(bound)

    def misspelled(self, writer: BoundUse) -> Unread | None:
        """The finding that an entry has nearly the name of one that is read and always has the same value."""
        constant = self._constant.get(writer.frame)
        name = nearest_name(writer.use.name, itertools.islice(constant, MAX_COMPARED)) if constant else None
        if constant is None or name is None:
            return None
        return Unread(writer, name, constant_entries(self._forest)[constant[name]].value)

    def passed_over(self, uses: tuple[BoundUse, ...]) -> Unread | None:
        """The finding that a node has an input port with the name of an entry that only an output port of another node
        writes, but reads a different entry."""
        writer = uses[0]
        if self._forest.system is not None or len({bound.use for bound in uses}) > 1 or writer.use.script:
            return None
        readers: dict[PortSetting, str] = {}
        for bound in self._readers.get(writer.use.name, ()):
            if ANY in (bound.use.type, writer.use.type) or bound.use.type == writer.use.type:
                place = self._place_in(bound, writer.frame)
                if place is not None:
                    readers[place[1]] = place[0]
        entry = writer.use.name
        others = {setting: path for setting, path in readers.items() if entry not in (setting.variable or entry)}
        if len(others) != 1 or len(readers) != 1:
            return None
        ((setting, path),) = others.items()
        return Unread(writer, reader=(path, setting))

    def _place_in(self, reader: BoundUse, frame: Frame) -> tuple[str, PortSetting] | None:
        """The path of the file, and the attribute, with which a tree passes an entry to a reader in it, or in a subtree
        of it; `None` if the tree does not."""
        name, node, path, current = reader.use.port, reader.use.node, reader.use.path, reader.frame
        inner = reader.use.name
        while current is not frame:
            source = current.use
            if source is None or current.outer is None or inner not in current.remapped:
                return None
            called = node_at(self._files[source.path], source)
            setting = next((s for s in called.ports if s.key.value == inner), None) if called is not None else None
            if called is None or setting is None or setting.variable is None:
                return None
            name, node, path, inner, current = inner, called, source.path, setting.variable, current.outer
        setting = next((s for s in node.ports if s.key.value == name), None)
        return None if setting is None else (path, setting)
