# SPDX-License-Identifier: Apache-2.0
"""Values of variables in a readable form."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.scxml.names import entry_name
from roaml.views.arrays import DeclaredValue


def shown_value(value: DeclaredValue) -> str:
    """A value in the notation of the models."""
    match value:
        case bool():
            return "true" if value else "false"
        case list():
            return f"[{', '.join(map(shown_value, value))}]"
        case str():
            return repr(value)
        case float():
            return f"{value:g}"
        case _:
            return str(value)


def shown_parameters(values: Mapping[str, DeclaredValue]) -> str:
    """The parameters of an event in a readable form, such as `pose.x: 1, pose.y: 2`."""
    return ", ".join(f"{entry_name(name).replace('__', '.')}: {shown_value(value)}" for name, value in values.items())
