# SPDX-License-Identifier: Apache-2.0
"""What is known so far, in a file, so that a long run can be taken up again.

The file belongs to a model, its properties, a seed and a limit of steps. It may be continued with other limits, a
higher confidence or more traces; what has been counted stays right.
"""

from __future__ import annotations

import json
import os
import time
from typing import Any

from as2fm_lsp.write import write_file
from roaml.smc.batch import Payload
from roaml.smc.run import Options, Tally

VERSION = 2
PAUSE = 1.0
"""Seconds between two times of writing."""


class StateError(ValueError):
    """The file cannot be used; the message says why."""


class State:
    """The tallies of several properties, kept in a file."""

    def __init__(self, path: str, options: Options) -> None:
        self.path = path
        self.options = options
        self._properties: dict[str, dict[str, Any]] = {}
        self._written = 0.0
        if os.path.exists(path):
            self._read()

    def tally(self, name: str, payload: Payload) -> Tally:
        """What is known of a property.

        Raises:
            StateError: the file was written for another model, seed or limit of steps.
        """
        known = self._properties.get(name)
        if known is None:
            return Tally()
        if known.get("model") != payload.digest:
            raise StateError(f"{self.path} was written for another model; name another file")
        if (known.get("seed"), known.get("max_steps")) != (self.options.seed, self.options.max_steps):
            raise StateError(f"{self.path} was written with another seed or limit of steps; use these, or another file")
        try:
            tally = Tally.from_json(known["tally"])
        except (KeyError, TypeError, ValueError, AttributeError):
            raise StateError(f"{self.path} is damaged") from None
        if known.get("options") != repr(self.options):
            tally.is_finished, tally.accepted = False, None
        return tally

    def keep(self, name: str, payload: Payload, tally: Tally, now: bool = False) -> None:
        """Note what is known of a property; written now and then, or at once with `now`.

        Raises:
            OSError: the file cannot be written; it is as it was.
        """
        if not now and time.monotonic() - self._written < PAUSE:
            return
        self._written = time.monotonic()
        self._properties[name] = {
            "model": payload.digest,
            "seed": self.options.seed,
            "max_steps": self.options.max_steps,
            "options": repr(self.options),
            "tally": tally.to_json(),
        }
        text = json.dumps({"version": VERSION, "properties": self._properties}, indent=1)
        write_file(self.path, text + "\n")

    def _read(self) -> None:
        try:
            with open(self.path, encoding="utf-8") as file:
                value = json.load(file)
            if value["version"] != VERSION:
                raise StateError(f"{self.path} was written by another version")
            self._properties = dict(value["properties"])
        except StateError:
            raise
        except (ValueError, KeyError, TypeError):
            raise StateError(f"{self.path} is no state of a verification") from None
