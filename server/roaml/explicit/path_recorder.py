# SPDX-License-Identifier: Apache-2.0
"""The steps of a path (`roaml.explicit.path`), as a `Recording`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.explicit.path import Path
from roaml.smc.end import End
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage
from roaml.smc.record import Plain, Recorder, Recording


class PathRecorder(Recorder):
    """Records the steps of a given path, instead of random ones."""

    def __init__(self, checker: ModelChecker, property_: CompiledProperty, path: Path) -> None:
        super().__init__(checker, property_, 0, len(path.steps))
        self._path = path

    def initial(self, storages: Sequence[Storage], trace: int) -> list[Plain]:
        self._kernel.root(self._path.root)
        return self.values(storages)

    def _run(self, recording: Recording) -> Iterator[int]:
        kernel = self._kernel
        kernel.root(self._path.root)
        yield 0
        for number, (vector, edges, ways) in enumerate(self._path.steps, 1):
            kernel.go(vector, edges, ways)
            yield number
        recording.verdict = self._path.verdict
        recording.end = End(kernel.standstill()) if self._path.is_end else End.DECIDED

    def rush(self, recording: Recording) -> None:
        for _ in self.walk(recording):
            pass
