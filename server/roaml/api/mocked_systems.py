# SPDX-License-Identifier: Apache-2.0
"""Systems whose trees have leaves without plugins, with mocks for these leaves (docs/spec/mocks.md#systems)."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from roaml.api.checking import check
from roaml.api.jani_files import PathError
from roaml.model.kinds import FileKind
from roaml.project.settings import Settings
from roaml.record import Record

if TYPE_CHECKING:
    from roaml.mocks.mock import Mock
    from roaml.mocks.system_mocks import PlannedMock


class SystemMocks(Record, frozen=True):
    """The mocks for a system.

    Attributes:
        texts: the changed system and tree files and the new plugins, by path; `load` and `target` accept them.
        planned: the new plugins.
        missing: the types of the leaves that have neither a plugin nor a matching mock.
        events: the number of nodes that read an event of the world, such as a new goal, and have a mock for it.
        unused: the mocks that match no node.
    """

    texts: Mapping[str, str]
    planned: tuple[PlannedMock, ...]
    missing: tuple[str, ...]
    events: int
    unused: tuple[Mock, ...]


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
        PathError: the path cannot be read, is not a system file, or the system has several trees.
    """
    from roaml.mocks.mock import unused  # noqa: PLC0415 - a check starts faster without these
    from roaml.mocks.system_mocks import defaults, event_edits, listing, plan  # noqa: PLC0415
    from roaml.project.system_leaves import missing_leaves, plugin_paths  # noqa: PLC0415
    from roaml.text import apply_edits  # noqa: PLC0415

    analysis = check([path], ros_paths, settings, texts).snapshot.analysis
    main = os.path.abspath(path)
    system, document = analysis.system(main), analysis.document(main)
    if analysis.kind(main) is not FileKind.SYSTEM or system is None or document is None or document.root is None:
        raise PathError(f"{path}: not a system file")
    if len(system.roots) > 1:
        raise PathError(f"{path}: the leaves of a system with several trees cannot be mocked; write plugins for them")
    leaves = missing_leaves(analysis, system)
    paths = plugin_paths(analysis, main, [leaf.type for leaf in leaves])
    planned, missing = plan(leaves, mocks, Fraction(str(system.parameters.tick_rate)), paths)
    changed = {mock.path: mock.text for mock in planned}
    edits = event_edits(system, {p: tree for p in system.tree_paths if (tree := analysis.tree(p))}, mocks)
    events = sum(map(len, edits.values()))
    section = document.root.find("behavior_tree")
    if planned and section is not None:
        edits.setdefault(main, []).append(listing(section, [os.path.basename(mock.path) for mock in planned]))
    tree = analysis.tree(system.tree_paths[0]) if system.tree_paths else None
    given = defaults(tree.element, [mock.leaf for mock in planned]) if tree is not None else None
    if given is not None:
        edits.setdefault(system.tree_paths[0], []).append(given)
    for file, changes in edits.items():
        source = analysis.source(file)
        assert source is not None
        changed[file] = apply_edits(source.text, tuple(changes))
    nodes = [(name, leaf.type) for leaf in leaves for name in leaf.names]
    nodes += [(instance.name, instance.plugin) for instance in system.instances]
    return SystemMocks(changed, tuple(planned), tuple(leaf.type for leaf in missing), events, unused(mocks, nodes))
