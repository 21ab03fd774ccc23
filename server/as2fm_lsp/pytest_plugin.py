# SPDX-License-Identifier: Apache-2.0
"""A plugin of pytest: `pytest --as2fm models/` checks and verifies models as tests.

Each system and each tree without a system is a file of tests: `check`, which fails if there are errors, and one test
for each property, which fails if its expectation is not met or if it has no answer. The properties of a tree,
`succeeds` and `fails`, are tests if mocks are beside the tree. A property without an expectation is skipped, with its
value as the reason. The properties of a file share their traces. Without the option, the plugin does nothing.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from roaml import api
    from roaml.project.settings import Settings

_EXTENSION = ".xml"


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("as2fm", "models of ROS 2 robots")
    group.addoption("--as2fm", action="store_true", help="check and verify systems and behavior trees as tests")
    group.addoption("--as2fm-no-verify", action="store_true", help="only check them")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ModelFile | None:
    if not parent.config.getoption("--as2fm") or file_path.suffix != _EXTENSION:
        return None
    from roaml.model.kinds import FileKind, kind_of  # noqa: PLC0415 - a run without models starts faster

    kind = kind_of(str(file_path), file_path.read_text(encoding="utf-8", errors="replace"))
    if kind not in (FileKind.SYSTEM, FileKind.TREE):
        return None
    file: ModelFile = ModelFile.from_parent(parent, path=file_path)
    file.is_system = kind is FileKind.SYSTEM
    return file


class FailedTestError(Exception):
    """A finding or a verdict that makes a test fail; its text is shown without a traceback."""


class ModelFile(pytest.File):
    """A system, or a tree without a system."""

    is_system = True
    _results: dict[str, api.Result] | None = None

    def collect(self) -> Iterator[pytest.Item]:
        from roaml import api  # noqa: PLC0415
        from roaml.model.kinds import MOCKS_EXTENSION  # noqa: PLC0415

        checked = api.check([str(self.path)])
        errors = [str(found) for found in checked.diagnostics if found.severity is api.Severity.ERROR]
        item: CheckItem = CheckItem.from_parent(self, name="check")
        item.errors = errors
        yield item
        has_properties = self.is_system or self.path.with_suffix(MOCKS_EXTENSION).exists()
        if errors or not has_properties or self.config.getoption("--as2fm-no-verify"):
            return
        try:
            properties = self._target.model.properties
        except (ValueError, api.ModelError) as error:
            item.errors = [str(error)]
            return
        for declared in properties:
            yield PropertyItem.from_parent(self, name=declared.name)

    def result(self, name: str) -> api.Result:
        """The result of a property. The first call verifies all properties of the file."""
        from roaml import api  # noqa: PLC0415

        if self._results is None:
            settings = self._settings
            results = api.verify(
                self._target, only_uniform=settings.only_uniform, exact_if_small=True, uniform=settings.uniform
            )
            self._results = {result.name: result for result in results}
        return self._results[name]

    def place(self, location: api.Location) -> str:
        """A place as a report names it."""
        position = self._target.place(location)
        return f"{Path(position.path).name}:{position.line}" if position else ""

    @functools.cached_property
    def _target(self) -> api.VerificationTarget:
        from roaml import api  # noqa: PLC0415

        return api.target(str(self.path), settings=self._settings)

    @functools.cached_property
    def _settings(self) -> Settings:
        from roaml.project.configuration import find_settings  # noqa: PLC0415

        return find_settings(str(self.path))[0]


class _ModelItem(pytest.Item):
    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: object = None) -> str:
        if isinstance(excinfo.value, FailedTestError):
            return str(excinfo.value)
        return str(super().repr_failure(excinfo))

    def reportinfo(self) -> tuple[Path, None, str]:
        return self.path, None, f"{self.path.name}: {self.name}"


class CheckItem(_ModelItem):
    """`as2fm-lsp --check` of a file; warnings do not fail."""

    errors: list[str]

    def runtest(self) -> None:
        if self.errors:
            raise FailedTestError("\n".join(self.errors))


class PropertyItem(_ModelItem):
    """The verification of one property."""

    def runtest(self) -> None:
        from as2fm_lsp.verification.report import one_as_text  # noqa: PLC0415

        assert isinstance(self.parent, ModelFile)
        result = self.parent.result(self.name)
        text = one_as_text(result, self.parent.place).rstrip()
        if not result.is_met:
            raise FailedTestError(text)
        if not result.verdicts:
            pytest.skip(f"no expectation set: {text.splitlines()[0]}")
