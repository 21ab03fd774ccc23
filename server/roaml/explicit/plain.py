# SPDX-License-Identifier: Apache-2.0
"""The kernel as plain Python where it is compiled, but the modules that read its data are not."""

from __future__ import annotations

import importlib.util
from functools import cache
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

import roaml.smc


@cache
def plain_kernel() -> ModuleType:
    """The module of the kernel, whether it was compiled or not."""
    return _loaded("plain_kernel", Path(roaml.smc.__file__).with_name("kernel.py"))


@cache
def plain_search() -> ModuleType:
    """The module of the search, whether it was compiled or not."""
    return _loaded("plain_search", Path(__file__).with_name("search.py"))


@cache
def plain_solver() -> ModuleType:
    """The module of the solver, whether it was compiled or not; what it uses is plain Python, too."""
    module = _loaded("plain_solver", Path(__file__).with_name("solver.py"))
    elimination = _loaded("plain_elimination", Path(__file__).with_name("elimination.py"))
    module.SmallProcess = elimination.SmallProcess  # type: ignore[attr-defined]
    return module


def _loaded(name: str, path: Path) -> ModuleType:
    loader = SourceFileLoader(name, str(path))
    spec = importlib.util.spec_from_loader(name, loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module
