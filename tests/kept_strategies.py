# SPDX-License-Identifier: Apache-2.0
"""The strategies of hypothesis, each made only once.

`import kept_strategies as st` replaces `from hypothesis import strategies as st` in modules that make strategies while
they draw: the first use of a new strategy takes much longer than drawing from it. The same arguments give the same
strategy, which draws the same examples as a new one. Strategies whose arguments contain dictionaries or other values
that cannot be compared are made each time.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

from hypothesis import strategies
from hypothesis.strategies import *  # noqa: F403

Made = TypeVar("Made")
DrawFn = strategies.DrawFn
SearchStrategy = strategies.SearchStrategy


def _key(value: Any) -> Hashable:
    """A key that is equal only for equal values of the same types: `True` is not 1. Raises `TypeError` for values that
    can change and are not lists."""
    if isinstance(value, (tuple, list)):
        return (type(value), *map(_key, value))
    hash(value)
    return (type(value), value)


def kept(make: Callable[..., Made]) -> Callable[..., Made]:
    """The function that returns what `make` has returned for the same arguments."""
    made: dict[Hashable, Made] = {}

    @functools.wraps(make)
    def get(*args: Any, **options: Any) -> Made:
        try:
            key = (_key(args), _key(tuple(sorted(options.items()))))
        except TypeError:
            return make(*args, **options)
        if key not in made:
            made[key] = make(*args, **options)
        return made[key]

    return get


def composite(draw: Callable[..., Any]) -> Callable[..., SearchStrategy[Any]]:
    """As `hypothesis.strategies.composite`."""
    return kept(strategies.composite(draw))


booleans = kept(strategies.booleans)
integers = kept(strategies.integers)
just = kept(strategies.just)
lists = kept(strategies.lists)
none = kept(strategies.none)
one_of = kept(strategies.one_of)
sampled_from = kept(strategies.sampled_from)
sets = kept(strategies.sets)
tuples = kept(strategies.tuples)
