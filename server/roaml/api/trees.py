# SPDX-License-Identifier: Apache-2.0
"""Trees without a system, with mocks for their leaves."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

from roaml.api.checking import CheckResult
from roaml.api.jani_files import PathError
from roaml.api.reading import read
from roaml.api.systems import ModelError
from roaml.diagnostics import Diagnostic, Severity
from roaml.model.kinds import FileKind
from roaml.project.paths import resolve
from roaml.project.settings import Settings
from roaml.record import Record, replace

if TYPE_CHECKING:
    from roaml.forest.forest import Forest
    from roaml.lower.programs.refusal import TreeRefusal
    from roaml.mocks.network import MockedTree, MockOptions
    from roaml.mocks.proposal import MockableLeaf
    from roaml.project.workspace import Snapshot
    from roaml.verification.target import VerificationTarget


UNTRANSLATABLE = "untranslatable-tree"
"""The code of the diagnostic with the reason why a tree without errors cannot be translated."""


class LoadedTree(Record, frozen=True, eq=False):
    """A tree with mocks, and the model of both. The properties of the model are `succeeds` and `fails`."""

    mocked: MockedTree
    target: VerificationTarget


def load_tree(
    path: str,
    options: MockOptions,
    settings: Settings | None = None,
    texts: Mapping[str, str | bytes] | None = None,
) -> LoadedTree:
    """Read, check and translate a tree without a system.

    Args:
        path: the file of the tree.
        options: its mocks and parameters.
        settings, texts: as for `check`.

    Raises:
        PathError: the path cannot be read, or is not a file of trees.
        ModelError: the trees have errors, or the executed tree cannot be translated.
        MissingMocksError: leaves have no mock.
    """

    return loaded_tree(read([path], settings=settings, texts=texts).snapshot, os.path.abspath(path), options)


def loaded_tree(snapshot: Snapshot, path: str, options: MockOptions) -> LoadedTree:
    """A tree without a system, from a workspace.

    Args:
        path: the absolute path of the file of the tree.
        options: as for `load_tree`.

    Raises:
        PathError: the path is not a file of trees.
        ModelError, MissingMocksError: as for `load_tree`.
        MockError: the data of a duration cannot be read.
    """
    from roaml.lower.programs.refusal import TreeRefusal  # noqa: PLC0415
    from roaml.mocks.network import mocked  # noqa: PLC0415 - a check starts faster without these
    from roaml.project.mock_files import with_data  # noqa: PLC0415
    from roaml.to_jani import translate  # noqa: PLC0415
    from roaml.verification.target import target_of  # noqa: PLC0415
    from roaml.verification.tree_outcome import tree_properties  # noqa: PLC0415

    forest = _forest(snapshot, path)
    data = tuple(dict.fromkeys(resolve(path, mock.data_file) for mock in options.mocks if mock.data_file))
    options = replace(options, mocks=with_data(snapshot.analysis, path, options.mocks))
    try:
        tree = mocked(forest, options)
    except TreeRefusal as refusal:
        raise _untranslatable(snapshot, path, refusal) from None
    model = translate(tree.network)
    model = replace(model, properties=tree_properties(tree.tree.root))
    files = (*(file for file, _ in forest.files), *data)
    return LoadedTree(tree, target_of(model, path, files, snapshot.analysis.source))


def propose_mocks(
    path: str, settings: Settings | None = None, texts: Mapping[str, str | bytes] | None = None
) -> tuple[MockableLeaf, ...]:
    """The leaves of a tree without a system whose behaviour a mock determines, each with a proposed mock and the reason
    for it. `roaml.mocks.proposal.proposed_text` writes them as a file.

    Args:
        path, settings, texts: as for `load_tree`.

    Raises:
        PathError, ModelError: as for `load_tree`.
    """
    from roaml.lower.programs.refusal import TreeRefusal  # noqa: PLC0415
    from roaml.mocks.proposal import mockable_leaves  # noqa: PLC0415
    from roaml.project.mock_files import mocks_beside  # noqa: PLC0415

    snapshot, full = read([path], settings=settings, texts=texts).snapshot, os.path.abspath(path)
    try:
        return mockable_leaves(_forest(snapshot, full), mocks_beside(snapshot.analysis, full))
    except TreeRefusal as refusal:
        raise _untranslatable(snapshot, full, refusal) from None


def _forest(snapshot: Snapshot, path: str) -> Forest:
    analysis = snapshot.analysis
    forest = analysis.forest(path)
    if forest is None or analysis.kind(path) is not FileKind.TREE:
        raise PathError(f"{path}: not a file of behavior trees")
    diagnostics = snapshot.checker.diagnostics(path)
    errors = tuple(diagnostic for diagnostic in diagnostics if diagnostic.severity is Severity.ERROR)
    if errors:
        raise ModelError(CheckResult(errors, (path,), (), snapshot))
    return forest


def _untranslatable(snapshot: Snapshot, path: str, refusal: TreeRefusal) -> ModelError:
    """The error for a tree that cannot be translated."""
    from roaml.lower.programs.refusal import place_in  # noqa: PLC0415 - trees without errors do not need it

    def reason(refusal: TreeRefusal) -> Diagnostic:
        origin = refusal.origin
        source = snapshot.analysis.source(origin.path)
        span = origin.span if source is None else place_in(source.text, refusal)
        return Diagnostic(origin.path, UNTRANSLATABLE, Severity.ERROR, span, refusal.reason, source=source)

    reasons = tuple(map(reason, refusal.all))
    return ModelError(CheckResult(reasons, (path,), (), snapshot), tuple(reason.unset for reason in refusal.all))
