# SPDX-License-Identifier: Apache-2.0
"""The strategies: every module in this folder has one as `STRATEGY`."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from fuzz.strategy import Strategy


@cache
def strategies() -> dict[str, Strategy]:
    """All strategies by name, sorted."""
    modules = (importlib.import_module(f"{__name__}.{info.name}") for info in pkgutil.iter_modules(__path__))
    by_name = {module.STRATEGY.name: module.STRATEGY for module in modules}
    return {name: by_name[name] for name in sorted(by_name)}


def plan(cases: int, chosen: tuple[Strategy, ...]) -> list[tuple[str, int]]:
    """Pairs of a strategy and the number of its cases, by the shares of the strategies. Each gets at least one."""
    total = sum(strategy.share for strategy in chosen)
    return [(strategy.name, max(1, cases * strategy.share // total)) for strategy in chosen]
