# SPDX-License-Identifier: Apache-2.0
"""The parts of the build that `pyproject.toml` cannot describe: the wheel contains the top-level folder `schemas/` as
`roaml/schemas`, and the kernel of the model checker is compiled if there is a C compiler.

Without a C compiler, or with AS2FM_PURE_PYTHON=1, the same kernel is installed as plain Python: it is slower and has
the same results. The wheel then also contains the kernel as C source, which `python -m as2fm_lsp.cli.build_kernel`
compiles in the installation.
"""

import ast
import os
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.build_py import build_py

SCHEMAS = Path(__file__).parent / "schemas"
COMPILED = (
    "roaml.json_syntax.frequent",
    "roaml.smc.kernel",
    "roaml.smc.counts",
    "roaml.smc.packing",
    "roaml.smc.states",
    "roaml.explicit.ample",
    "roaml.explicit.search",
    "roaml.explicit.chain",
    "roaml.explicit.elimination",
    "roaml.explicit.solver",
)
"""The modules that Cython translates, each after those whose types it uses."""
TYPES = Path("build/cython/kernel_types.pxi")
"""The part of `kernel.pxd` that follows from declarations in Python."""
C_TYPES = {"int": "int", "Ints": "int[::1]", "Longs": "long long[::1]", "Reals": "double[::1]"}
"""The types of tables in `roaml.smc.program`, in C."""
IS_PURE = os.environ.get("AS2FM_PURE_PYTHON") == "1"
DIRECTIVES = {
    "annotation_typing": False,
    "boundscheck": False,
    "cdivision": True,
    "emit_code_comments": False,  # Comments would make the C source in a wheel 40 % larger.
    "initializedcheck": False,
    "language_level": 3,
    "wraparound": False,
}


def extensions() -> list[Extension]:
    """The modules to compile; none with AS2FM_PURE_PYTHON=1 or without Cython. The build leaves out a module that
    does not compile."""
    return [] if IS_PURE else translated_modules()


def translated_modules() -> list[Extension]:
    """The modules, translated to C; none without Cython."""
    try:
        from Cython.Build import cythonize
    except ImportError:
        return []
    # No contraction: one instruction that multiplies and adds would round differently from Python.
    flags = [] if os.name == "nt" else ["-O3", "-g0", "-fwrapv", "-ffp-contract=off"]
    write_kernel_types()
    modules = [Extension(name, [f"server/{name.replace('.', '/')}.py"], extra_compile_args=flags) for name in COMPILED]
    translated: list[Extension] = cythonize(
        modules,
        compiler_directives=DIRECTIVES,
        include_path=["server", str(TYPES.parent)],
        build_dir="build/cython",
        quiet=True,
    )
    for module in translated:
        module.optional = True  # Cython does not copy this attribute from `modules`.
    return translated


def write_kernel_types() -> None:
    """Write the codes of instructions of `roaml.smc.opcodes` as constants of C, so that a C compiler creates a jump
    table, and the tables of `roaml.smc.program` as attributes of the class that the kernel extends."""
    opcodes = ast.parse(Path("server/roaml/smc/opcodes.py").read_text(encoding="utf-8")).body
    program = ast.parse(Path("server/roaml/smc/program.py").read_text(encoding="utf-8")).body
    lines = ["cdef enum:"]
    for node in opcodes:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
            lines.append(f"    {ast.unparse(node)}")
    lines.append("cdef class KernelTables:")
    for node in program:
        if isinstance(node, ast.ClassDef) and node.name in ("ProgramTables", "Goal"):
            fields = [field for field in node.body if isinstance(field, ast.AnnAssign)]
            lines += [f"    cdef {C_TYPES[ast.unparse(f.annotation)]} {ast.unparse(f.target)}" for f in fields]
    text = "\n".join(lines) + "\n"
    if not TYPES.exists() or TYPES.read_text(encoding="utf-8") != text:  # A new file would be compiled again.
        TYPES.parent.mkdir(parents=True, exist_ok=True)
        TYPES.write_text(text, encoding="utf-8")


class BuildWithMore(build_py):
    """Also copies the schemas into the package that reads them; an editable installation reads the original files. A
    wheel without the compiled kernel also contains the kernel as C source."""

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
        copies = [(schema, package / "schemas" / schema.name) for schema in sorted(SCHEMAS.iterdir())]
        if IS_PURE:
            copies += [
                (Path(module.sources[0]), c_source(Path(self.build_lib), module)) for module in translated_modules()
            ]
        return copies


class BuildOrCarry(build_ext):
    """Compiles the modules in parallel, and copies the C source of each module that does not compile into the wheel."""

    def finalize_options(self) -> None:
        super().finalize_options()
        self.parallel = self.parallel or True  # as many processes as the machine has cores

    def run(self) -> None:
        super().run()
        if self.editable_mode or self.inplace:
            return
        for module in self.extensions:
            if not Path(self.get_ext_fullpath(module.name)).exists():
                target = c_source(Path(self.build_lib), module)
                self.mkpath(str(target.parent))
                self.copy_file(module.sources[0], str(target), preserve_mode=False)


def c_source(folder: Path, module: Extension) -> Path:
    """The path of the C source of a module in a wheel, beside its Python source."""
    return folder.joinpath(*module.name.split(".")).with_suffix(".c")


setup(cmdclass={"build_ext": BuildOrCarry, "build_py": BuildWithMore}, ext_modules=extensions())
