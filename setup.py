# SPDX-License-Identifier: Apache-2.0
"""What `pyproject.toml` cannot say: the wheel carries the top-level `schemas/` as `roaml/schemas`, and the kernel of
the model checker is compiled where there is a C compiler.

Without one, or with AS2FM_PURE_PYTHON=1, the installation has the same kernel as plain Python: slower, same results.
With it the wheel carries the kernel's C text, too, which `python -m as2fm_lsp.cli.build_kernel` compiles where it is.
"""

import os
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_py import build_py

SCHEMAS = Path(__file__).parent / "schemas"
COMPILED = ("roaml.smc.kernel", "roaml.explicit.search", "roaml.explicit.elimination", "roaml.explicit.solver")
"""The modules that Cython translates, each after those whose types it uses."""
IS_PURE = os.environ.get("AS2FM_PURE_PYTHON") == "1"
DIRECTIVES = {
    "annotation_typing": False,
    "boundscheck": False,
    "cdivision": True,
    "emit_code_comments": False,  # They would make the C text that a wheel carries 40 percent larger.
    "initializedcheck": False,
    "language_level": 3,
    "wraparound": False,
}


def extensions() -> list[Extension]:
    """The compiled modules, unless they are not wanted or Cython is missing. If they do not compile, the build goes on
    without."""
    return [] if IS_PURE else translated_modules()


def translated_modules() -> list[Extension]:
    """The modules as C; none if Cython is missing."""
    try:
        from Cython.Build import cythonize
    except ImportError:
        return []
    # Without contraction: multiplying and adding in one instruction would round otherwise than Python does.
    flags = [] if os.name == "nt" else ["-O3", "-g0", "-fwrapv", "-ffp-contract=off"]
    wanted = [Extension(name, [f"server/{name.replace('.', '/')}.py"], extra_compile_args=flags) for name in COMPILED]
    made: list[Extension] = cythonize(
        wanted, compiler_directives=DIRECTIVES, include_path=["server"], build_dir="build/cython", quiet=True
    )
    for module in made:
        module.optional = True  # Cython does not keep that of `wanted`.
    return made


class BuildWithMore(build_py):
    """Copies the schemas beside the package that reads them; an editable install reads them where they are. A wheel
    without the compiled kernel gets its C text."""

    def run(self) -> None:
        super().run()
        for source, target in self._copies():
            self.mkpath(str(target.parent))
            self.copy_file(str(source), str(target), preserve_mode=False)

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        return super().get_outputs(include_bytecode) + [str(target) for _, target in self._copies()]

    def _copies(self) -> list[tuple[Path, Path]]:
        if self.editable_mode:
            return []
        package = Path(self.build_lib) / "roaml"
        found = [(schema, package / "schemas" / schema.name) for schema in sorted(SCHEMAS.iterdir())]
        if IS_PURE:
            for module in translated_modules():
                _, *folders, name = module.name.split(".")
                found.append((Path(module.sources[0]), package.joinpath(*folders, f"{name}.c")))
        return found


setup(cmdclass={"build_py": BuildWithMore}, ext_modules=extensions())
