# SPDX-License-Identifier: Apache-2.0
"""Numbers in a given order, with given minimum distances, as near as possible to desired numbers."""

from __future__ import annotations

from collections.abc import Sequence


def spread(
    desired: Sequence[float],
    distances: Sequence[float],
    weights: Sequence[float] | None = None,
    low: float = float("-inf"),
    high: float = float("inf"),
) -> list[float]:
    """The numbers x with x[i] + distances[i] <= x[i + 1] that minimise the weighted sum of the squares of x - desired.

    Algorithm: pool adjacent violators. The distances take precedence over `high`, and `high` over `low`.

    Args:
        distances: the minimum difference between each number and the next one; one element less than `desired`.
        low, high: the limits of the numbers.
    """
    offsets = [0.0]
    for gap in distances:
        offsets.append(offsets[-1] + gap)
    blocks: list[tuple[float, float, int]] = []  # mean, weight, and count of the numbers of each block
    for index, value in enumerate(desired):
        block = (value - offsets[index], weights[index] if weights else 1.0, 1)
        while blocks and blocks[-1][0] > block[0]:
            mean, weight, size = blocks.pop()
            total = weight + block[1]
            block = ((mean * weight + block[0] * block[1]) / total, total, size + block[2])
        blocks.append(block)
    placed: list[float] = []
    limit = high - offsets[-1] if offsets else high
    for mean, _, size in blocks:
        shifted = min(max(mean, low), limit)
        placed += [shifted + offsets[len(placed) + member] for member in range(size)]
    return placed
