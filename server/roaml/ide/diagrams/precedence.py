# SPDX-License-Identifier: Apache-2.0
"""The order in which the transitions of a state are tried that have the same trigger."""

from __future__ import annotations

from collections.abc import Sequence

from roaml.ide.diagrams.actions import Wording
from roaml.model.machine import Handler

OTHERWISE = "[else]"


def precedence(wording: Wording, handlers: Sequence[Handler]) -> list[str]:
    """What is written before the condition of each transition.

    Transitions with the same trigger have numbers, in the order in which their conditions are evaluated. The last is
    `[else]` if only it has no condition, and two transitions need no numbers then. A transition whose trigger no other
    has is "".
    """
    texts = [""] * len(handlers)
    rivals: dict[tuple[object, str], list[int]] = {}
    for number, handler in enumerate(handlers):
        if handler.effective:
            rivals.setdefault((handler.trigger, wording.trigger(handler)), []).append(number)
    for numbers in rivals.values():
        if len(numbers) < 2:
            continue
        has_else = [handlers[number].cond is None for number in numbers] == [False] * (len(numbers) - 1) + [True]
        if len(numbers) > 2 or not has_else:
            for place, number in enumerate(numbers, 1):
                texts[number] = f"{place}."
        if has_else:
            texts[numbers[-1]] = f"{texts[numbers[-1]]} {OTHERWISE}".lstrip()
    return texts
