# SPDX-License-Identifier: Apache-2.0
"""Whether the model checker of this installation is compiled from its current sources, and how to compile it."""

from __future__ import annotations

import importlib.util
import os
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from typing import TYPE_CHECKING

import roaml

if TYPE_CHECKING:
    from pathlib import Path

PACKAGE = os.path.dirname(roaml.__file__)
"""The folder of the library."""

SLOWER = "12 to 37 times slower"
"""The measured difference between plain Python and the compiled kernel (docs/performance.md)."""


def is_compiled() -> bool:
    """Whether the kernel is an extension module. The module is not loaded."""
    spec = importlib.util.find_spec("roaml.smc.kernel")
    return spec is not None and not (spec.origin or "").endswith(".py")


def outdated_modules(package: str | Path = PACKAGE) -> list[str]:
    """The compiled modules that are older than their sources in a checkout that was updated and not installed again.
    They may fail or have wrong results. In other installations, the times of files are those of the installation."""
    if not os.path.isfile(os.path.join(package, "..", "..", "setup.py")):
        return []
    suffix = EXTENSION_SUFFIXES[0]
    return [
        f"{os.path.basename(package)}.{part}.{file.removesuffix(suffix)}"
        for part in sorted(os.listdir(package))
        if os.path.isdir(folder := os.path.join(package, part))
        for file in sorted(os.listdir(folder))
        if file.endswith(suffix)
        and _is_newer(os.path.join(folder, file.removesuffix(suffix) + ".py"), os.path.join(folder, file))
    ]


def _is_newer(source: str, compiled: str) -> bool:
    return os.path.isfile(source) and os.path.getmtime(source) > os.path.getmtime(compiled)


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
