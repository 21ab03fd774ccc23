# SPDX-License-Identifier: Apache-2.0
"""Everything that can be reached from a state."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from typing import TypeVar

State = TypeVar("State")


def reachable(first: State, successors: Callable[[State], Iterable[State]], limit: int) -> set[State]:
    """
    Raises:
        OverflowError: there are more than `limit`.
    """
    seen = {first}
    queue = deque(seen)
    while queue:
        for after in successors(queue.popleft()):
            if after not in seen:
                if len(seen) >= limit:
                    raise OverflowError
                seen.add(after)
                queue.append(after)
    return seen
