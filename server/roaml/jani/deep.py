# SPDX-License-Identifier: Apache-2.0
"""Recursion without the Python stack, so that deeply nested files cannot overflow it.

A recursive function is written as a generator. It yields each recursive call, and `yield` returns the result:

    def depth(node: Node) -> Steps[int]:
        below = 0
        for child in node.children:
            below = max(below, (yield depth(child)))
        return below + 1

    run(depth(root))

A function that needs no step for some arguments can return the result itself for these, which is much faster.
"""

from __future__ import annotations

from collections.abc import Generator
from types import GeneratorType
from typing import Any, TypeAlias, TypeVar, overload

T = TypeVar("T")

Steps: TypeAlias = Generator[Any, Any, T]
"""A computation whose result is a `T`. Each value that it yields is another computation whose result it needs, or that
result."""


@overload
def run(steps: Steps[T]) -> T: ...


@overload
def run(steps: T) -> T: ...


def run(steps: Any) -> Any:
    """The result of the computation `steps`; `steps` itself if it is not a generator."""
    if not isinstance(steps, GeneratorType):
        return steps
    stack: list[Steps[Any]] = [steps]
    result: Any = None
    while stack:
        try:
            result = stack[-1].send(result)
        except StopIteration as end:
            stack.pop()
            result = end.value
        else:
            if isinstance(result, GeneratorType):
                stack.append(result)
                result = None
    return result
