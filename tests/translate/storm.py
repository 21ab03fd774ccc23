# SPDX-License-Identifier: Apache-2.0
"""What Storm, an independent model checker, says about a translated model."""

from __future__ import annotations

import json
import os
import resource
from typing import Any, NamedTuple

import stormpy
from fixed_point import NotExactError, in_fixed_point

from roaml.jani.model import Model
from roaml.jani.writer import write

REFUSED, MEMORY_USED_UP = 3, 4
"""Exit statuses of the process of `exact_within`."""


class Exact(NamedTuple):
    """The least and the greatest probability over all schedulers, and the states that were built for it."""

    least: float
    greatest: float
    states: int


class StormLimits(NamedTuple):
    """Limits of Storm for one property: CPU time in s and memory in bytes."""

    seconds: int = 600
    memory: int = 6 << 30

    def apply(self) -> None:
        """Limit this process."""
        resource.setrlimit(resource.RLIMIT_CPU, (self.seconds, self.seconds))
        resource.setrlimit(resource.RLIMIT_AS, (self.memory, self.memory))


class TooLargeError(Exception):
    """Storm has reached a limit.

    Attributes:
        is_time: whether it is the CPU time, not the memory.
    """

    def __init__(self, *, is_time: bool) -> None:
        super().__init__("CPU time" if is_time else "memory")
        self.is_time = is_time


class RefusedError(Exception):
    """Storm refuses the model or the form of its property, or integers cannot represent its real variables."""


def exact_within(model: Model, name: str, limits: StormLimits) -> Exact:
    """As `exact`, in a process of its own.

    Raises:
        TooLargeError, RefusedError: there is no answer.
    """
    reading, writing = os.pipe()
    process = os.fork()  # a new interpreter would import Storm first, which takes longer than most answers
    if process == 0:
        os.close(reading)
        limits.apply()
        status, text = _answered(model, name)
        os.write(writing, text.encode()[-4096:])
        os._exit(status)
    os.close(writing)
    with os.fdopen(reading, encoding="utf-8", errors="replace") as answer:
        text = answer.read()
    _, waited, usage = os.wait4(process, 0)
    status = os.waitstatus_to_exitcode(waited)
    if status == REFUSED:
        raise RefusedError(text)
    if status < 0 or status == MEMORY_USED_UP:
        raise TooLargeError(is_time=usage.ru_utime + usage.ru_stime >= limits.seconds - 1)
    if status:
        raise AssertionError(text)
    return Exact(*json.loads(text))


def _answered(model: Model, name: str) -> tuple[int, str]:
    """The exit status of a process that asks Storm, and what it writes."""
    try:
        return 0, json.dumps(exact(model, name))
    except MemoryError:
        return MEMORY_USED_UP, ""
    except NotExactError as error:
        return REFUSED, f"a real variable: {error}"
    except RuntimeError as error:
        reason = str(error).strip() or type(error).__name__
        return (MEMORY_USED_UP, "") if "bad_alloc" in reason else (REFUSED, reason.splitlines()[-1])
    except BaseException as error:  # the fork must not return
        return 1, f"{type(error).__name__}: {error}"


def read(model: Model) -> stormpy.JaniModel:
    """
    Raises:
        RuntimeError: Storm refuses the file.
    """
    return stormpy.parse_jani_model_from_string("".join(write(model)))[0]


def exact(model: Model, name: str) -> Exact:
    """The probability of one property, computed by Storm's sparse engine.

    Both probabilities are computed from one state space: what decides the property does not depend on the scheduler.
    Other properties are left out, because then Storm need not go on where this one is decided, without which nothing
    would be finite.

    Raises:
        NotExactError: the model has real variables that integers cannot represent (`fixed_point`).
    """
    document = json.loads("".join(write(model)))
    (property_,) = (p for p in document["properties"] if p["name"] == name)
    document["properties"] = [_of_schedulers(property_, operator) for operator in ("Pmin", "Pmax")]
    parsed, properties = stormpy.parse_jani_model_from_string(json.dumps(in_fixed_point(document)))
    built = stormpy.build_model(parsed, properties[:1])
    results = (stormpy.model_checking(built, property_, only_initial_states=True) for property_ in properties)
    least, greatest = (result.get_value(built.initial_states[0]) for result in results)
    return Exact(least, greatest, built.nr_states)


def _of_schedulers(property_: dict[str, Any], operator: str) -> dict[str, Any]:
    """The values of a property with another operator, Pmin or Pmax, which is its name as well. If the property compares
    a probability with a number, the probability remains."""
    expression = property_["expression"]
    values = expression["values"]
    sides = (values, values.get("left"), values.get("right"))
    probability = next(side for side in sides if isinstance(side, dict) and side["op"] in ("Pmin", "Pmax"))
    return {
        **property_,
        "name": operator,
        "expression": {**expression, "fun": "values", "values": {**probability, "op": operator}},
    }
