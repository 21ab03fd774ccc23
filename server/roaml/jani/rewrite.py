# SPDX-License-Identifier: Apache-2.0
"""Transforms formulas and expressions of any depth, from the leaves to the root."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from roaml.jani.deep import Steps, run
from roaml.jani.node import Node
from roaml.record import replace

N = TypeVar("N", bound=Node)


def rewrite(node: N, change: Callable[[Node], Node]) -> N:
    """A copy of `node` in which `change` has been applied to all its parts, inner before outer, and to the node itself.

    `change` must return a node that is allowed in the same place. The copy shares unchanged parts with `node`.
    """
    result: N = run(_rewritten(node, change))
    return result


def _rewritten(node: Any, change: Callable[[Node], Node]) -> Steps[Any]:
    changed = {}
    for name in node.__struct_fields__:
        value = getattr(node, name)
        if isinstance(value, Node):
            new: Any = yield _rewritten(value, change)
        elif isinstance(value, tuple) and any(isinstance(item, Node) for item in value):
            parts = []
            for item in value:
                parts.append((yield _rewritten(item, change)))
            new = value if all(a is b for a, b in zip(parts, value, strict=True)) else tuple(parts)
        else:
            continue
        if new is not value:
            changed[name] = new
    return change(replace(node, **changed) if changed else node)
