# SPDX-License-Identifier: Apache-2.0
"""`python -m as2fm_lsp.cli.build_kernel`: compile the kernel of the model checker in its installation.

A universal wheel contains the kernel as Python and as C code that Cython has generated from it. If there is a C
compiler, as on most machines with ROS, this makes verification about a hundred times as fast. If the compilation fails,
the kernel stays as it is.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

import roaml.smc
from as2fm_lsp.atomic_write import write_file

SOURCE = Path(roaml.smc.__file__).with_name("kernel.c")
FLAGS = ("-O3", "-g0", "-fwrapv", "-ffp-contract=off")


class BuildError(Exception):
    """The kernel could not be compiled; the message is a readable reason."""


def build(source: Path = SOURCE) -> Path:
    """Compile the C code, and write the extension beside it.

    Returns:
        The extension, which is complete or missing.

    Raises:
        BuildError: it cannot be compiled here.
        InterruptedError: the compiler was ended by a signal.
    """
    if not source.exists():
        raise BuildError("this installation does not contain the kernel as C code")
    linker = shlex.split(sysconfig.get_config_var("LDSHARED") or "")
    if not linker:
        raise BuildError("this Python does not provide the compiler flags for extensions")
    target = source.with_name(f"kernel{sysconfig.get_config_var('EXT_SUFFIX')}")
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / target.name
        position = shlex.split(sysconfig.get_config_var("CCSHARED") or "")
        include = f"-I{sysconfig.get_path('include')}"
        command = [*linker, *position, *FLAGS, include, str(source), "-o", str(made)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
        except OSError as error:
            raise BuildError(f"there is no C compiler: {error}") from None
        if done.returncode < 0:
            raise InterruptedError(f"{linker[0]} was ended by signal {-done.returncode}")
        if done.returncode != 0:
            reason = next((line for line in done.stderr.splitlines() if "error" in line), f"{linker[0]} failed")
            raise BuildError(f"the kernel does not compile: {reason}")
        write_file(str(target), made.read_bytes())
    return target


def main(source: Path = SOURCE) -> int:
    """
    Returns:
        The exit status: 0 if the kernel was compiled, 1 if it cannot be compiled here, 2 if the attempt was
            interrupted.
    """
    try:
        build(source)
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
