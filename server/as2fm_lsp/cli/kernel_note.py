# SPDX-License-Identifier: Apache-2.0
"""Whether the model checker of this installation is compiled, and how to compile it."""

from __future__ import annotations

import importlib.util
import sys

SLOWER = "12 to 37 times slower"
"""The measured difference between plain Python and the compiled kernel (docs/performance.md)."""


def is_compiled() -> bool:
    """Whether the kernel is an extension module. The module is not loaded."""
    spec = importlib.util.find_spec("roaml.smc.kernel")
    return spec is not None and not (spec.origin or "").endswith(".py")


def version_line() -> str:
    """The line of `--version` about the kernel."""
    return "kernel: compiled" if is_compiled() else f"kernel: plain Python, {SLOWER}; {_remedy()}"


def slow_kernel_note() -> str:
    """What `verify` says once about a kernel that is not compiled; empty if it is compiled."""
    return "" if is_compiled() else f"note: the model checker runs as plain Python, {SLOWER}; {_remedy()}"


def _remedy() -> str:
    return f"with a C compiler, `{sys.executable} -m as2fm_lsp.cli.build_kernel` makes it fast"
