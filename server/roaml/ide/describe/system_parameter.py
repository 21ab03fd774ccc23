# SPDX-License-Identifier: Apache-2.0
"""Descriptions of the parameters of a system, with readable units."""

from __future__ import annotations

from roaml.durations import NANOSECONDS
from roaml.ide.describe.language import number
from roaml.ide.describe.machine import duration, rate
from roaml.ide.describe.markdown import name
from roaml.xml_syntax import Attribute, Element


def parameter(element: Element, attribute: Attribute) -> str:
    """The meaning of the value of a parameter; "" if the value is clear without an explanation."""
    if attribute.name not in ("value", "unit"):
        return ""
    written = element.get("value")
    text = written.value.strip() if written else ""
    unit = element.get("unit")
    match element.name:
        case "max_time" if text.isascii() and text.isdigit() and unit and unit.value in NANOSECONDS:
            nanoseconds = int(text[:18]) * NANOSECONDS[unit.value]
            return f"{duration(nanoseconds / 1e9)}: {number(nanoseconds)} ns of the clock"
        case "bt_tick_rate":
            return rate(text)
        case "max_array_size" if text:
            return f"Arrays without a bound have at most {name(text)} elements"
    return ""
