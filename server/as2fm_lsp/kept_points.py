# SPDX-License-Identifier: Apache-2.0
"""The points of an experiment in a file, so that an interrupted experiment can be continued and a larger one needs only
the new points. The file is valid for one model and one set of options."""

from __future__ import annotations

import json
import os
import time

from as2fm_lsp.atomic_write import write_file
from roaml.disk import MEGABYTE, required
from roaml.experiments.grid import Key
from roaml.experiments.points import ExperimentPoint, point_from_json

VERSION = 1
MAX_BYTES = 256 * MEGABYTE
WRITE_INTERVAL_S = 1.0


class KeptPointsError(ValueError):
    """The file cannot be used. The message contains the reason."""


class KeptPoints:
    """Points that are kept in a file.

    Args:
        path: the file, which need not exist; `None` if nothing is kept.
        digest: the digest of the model and of all options that determine the points.

    Attributes:
        points: the known points.

    Raises:
        KeptPointsError: the file exists and cannot be used.
    """

    def __init__(self, path: str | None, digest: str) -> None:
        self._path = path
        self._digest = digest
        self._written = time.monotonic()
        self.points: dict[Key, ExperimentPoint] = {}
        if path is not None and os.path.exists(path):
            self._read(path)

    def keep(self, point: ExperimentPoint) -> None:
        """Add a point. The file is written at most once per `WRITE_INTERVAL_S`."""
        self.points[point.setting, point.name] = point
        if time.monotonic() - self._written > WRITE_INTERVAL_S:
            self.write()

    def write(self) -> None:
        """Write the file."""
        if self._path is not None:
            points = [point.as_json() for point in self.points.values()]
            data = {"version": VERSION, "experiment": self._digest, "points": points}
            write_file(self._path, json.dumps(data, ensure_ascii=False, indent=1) + "\n")
            self._written = time.monotonic()

    def _read(self, path: str) -> None:
        try:
            data = json.loads(required(path, MAX_BYTES))
            version, digest = data["version"], data["experiment"]
            points = [point_from_json(point) for point in data["points"]]
        except (ValueError, KeyError, TypeError, AttributeError):
            raise KeptPointsError(f"{path} does not contain points of an experiment; use another file") from None
        if version != VERSION or digest != self._digest:
            raise KeptPointsError(f"{path} was written for another model or other options; use another file")
        self.points = {(point.setting, point.name): point for point in points}
