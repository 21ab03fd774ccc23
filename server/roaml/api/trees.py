# SPDX-License-Identifier: Apache-2.0
"""Trees without a system, with mocks for their leaves."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

from roaml.api.checking import check
from roaml.api.jani_files import PathError
from roaml.api.systems import ModelError
from roaml.diagnostics import Diagnostic, Severity
from roaml.model.kinds import FileKind
from roaml.project.settings import Settings
from roaml.record import Record, replace

if TYPE_CHECKING:
    from roaml.mocks.network import MockedTree, MockOptions
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
    from roaml.lower.programs.refusal import TreeRefusal  # noqa: PLC0415
    from roaml.mocks.network import mocked  # noqa: PLC0415 - a check starts faster without these
    from roaml.to_jani import translate  # noqa: PLC0415
    from roaml.verification.target import target_of  # noqa: PLC0415
    from roaml.verification.tree_outcome import tree_properties  # noqa: PLC0415

    result = check([path], settings=settings, texts=texts)
    analysis = result.snapshot.analysis
    full = os.path.abspath(path)
    forest = analysis.forest(full)
    if forest is None or analysis.kind(full) is not FileKind.TREE:
        raise PathError(f"{path}: not a file of behavior trees")
    errors = tuple(diagnostic for diagnostic in result.diagnostics if diagnostic.severity is Severity.ERROR)
    if errors:
        raise ModelError(replace(result, diagnostics=errors))
    try:
        tree = mocked(forest, options)
    except TreeRefusal as refusal:
        origin = refusal.origin
        source = analysis.source(origin.path)
        reason = Diagnostic(origin.path, UNTRANSLATABLE, Severity.ERROR, origin.span, refusal.reason, source=source)
        raise ModelError(replace(result, diagnostics=(reason,))) from None
    model = translate(tree.network)
    model = replace(model, properties=tree_properties(tree.tree.root))
    files = tuple(file for file, _ in forest.files)
    return LoadedTree(tree, target_of(model, full, files, analysis.source))
