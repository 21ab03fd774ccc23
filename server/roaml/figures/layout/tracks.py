# SPDX-License-Identifier: Apache-2.0
"""Tracks between two layers: each line leaves the upper layer, follows a track, and enters the lower layer.

Lines that would lie on top of each other get different tracks, ordered so that vertical parts do not overlap and few
lines cross. Where two lines exchange their places, one of them changes its track between the layers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

CLEARANCE = 9.0
"""The minimum distance of two parallel lines between layers, in pixels."""


class TrackTurn(NamedTuple):
    """A part of a line that follows `track` until the place `to`."""

    track: int
    to: float


def assign_tracks(lines: Sequence[tuple[float, float]]) -> tuple[list[list[TrackTurn]], int]:
    """The parts of each line, and the number of tracks.

    Args:
        lines: the place where each line leaves the upper layer, and where it enters the lower one.
    """
    segments: Sequence[_Segment] = [
        _Segment(index, start, end) for index, (start, end) in enumerate(lines) if start != end
    ]
    limit = 2 * len(segments)
    order = _ordered(segments)
    while isinstance(order, _Segment) and len(segments) < limit:
        segments = [part for segment in segments for part in _split(segment, order, segments, lines)]
        order = _ordered(segments)
    if isinstance(order, _Segment):  # each segment is split at most once; new ends keep a distance from all others
        order = segments
    tracks: dict[_Segment, int] = {}
    for segment in order:
        earlier = (track for other, track in tracks.items() if _meet(other, segment))
        tracks[segment] = 1 + max(earlier, default=-1)
    turns: list[list[TrackTurn]] = [[] for _ in lines]
    for segment in sorted(tracks, key=lambda segment: segment.part):
        turns[segment.line].append(TrackTurn(tracks[segment], segment.end))
    return turns, 1 + max(tracks.values(), default=-1)


class _Segment(NamedTuple):
    """The part of a line along one track. `part` numbers the parts of a line from above."""

    line: int
    start: float
    end: float
    part: int = 0

    @property
    def left(self) -> float:
        return min(self.start, self.end)

    @property
    def right(self) -> float:
        return max(self.start, self.end)


def _meet(a: _Segment, b: _Segment) -> bool:
    return a.line == b.line or (a.left < b.right + CLEARANCE and b.left < a.right + CLEARANCE)


def _must_not_be_above(a: _Segment, b: _Segment) -> bool:
    """Whether the lower vertical part of `a` would overlap the upper one of `b`."""
    if a.line == b.line:
        return a.part > b.part
    return abs(a.end - b.start) < CLEARANCE


def _crossings(a: _Segment, b: _Segment) -> int:
    """The number of crossings of two segments if `a` is above `b`."""
    return (a.left < b.start < a.right) + (b.left < a.end < b.right)


def _ordered(segments: Sequence[_Segment]) -> Sequence[_Segment] | _Segment:
    """The segments ordered from top to bottom. If there is no valid order, the result is a segment to split."""
    above: dict[_Segment, set[_Segment]] = {segment: set() for segment in segments}
    cost: dict[_Segment, dict[_Segment, int]] = {segment: {} for segment in segments}
    for a, b in _pairs(segments):
        if _must_not_be_above(a, b):
            above[a].add(b)
        if _must_not_be_above(b, a):
            above[b].add(a)
        difference = _crossings(a, b) - _crossings(b, a)
        if difference:
            cost[a][b], cost[b][a] = difference, -difference
    order: list[_Segment] = []
    remaining = list(segments)
    while remaining:
        possible = [segment for segment in remaining if not above[segment]]
        if not possible:
            return max(_on_cycle(remaining, above), key=lambda segment: segment.right - segment.left)
        best = min(
            possible,
            key=lambda segment: (sum(max(0, cost[segment].get(other, 0)) for other in remaining), segment.line),
        )
        order.append(best)
        remaining.remove(best)
        for others in above.values():
            others.discard(best)
    return order


def _on_cycle(remaining: Sequence[_Segment], above: dict[_Segment, set[_Segment]]) -> list[_Segment]:
    """Segments that form a cycle: each must be above the next one and below the previous one."""
    path = [remaining[0]]
    while True:
        following = min(above[path[-1]], key=lambda segment: (segment.line, segment.part))
        if following in path:
            return path[path.index(following) :]
        path.append(following)


def _pairs(segments: Sequence[_Segment]) -> Iterator[tuple[_Segment, _Segment]]:
    for index, a in enumerate(segments):
        for b in segments[index + 1 :]:
            if _meet(a, b):
                yield a, b


def _split(
    segment: _Segment, chosen: _Segment, segments: Sequence[_Segment], lines: Sequence[tuple[float, float]]
) -> Iterator[_Segment]:
    """The parts of a segment: itself, or two parts if it is the chosen one. The place where the parts meet has a
    minimum distance from all other lines."""
    if segment != chosen:
        yield segment._replace(part=segment.part + (segment.line == chosen.line and segment.part > chosen.part))
        return
    used = [place for line in lines for place in line]
    used += [place for other in segments for place in (other.start, other.end)]
    middle = (segment.start + segment.end) / 2
    candidates = [middle, *(place + side * 1.5 * CLEARANCE for place in used for side in (-1, 1))]
    free = [place for place in candidates if all(abs(place - other) >= CLEARANCE for other in used)]
    between = min(free, key=lambda place: (not segment.left < place < segment.right, abs(place - middle)))
    yield _Segment(segment.line, segment.start, between, segment.part)
    yield _Segment(segment.line, between, segment.end, segment.part + 1)
