# SPDX-License-Identifier: Apache-2.0
"""What is verified: a system, which is translated first, or a JANI file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from roaml import api
from roaml.jani.model import Model
from roaml.jani.node import Origin
from roaml.model.system_file import NO_OVERRIDES, Overrides
from roaml.project.settings import Settings
from roaml.text import SourceFile

CLOCK = ("topic_clock_msg__ros_fields__sec", "topic_clock_msg__ros_fields__nanosec")
"""What translated systems call the time."""


@dataclass(frozen=True, slots=True)
class Subject:
    """A model, and the texts in which its places are.

    Attributes:
        files: those that were read, the one that was named first.
        source_of: the text of a file that an origin names.
        clock: the variables for seconds and nanoseconds, if the model has them.
    """

    path: str
    files: tuple[str, ...]
    model: Model
    source_of: Callable[[str], SourceFile]
    clock: tuple[str, str] | None

    def place(self, origin: Origin | None) -> tuple[str, int, int] | None:
        """Path, line and column of an origin, both from 1."""
        if origin is None:
            return None
        start = self.source_of(origin.path).lines.position(origin.span.start)
        return origin.path, start.line + 1, start.column + 1


def load(
    path: str, ros_paths: Sequence[str] = (), settings: Settings | None = None, overrides: Overrides = NO_OVERRIDES
) -> Subject:
    """Read what is to be verified; a file whose name ends in `.jani` is a JANI model, any other one a system.

    Raises:
        api.PathError: the file cannot be read, or is no system file.
        api.ModelError: the system has errors.
        api.JaniError: the JANI model has errors.
    """
    if path.endswith(".jani"):
        model, source = api.read_jani(path)
        return Subject(path, (path,), model, lambda _: source, _clock(model))
    return of_system(api.load(path, ros_paths, settings, overrides=overrides))


def of_system(system: api.LoadedSystem) -> Subject:
    """A system, translated."""

    def source_of(file: str) -> SourceFile:
        found = system.analysis.source(file)
        assert found is not None
        return found

    model = api.to_jani(system)
    return Subject(system.path, system.files, model, source_of, _clock(model))


def _clock(model: Model) -> tuple[str, str] | None:
    names = {variable.name for variable in model.variables}
    return CLOCK if names.issuperset(CLOCK) else None
