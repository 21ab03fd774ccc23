# SPDX-License-Identifier: Apache-2.0
"""What `pyproject.toml` cannot say: the wheel carries the top-level `schemas/` as `roaml/schemas`."""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

SCHEMAS = Path(__file__).parent / "schemas"


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


setup(cmdclass={"build_py": BuildWithSchemas})
