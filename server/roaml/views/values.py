# SPDX-License-Identifier: Apache-2.0
"""Values of variables in a readable form."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.smc.record import Plain


def shown_value(value: Plain) -> str:
    """A value in the notation of the models. An array of bytes that represents a string is written as that string."""
    match value:
        case bool():
            return "true" if value else "false"
        case list():
            return _text(value) or f"[{', '.join(map(shown_value, value))}]"
        case float():
            return f"{value:g}"
        case _:
            return str(value)


def shown_parameters(values: Mapping[str, Plain]) -> str:
    """The parameters of an event in a readable form, such as `pose.x: 1, pose.y: 2`."""
    return ", ".join(f"{name.replace('__', '.')}: {shown_value(value)}" for name, value in values.items())


def _text(value: list[Plain]) -> str:
    """A string, which JANI represents as an array of its bytes in UTF-8 that ends in zeros; "" if the array
    is not a string."""
    while value and value[-1] == 0:
        value = value[:-1]
    codes = [byte for byte in value if isinstance(byte, int) and 32 <= byte <= 255]
    try:
        text = bytes(codes).decode("utf-8") if len(codes) == len(value) else ""
    except UnicodeDecodeError:
        return ""
    return repr(text) if text and text.isprintable() else ""
