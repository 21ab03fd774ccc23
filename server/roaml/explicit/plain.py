# SPDX-License-Identifier: Apache-2.0
"""The kernel, the search and the solver as plain Python, for installations in which only some of them are compiled."""

from __future__ import annotations

import importlib.util
import sys
from functools import cache
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

import roaml.smc
from roaml.smc import packing


@cache
def plain_kernel() -> ModuleType:
    """The module of the kernel as plain Python, even if the kernel is compiled."""
    return plain_module("plain_kernel", Path(roaml.smc.__file__).with_name("kernel.py"))


@cache
def plain_counts() -> ModuleType:
    """The module that counts results as plain Python, even if it is compiled."""
    return plain_module("plain_counts", Path(roaml.smc.__file__).with_name("counts.py"))


@cache
def plain_packing() -> ModuleType:
    """The module of packed states as plain Python, even if it is compiled. It needs a plain kernel."""
    return plain_module("plain_packing", Path(roaml.smc.__file__).with_name("packing.py"))


@cache
def plain_states() -> ModuleType:
    """The module of the nodes as plain Python, even if it is compiled. It needs a plain kernel."""
    return _on_plain_packing("plain_states", Path(roaml.smc.__file__).with_name("states.py"))


@cache
def plain_search() -> ModuleType:
    """The module of the search as plain Python, even if the search is compiled. It needs a plain kernel."""
    return _on_plain_packing("plain_search", Path(__file__).with_name("search.py"))


@cache
def plain_ample() -> ModuleType:
    """The module of ample sets as plain Python, even if it is compiled."""
    return plain_module("plain_ample", Path(__file__).with_name("ample.py"))


@cache
def plain_chain() -> ModuleType:
    """The module of sparse elimination as plain Python, even if it is compiled."""
    return plain_module("plain_chain", Path(__file__).with_name("chain.py"))


@cache
def plain_solver() -> ModuleType:
    """The module of the solver as plain Python, even if the solver is compiled. It uses `elimination` and `chain` as
    plain Python, too."""
    module = plain_module("plain_solver", Path(__file__).with_name("solver.py"))
    elimination = plain_module("plain_elimination", Path(__file__).with_name("elimination.py"))
    elimination.Chain = plain_chain().Chain  # type: ignore[attr-defined]
    module.SmallProcess = elimination.SmallProcess  # type: ignore[attr-defined]
    return module


def _on_plain_packing(name: str, path: Path) -> ModuleType:
    """A module whose class inherits from `PackedStates` as plain Python."""
    plain = plain_packing()
    sys.modules[packing.__name__] = plain
    try:
        return plain_module(name, path)
    finally:
        sys.modules[packing.__name__] = packing


def plain_module(name: str, path: Path) -> ModuleType:
    """The module in a file, as plain Python even if it is compiled."""
    loader = SourceFileLoader(name, str(path))
    spec = importlib.util.spec_from_loader(name, loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module
