# SPDX-License-Identifier: Apache-2.0
"""A system with mocks as the subject of `verify` and `simulate`."""

from __future__ import annotations

import argparse
from collections.abc import Mapping

from as2fm_lsp.cli.mock_arguments import missing_mocks, mocks_in
from as2fm_lsp.cli.output import complain
from roaml.api.mocked_systems import mock_system
from roaml.project.settings import Settings


def mocked_texts(options: argparse.Namespace, settings: Settings) -> Mapping[str, str]:
    """The texts of the system's files with the mocks that the arguments declare. A summary is written to standard
    error.

    Raises:
        MockError: a mock is not valid, or leaves have none.
        PathError: the path is not a system file.
    """
    mocked = mock_system(options.main, mocks_in(options), options.ros_path, settings)
    if mocked.missing:
        raise missing_mocks(options.main, mocked.missing)
    for mock in mocked.unused:
        complain(f"the mock `{mock.pattern}` matches no node of the tree")
    leaves = len(mocked.planned)
    parts = [f"{leaves} {'type' if leaves == 1 else 'types'} of leaves"]
    if mocked.events:
        parts.append(f"{mocked.events} {'node' if mocked.events == 1 else 'nodes'} that depend on random events")
    complain(f"with mocks for {' and '.join(parts)}")
    return mocked.texts
