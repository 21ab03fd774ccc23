# SPDX-License-Identifier: Apache-2.0
"""Recursion without the Python stack, so that no nesting in a file overflows it.

A recursive function is written as a generator that yields each recursive call and is sent the call's result:

    def depth(node: Node) -> Steps[int]:
        below = 0
        for child in node.children:
            below = max(below, (yield depth(child)))
        return below + 1

    run(depth(root))
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any, TypeAlias, TypeVar

T = TypeVar("T")

Steps: TypeAlias = Generator[Any, Any, T]
"""A computation of a `T` in steps; each step is another computation whose result it needs."""


def run(steps: Steps[T]) -> T:
    """The result of `steps`."""
    stack: list[Steps[Any]] = [steps]
    result: Any = None
    while stack:
        try:
            step = stack[-1].send(result)
        except StopIteration as end:
            stack.pop()
            result = end.value
        else:
            stack.append(step)
            result = None
    return result  # type: ignore[no-any-return]


def done(result: T) -> Steps[T]:
    """A computation without any step."""
    return result
    yield  # never reached: makes this a generator
