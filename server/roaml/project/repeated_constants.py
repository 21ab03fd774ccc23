# SPDX-License-Identifier: Apache-2.0
"""Constants of an enumeration in a ROS interface that have the same value."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from roaml.diagnostics import Finding, Related
from roaml.interfaces.types import Constant, Definition, Scalar
from roaml.rules.parser_rules import REPEATED_CONSTANT


def repeated_constants(text: str, definition: Definition) -> Iterator[Finding]:
    """The warnings at constants with the value of an earlier one in an enumeration, which is in consecutive lines.
    Several repeated values, and one whose comment names the earlier constant, are intended.

    Args:
        text: the file with the definition.
    """
    for section in definition.sections:
        for block in _blocks(text, section.constants):
            first: dict[Scalar, Constant] = {}
            repeated = [c for c in block if c.value is not None and first.setdefault(c.value, c) is not c]
            if len(repeated) != 1 or not _is_enumeration(first):
                continue
            (constant,) = repeated
            assert constant.value is not None
            earlier = first[constant.value]
            if earlier.name in constant.comment:
                continue
            message = (
                f"`{constant.name}` has the same value as `{earlier.name}`, so machines cannot distinguish them; "
                "choose another value"
            )
            yield REPEATED_CONSTANT.at(
                constant.value_span, message, related=[Related(earlier.value_span, f"the value of `{earlier.name}`")]
            )


def _is_enumeration(values: Collection[Scalar]) -> bool:
    """Whether values are consecutive integers from 0 or 1, or powers of 2, as those of states and flags. Other equal
    values, such as limits, are equal by chance."""
    numbers = sorted(value for value in values if isinstance(value, int) and not isinstance(value, bool))
    if len(numbers) != len(values) or len(numbers) < _MIN_VALUES or numbers[0] not in (0, 1):
        return False
    flags = [number for number in numbers if number]
    is_consecutive = numbers[-1] - numbers[0] == len(numbers) - 1
    return is_consecutive or all(number & (number - 1) == 0 for number in flags)


_MIN_VALUES = 2
"""How many different values the constants of an enumeration have at least."""


def _blocks(text: str, constants: Sequence[Constant]) -> Iterator[list[Constant]]:
    """The constants of the same integer type in consecutive lines."""
    block: list[Constant] = []
    for constant in constants:
        between = text[block[-1].value_span.end : constant.type_span.start] if block else ""
        if block and (between.count("\n") != 1 or block[-1].type != constant.type):
            yield block
            block = []
        block.append(constant)
    yield block
