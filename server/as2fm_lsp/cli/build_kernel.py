# SPDX-License-Identifier: Apache-2.0
"""`python -m as2fm_lsp.cli.build_kernel`: compile the model checkers in their installation.

A universal wheel contains their inner loops, and that of the JSON parser, as Python and as C code (0.2 MB) that Cython
has generated from it. VS Code runs this command in the private environment of the extension. If there is a C compiler,
as on most machines with ROS, this makes verification about a hundred times as fast. If the compilation of one module
fails, no module is replaced.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import roaml
from as2fm_lsp.atomic_write import write_file

PACKAGE = Path(roaml.__file__).parent
MODULES = (
    "json_syntax/frequent",
    "smc/kernel",
    "smc/counts",
    "smc/packing",
    "smc/states",
    "explicit/ample",
    "explicit/search",
    "explicit/chain",
    "explicit/elimination",
    "explicit/solver",
)
SOURCES = tuple(PACKAGE / f"{module}.c" for module in MODULES)
FLAGS = ("-O3", "-g0", "-fwrapv", "-ffp-contract=off")


class BuildError(Exception):
    """The kernel could not be compiled; the message contains the reason."""


def build(sources: Sequence[Path] = SOURCES) -> list[Path]:
    """Compile the C code on all cores, and write each extension beside its source.

    Returns:
        The paths of the extensions; each file is complete.

    Raises:
        BuildError: a module cannot be compiled here; nothing has been written.
        InterruptedError: the compiler was ended by a signal.
    """
    if not all(source.exists() for source in sources):
        raise BuildError("this installation does not contain the kernel as C code")
    linker = shlex.split(sysconfig.get_config_var("LDSHARED") or "")
    if not linker:
        raise BuildError("this Python does not provide the compiler flags for extensions")
    targets = [source.with_name(f"{source.stem}{sysconfig.get_config_var('EXT_SUFFIX')}") for source in sources]
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(os.cpu_count()) as compilers:
        outputs = [Path(folder) / target.name for target in targets]
        made = list(compilers.map(partial(_compiled, linker), sources, outputs))
    for target, extension in zip(targets, made, strict=True):
        write_file(str(target), extension)
    return targets


def _compiled(linker: Sequence[str], source: Path, target: Path) -> bytes:
    """Compile the C code of a module to `target`; return the content of the extension."""
    position = shlex.split(sysconfig.get_config_var("CCSHARED") or "")
    include = f"-I{sysconfig.get_path('include')}"
    command = [*linker, *position, *FLAGS, include, str(source), "-o", str(target)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise BuildError(f"there is no C compiler: {error}") from None
    if done.returncode < 0:
        raise InterruptedError(f"{linker[0]} was ended by signal {-done.returncode}")
    if done.returncode != 0:
        reason = next((line for line in done.stderr.splitlines() if "error" in line), f"{linker[0]} failed")
        raise BuildError(f"the kernel does not compile: {reason}")
    return target.read_bytes()


def main(sources: Sequence[Path] = SOURCES) -> int:
    """Compile the kernel and report the result.

    Returns:
        The exit status: 0 if the kernel was compiled, 1 if it cannot be compiled here, 2 if the attempt was
        interrupted.
    """
    try:
        build(sources)
    except InterruptedError as error:
        print(f"{error}; the kernel will be compiled at the next attempt", file=sys.stderr)
        return 2
    except (BuildError, OSError) as error:
        print(f"{error}; verification runs as plain Python", file=sys.stderr)
        return 1
    print("the kernel was compiled")
    return 0


if __name__ == "__main__":
    sys.exit(main())
