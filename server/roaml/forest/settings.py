# SPDX-License-Identifier: Apache-2.0
"""Settings for behavior trees."""

from __future__ import annotations

from roaml.libraries.version import NEWEST_VERSION, Version
from roaml.model.parameters import TreeSemantics
from roaml.record import Record


class TreeSettings(Record, frozen=True):
    """The user's settings.

    Attributes:
        models: the paths of files with models of nodes, in addition to those that trees include.
        libraries: the names of the libraries whose nodes are available in addition to those that the trees use.
        version: the version of BehaviorTree.CPP.
        semantics: whose meaning nodes have in systems that do not state it.
    """

    models: tuple[str, ...] = ()
    libraries: tuple[str, ...] = ()
    version: Version = NEWEST_VERSION
    semantics: TreeSemantics | None = None


NEWEST = TreeSettings()
