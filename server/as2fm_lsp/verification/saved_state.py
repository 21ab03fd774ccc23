# SPDX-License-Identifier: Apache-2.0
"""The intermediate state in a file, so that a long run can be continued.

The file is valid for one model, its properties, a seed and a limit of steps. The run can be continued with other
limits, a higher confidence or more traces; the stored counts stay valid.
"""

from __future__ import annotations

import os
import time
from typing import Any

from roaml.disk import MEGABYTE, required
from roaml.smc.batch import Payload
from roaml.smc.goal import Question
from roaml.smc.run import Options
from roaml.smc.tally import Tally

VERSION = 5
MAX_STATE_BYTES = 64 * MEGABYTE
"""The maximum size of the file, in bytes; the state of some hundred properties takes a few MB."""
WRITE_INTERVAL_S = 1.0


class StateError(ValueError):
    """The file cannot be used; the message contains the reason."""


class SavedState:
    """The tallies of several properties, stored in a file.

    Raises:
        StateError: the file exists and cannot be used.
    """

    def __init__(self, path: str, options: Options) -> None:
        self.path = path
        self.options = options
        self._properties: dict[str, dict[str, Any]] = {}
        self._written = 0.0
        if os.path.exists(path):
            self._read()

    def tally(self, question: Question, payload: Payload) -> Tally:
        """The stored tally of a property; an empty one if none is stored. If the options have changed, a tally that was
        complete can be continued.

        Raises:
            StateError: the file was written for another model, seed or limit of steps, or contains values that traces
                cannot have.
        """
        name = question.name
        known = self._properties.get(name)
        if known is None:
            return Tally()
        if known.get("model") != payload.digest:
            raise StateError(f"{self.path} was written for another model; use another file")
        if (known.get("seed"), known.get("max_steps")) != (self.options.seed, self.options.max_steps):
            raise StateError(
                f"{self.path} was written with another seed or limit of steps; use the same values for --seed and "
                "--max-steps, or another file"
            )
        try:
            from roaml.smc.stored import tally_from_json  # noqa: PLC0415

            tally = tally_from_json(known.get("tally"), question, self.options)
        except ValueError as error:
            raise StateError(f"{self.path} is damaged: {name}: {error}; remove it to start again") from None
        if known.get("options") != repr(self.options):
            # The user may have changed the options because of the results so far.
            tally.is_finished, tally.accepted, tally.is_revised = False, None, tally.traces > 0
        return tally

    def keep(self, name: str, payload: Payload, tally: Tally, now: bool = False) -> None:
        """Store the tally of a property and write the file, if `now` is true or the last write was at least
        `WRITE_INTERVAL_S` ago. Otherwise, nothing is stored.

        Raises:
            OSError: the file cannot be written; it is unchanged.
        """
        if not now and time.monotonic() - self._written < WRITE_INTERVAL_S:
            return
        self._written = time.monotonic()
        self._properties[name] = {
            "model": payload.digest,
            "seed": self.options.seed,
            "max_steps": self.options.max_steps,
            "options": repr(self.options),
            "tally": tally.to_json(),
        }
        import json  # noqa: PLC0415 - few runs are saved

        from as2fm_lsp.atomic_write import write_file  # noqa: PLC0415

        text = json.dumps({"version": VERSION, "properties": self._properties}, indent=1)

        write_file(self.path, text + "\n")

    def _read(self) -> None:
        import json  # noqa: PLC0415

        try:
            value = json.loads(required(self.path, MAX_STATE_BYTES).decode("utf-8"))
        except (ValueError, RecursionError):
            value = None
        if not isinstance(value, dict) or "version" not in value:
            raise StateError(f"{self.path} is not the state of a verification")
        if value["version"] != VERSION:
            raise StateError(f"{self.path} was written by another version; remove it to start again")
        properties = value.get("properties")
        if not isinstance(properties, dict) or not all(isinstance(row, dict) for row in properties.values()):
            raise StateError(f"{self.path} is not the state of a verification")
        self._properties = properties
