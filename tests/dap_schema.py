# SPDX-License-Identifier: Apache-2.0
"""Validates messages of the adapter with the schema of the Debug Adapter Protocol."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from jsonschema import Draft4Validator
from jsonschema.protocols import Validator

SCHEMA = json.loads((Path(__file__).parent / "debug" / "debugAdapterProtocol.json").read_text(encoding="utf-8"))
CUSTOM = (
    "choices",
    "choose",
    "events",
    "exportTimeline",
    "goToStep",
    "moments",
    "pictures",
    "properties",
    "publish",
    "saveSession",
    "timeline",
)


@cache
def _validator(definition: str) -> Validator:
    return Draft4Validator({**SCHEMA, "$ref": f"#/definitions/{definition}"})


def validate(message: dict[str, Any]) -> None:
    """Raises an error if a message of the adapter does not fit the schema."""
    name = message["event"] if message["type"] == "event" else message["command"]
    assert isinstance(name, str)
    title = name[:1].upper() + name[1:]  # an error repeats the command of its request, which may be empty
    if message["type"] == "event":
        _validator(f"{title}Event").validate(message)
    elif not message["success"]:
        _validator("ErrorResponse").validate(message)
    else:
        _validator("Response" if name in CUSTOM else f"{title}Response").validate(message)
