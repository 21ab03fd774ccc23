# SPDX-License-Identifier: Apache-2.0
"""Checks before a model is compiled that the result is not too large, because calls of functions are replaced by their
bodies, and array constructors by their elements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from roaml.jani.expressions import ArrayConstructor, Call, Expression, Integer, walk
from roaml.jani.model import Function, Model
from roaml.jani.node import Node
from roaml.jani.properties import Property
from roaml.smc.fault import FaultError

MAX_OPERATIONS = 300_000
"""The maximum number of operations of all calls of functions together, including the calls in their bodies."""

MAX_CELLS = 10_000_000
"""The maximum number of elements of one array constructor, over all its dimensions."""


def check_size(model: Model, properties: Iterable[Property]) -> None:
    """Check that the compiled model is not too large.

    Raises:
        FaultError: a function, an array, or all calls of functions together are too large. The error has the position
            of the function or array, or of the automaton that exceeds the limit.
    """
    for variables in (model.variables, *(automaton.variables for automaton in model.automata)):
        for variable in variables:
            if isinstance(variable.initial_value, ArrayConstructor):
                _check_array(variable.initial_value)
    if not model.functions and not any(automaton.functions for automaton in model.automata):
        return
    shared = {function.name: function for function in model.functions}
    sizes = function_sizes(shared)
    total = _called((model.constants, model.variables, tuple(properties)), sizes)
    for automaton in model.automata:
        own = {function.name: function for function in automaton.functions}
        total += _called(automaton, function_sizes({**shared, **own}) if own else sizes)
        if total > MAX_OPERATIONS:
            message = f"calls of functions expand to {total:,} operations here; at most {MAX_OPERATIONS:,} are compiled"
            raise FaultError(message, automaton.origin)


def function_sizes(functions: Mapping[str, Function]) -> dict[str, int]:
    """The number of operations of each function, including those of all functions that it calls. A recursive call is
    one operation.

    Raises:
        FaultError: a function is too large.
    """
    sizes: dict[str, int] = {}
    entered: set[str] = set()
    for start in functions:
        stack = [start]
        while stack:
            name = stack[-1]
            body = list(walk(functions[name].body))
            calls = [node.function for node in body if isinstance(node, Call) and node.function in functions]
            inner = [callee for callee in dict.fromkeys(calls) if callee not in entered] if name not in entered else []
            entered.add(name)
            if inner:
                stack += inner
                continue
            stack.pop()
            if name in sizes:
                continue
            sizes[name] = len(body) + sum(sizes.get(callee, 1) for callee in calls)
            if sizes[name] > MAX_OPERATIONS:
                words = f"`{name}` expands to {sizes[name]:,} operations with all calls in it"
                raise FaultError(f"{words}; at most {MAX_OPERATIONS:,} are compiled", functions[name].origin)
    return sizes


def _called(part: object, sizes: Mapping[str, int]) -> int:
    """The number of operations to which all calls in a part of a model expand. Declarations of functions in the part
    are skipped."""
    return sum(sizes.get(node.function, 1) for node in _nodes(part) if isinstance(node, Call))


def _nodes(part: object) -> Iterator[Node]:
    stack = [part]
    while stack:
        node = stack.pop()
        if isinstance(node, tuple):
            stack += node
        elif isinstance(node, Node) and not isinstance(node, Function):
            yield node
            stack += (getattr(node, name) for name in node.__struct_fields__)


def _check_array(node: ArrayConstructor) -> None:
    cells = 1
    body: Expression = node
    while isinstance(body, ArrayConstructor):
        if isinstance(body.length, Integer):
            cells *= max(0, body.length.value)
        body = body.body
    if cells > MAX_CELLS:
        raise FaultError(f"an array cannot have {cells:,} elements; at most {MAX_CELLS:,} are supported", node.origin)
