# SPDX-License-Identifier: Apache-2.0
"""Loads systems of the conformance cases."""

from __future__ import annotations

from pathlib import Path

from conformance import INTERFACES
from roaml import api
from roaml.model.parameters import Overrides, TreeSemantics


def load(path: Path, *, as_reference: bool = False) -> api.LoadedSystem:
    """A system of the cases. With `as_reference`, the nodes of its tree mean what they mean in AS2FM."""
    overrides = Overrides(semantics=TreeSemantics.AS2FM if as_reference else None)
    return api.load(str(path), [str(INTERFACES)], overrides=overrides)
