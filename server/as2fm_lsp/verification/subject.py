# SPDX-License-Identifier: Apache-2.0
"""What is verified: a system, which is translated first, or a JANI file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from roaml import api
from roaml.jani.constants import with_constants
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


class ConstantError(ValueError):
    """A constant cannot be given this value, or a parameter this model does not have; the message says why."""


def load(
    path: str,
    ros_paths: Sequence[str] = (),
    settings: Settings | None = None,
    overrides: Overrides = NO_OVERRIDES,
    constants: Sequence[str] = (),
) -> Subject:
    """Read what is to be verified; a file whose name ends in `.jani` is a JANI model, any other one a system.

    Args:
        overrides: parameters in place of those in the system file.
        constants: `NAME=VALUE`, for constants that a JANI model leaves open.

    Raises:
        ConstantError: there is no such constant or parameter, or the value does not fit.
        api.PathError: the file cannot be read, or is no system file.
        api.ModelError: the system has errors.
        api.JaniError: the JANI model has errors.
    """
    if path.endswith(".jani"):
        if overrides != NO_OVERRIDES:
            raise ConstantError("--max-time is for systems; a JANI model has no such parameter")
        model, source = api.read_jani(path)
        try:
            model = with_constants(model, constants)
        except ValueError as error:
            raise ConstantError(str(error)) from None
        return Subject(path, (path,), model, lambda _: source, _clock(model))
    if constants:
        raise ConstantError("--constant is for JANI models; a system has no constants")
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
