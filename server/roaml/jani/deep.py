# SPDX-License-Identifier: Apache-2.0
"""Recursion without the Python stack, so that deeply nested files cannot overflow it.

A recursive function is written as a generator. It yields each recursive call, and `yield` returns the result:

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
"""A computation whose result is a `T`. Each value that it yields is another computation whose result it needs."""


def run(steps: Steps[T]) -> T:
    """The result of the computation `steps`."""
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
    """A computation that has the result `result` without any step."""
    return result
    yield  # never reached: makes this a generator
