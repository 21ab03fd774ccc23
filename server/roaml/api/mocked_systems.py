# SPDX-License-Identifier: Apache-2.0
"""Systems whose trees have leaves without plugins, with mocks for these leaves (docs/spec/mocks.md#systems)."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from roaml.api.jani_files import PathError
from roaml.api.reading import read
from roaml.model.kinds import FileKind
from roaml.project.settings import Settings
from roaml.record import Record

if TYPE_CHECKING:
    from roaml.mocks.mock import Mock, MockableWords
    from roaml.mocks.system_mocks import PlannedMock


class SystemMocks(Record, frozen=True):
    """The mocks for a system.

    Attributes:
        texts: the changed system and tree files and the new plugins, by path; `load` and `target` accept them.
        planned: the new plugins.
        missing: the types of the leaves that have neither a plugin nor a matching mock.
        events: the number of nodes that read an event of the world, such as a new goal, and have a mock for it.
        words: what mocks can call the nodes.
    """

    texts: Mapping[str, str]
    planned: tuple[PlannedMock, ...]
    missing: tuple[str, ...]
    events: int
    words: MockableWords


def mock_system(
    path: str,
    mocks: Sequence[Mock],
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    texts: Mapping[str, str | bytes] | None = None,
) -> SystemMocks:
    """Create mocks for the leaves of a system that have no plugin. No file is written.

    Args:
        settings, ros_paths, texts: as for `check`.

    Raises:
        PathError: the path cannot be read, or is not a system file.
        MockError: a mock cannot be used for the nodes that it matches.
    """
    from roaml.mocks.system_mocks import (  # noqa: PLC0415 - a check starts faster without these
        all_defaults,
        check_likenesses,
        event_edits,
        inputs,
        listing,
        mockable_words,
        plan,
    )
    from roaml.project.mock_files import with_data  # noqa: PLC0415
    from roaml.project.system_leaves import missing_leaves, plugin_paths, tick_rates  # noqa: PLC0415
    from roaml.text import apply_edits  # noqa: PLC0415

    analysis = read([path], ros_paths, settings, texts).snapshot.analysis
    main = os.path.abspath(path)
    system, document = analysis.system(main), analysis.document(main)
    if analysis.kind(main) is not FileKind.SYSTEM or system is None or document is None or document.root is None:
        raise PathError(f"{path}: not a system file")
    check_likenesses(system, mocks)
    mocks = with_data(analysis, main, mocks)
    leaves = missing_leaves(analysis, system)
    planned, missing = plan(leaves, mocks, tick_rates(system), plugin_paths(analysis, main))
    changed = {mock.path: mock.text for mock in planned}
    edits = event_edits(system, {p: tree for p in system.tree_paths if (tree := analysis.tree(p))}, mocks)
    events = sum(map(len, edits.values()))
    section = document.root.find("behavior_tree")
    if planned and section is not None:
        names = {tree.name for tree in system.trees}
        entries = [entry for mock in planned for entry in inputs(mock, os.path.basename(mock.path), names)]
        edits.setdefault(main, []).append(listing(section, entries))
    roots = {p: tree.element for p in system.tree_paths if (tree := analysis.tree(p)) is not None}
    for file, edit in all_defaults(system, roots.get, planned).items():
        edits.setdefault(file, []).append(edit)
    for file, changes in edits.items():
        source = analysis.source(file)
        assert source is not None
        changed[file] = apply_edits(source.text, tuple(changes))
    return SystemMocks(
        changed, tuple(planned), tuple(leaf.type for leaf in missing), events, mockable_words(system, leaves)
    )
