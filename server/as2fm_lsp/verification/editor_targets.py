# SPDX-License-Identifier: Apache-2.0
"""What is verified for a file in the editor: a system, or a tree that belongs to no system, with its mocks."""

from __future__ import annotations

import os

from as2fm_lsp.context import Context
from as2fm_lsp.mocked_models import count_of_nodes, keep_proposal
from roaml import api
from roaml.api.trees import loaded_tree
from roaml.ide.verifiable import Texts, expected_beside, fingerprint
from roaml.mocks.mock import Mock, read_mocks
from roaml.mocks.network import MissingMocksError, MockOptions
from roaml.model.kinds import mocks_path
from roaml.project.analysis import Analysis
from roaml.project.mock_files import executed_tree
from roaml.project.workspace import Snapshot
from roaml.record import Record, replace
from roaml.verification.target import VerificationTarget


class EditorTarget(Record, frozen=True, eq=False):
    """The model of a file in the editor.

    Attributes:
        analysis: that of the texts that were translated.
        target: the model, with the expectations of the files, the configuration and the client.
        texts: the digests of the texts.
        note: what was done to translate the model, as a sentence; "" if nothing.
    """

    analysis: Analysis
    target: VerificationTarget
    texts: Texts
    note: str = ""


def editor_target(context: Context, path: str) -> EditorTarget:
    """The model of the system or tree in a file. Mocks that a tree lacks are proposed and kept.

    Raises:
        ModelError: it has errors, or cannot be translated.
        PathError: the file is neither a system nor a tree without a system.
        MockError: the mocks of the tree are not valid.
    """
    snapshot = context.session.moment().snapshot(path)
    if executed_tree(snapshot.analysis, path) is not None:
        found = _tree(context, snapshot, path)
    else:
        system = api.loaded(snapshot, path)
        texts = fingerprint(system.analysis, path)
        target = context.results.target(texts) or api.as_target(system)
        found = EditorTarget(system.analysis, target, texts)
    context.results.keep_target(found.texts, found.target)
    target = replace(found.target, expectations=()).expecting(expected_beside(found.analysis, path))
    return replace(found, target=target.expecting(context.session.settings_of(path).expectations))


def _tree(context: Context, snapshot: Snapshot, path: str) -> EditorTarget:
    texts = fingerprint(snapshot.analysis, path)
    known = context.results.target(texts)
    if known is not None:
        return EditorTarget(snapshot.analysis, known, texts)
    source = snapshot.analysis.source(mocks_path(path))
    mocks = read_mocks(source.text) if source is not None else ()
    settings = context.session.settings_of(path)
    options = MockOptions(mocks, reaction_time=settings.reaction_time)
    try:
        return EditorTarget(snapshot.analysis, loaded_tree(snapshot, path, options).target, texts)
    except MissingMocksError as missing:
        proposed: tuple[Mock, ...] = tuple(leaf.proposed for leaf in missing.mockable if leaf.mock is None)
        target = loaded_tree(snapshot, path, replace(options, mocks=mocks + proposed)).target
        note = _kept(context, path, missing)
        analysis = context.session.moment().snapshot(path).analysis
        return EditorTarget(analysis, target, fingerprint(analysis, path), note)


def _kept(context: Context, path: str, missing: MissingMocksError) -> str:
    """Keep the proposal in the file beside the tree, unless the user edits this file; return what was done."""
    beside = mocks_path(path)
    name, leaves = os.path.basename(beside), count_of_nodes(missing.leaves)
    if context.session.text(beside) is not None:
        return f"{leaves} without a mock in {name}: proposed values were used."
    try:
        keep_proposal(path, missing.mockable)
    except OSError as error:
        return (
            f"Proposed mocks were used for {leaves}; they could not be written into {name}: {error.strerror or error}."
        )
    context.session.refresh()
    return f"Proposed mocks for {leaves} are in {name}: review their values."
