# SPDX-License-Identifier: Apache-2.0
"""What `pyproject.toml` cannot say: the wheel carries the top-level `schemas/` as `roaml/schemas`, and the kernel of
the model checker is compiled where there is a C compiler.

Without one, or with AS2FM_PURE_PYTHON=1, the installation has the same kernel as plain Python: slower, same results.
"""

import os
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_py import build_py

SCHEMAS = Path(__file__).parent / "schemas"
KERNEL = "server/roaml/smc/kernel.py"
DIRECTIVES = {
    "annotation_typing": False,
    "boundscheck": False,
    "cdivision": True,
    "initializedcheck": False,
    "language_level": 3,
    "wraparound": False,
}


def extensions() -> list[Extension]:
    """The kernel, unless it is not wanted or Cython is missing. If it does not compile, the build goes on without."""
    if os.environ.get("AS2FM_PURE_PYTHON") == "1":
        return []
    try:
        from Cython.Build import cythonize
    except ImportError:
        return []
    flags = [] if os.name == "nt" else ["-O3", "-g0", "-fwrapv"]
    kernel = Extension("roaml.smc.kernel", [KERNEL], extra_compile_args=flags)
    (made,) = cythonize([kernel], compiler_directives=DIRECTIVES, build_dir="build/cython", quiet=True)
    made.optional = True  # Cython does not keep that of `kernel`.
    return [made]


class BuildWithSchemas(build_py):
    """Copies the schemas beside the package that reads them; an editable install reads them where they are."""

    def run(self) -> None:
        super().run()
        if not self.editable_mode:
            for schema in sorted(SCHEMAS.iterdir()):
                self.copy_file(str(schema), str(self._target(schema)), preserve_mode=False)

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        return super().get_outputs(include_bytecode) + [str(self._target(schema)) for schema in SCHEMAS.iterdir()]

    def _target(self, schema: Path) -> Path:
        folder = Path(self.build_lib) / "roaml" / "schemas"
        self.mkpath(str(folder))
        return folder / schema.name


setup(cmdclass={"build_py": BuildWithSchemas}, ext_modules=extensions())
