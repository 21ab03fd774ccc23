# SPDX-License-Identifier: Apache-2.0
"""Whether the model checker of this installation is compiled from its current sources, and how to compile it."""

from __future__ import annotations

import importlib.util
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import roaml

SLOWER = "12 to 37 times slower"
"""The measured difference between plain Python and the compiled kernel (docs/performance.md)."""


def is_compiled() -> bool:
    """Whether the kernel is an extension module. The module is not loaded."""
    spec = importlib.util.find_spec("roaml.smc.kernel")
    return spec is not None and not (spec.origin or "").endswith(".py")


def outdated_modules(package: Path = Path(roaml.__file__).parent) -> list[str]:
    """The compiled modules that are older than their sources in a checkout that was updated and not installed again.
    They may fail or have wrong results. In other installations, the times of files are those of the installation."""
    if not (package.parents[1] / "setup.py").is_file():
        return []
    suffix = EXTENSION_SUFFIXES[0]
    return [
        f"{package.name}.{path.parent.name}.{path.name.removesuffix(suffix)}"
        for path in sorted(package.glob(f"*/*{suffix}"))
        if _is_newer(path.with_name(path.name.removesuffix(suffix) + ".py"), path)
    ]


def _is_newer(source: Path, compiled: Path) -> bool:
    return source.is_file() and source.stat().st_mtime > compiled.stat().st_mtime


def version_line() -> str:
    """The line of `--version` about the kernel."""
    if outdated := outdated_modules():
        return f"kernel: {_outdated(outdated)}"
    return "kernel: compiled" if is_compiled() else f"kernel: plain Python, {SLOWER}; {_remedy()}"


def kernel_warning() -> str:
    """What `verify` says once about a kernel that is not compiled, or not from its current sources; otherwise empty."""
    if outdated := outdated_modules():
        return f"warning: {_outdated(outdated)}"
    return "" if is_compiled() else f"note: the model checker runs as plain Python, {SLOWER}; {_remedy()}"


def _outdated(modules: list[str]) -> str:
    return (
        f"{', '.join(modules)} must be compiled again, because the source is newer, and results may be wrong: run "
        f"`{sys.executable} -m pip install -e .` in the checkout"
    )


def _remedy() -> str:
    return f"with a C compiler, `{sys.executable} -m as2fm_lsp.cli.build_kernel` makes it fast"
