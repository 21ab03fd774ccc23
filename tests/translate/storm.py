# SPDX-License-Identifier: Apache-2.0
"""What Storm, an independent model checker, says about a translated model."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import stormpy
from fixed_point import NotExactError, in_fixed_point

from roaml import api
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
    """Storm has reached a limit."""


class RefusedError(Exception):
    """Storm refuses the model or the form of its property, or integers cannot represent its real variables."""


def exact_within(model: Model, name: str, limits: StormLimits) -> Exact:
    """As `exact`, in a process of its own.

    Raises:
        TooLargeError, RefusedError: there is no answer.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.jani"
        file.write_text("".join(write(model)), encoding="utf-8")
        ended = subprocess.run(
            [sys.executable, __file__, file, name], capture_output=True, check=False, text=True, preexec_fn=limits.apply
        )
    if ended.returncode == REFUSED:
        raise RefusedError(ended.stderr.strip())
    if ended.returncode < 0 or ended.returncode == MEMORY_USED_UP:
        raise TooLargeError
    if ended.returncode:
        raise AssertionError(ended.stderr)
    return Exact(*json.loads(ended.stdout.splitlines()[-1]))


def read(model: Model) -> stormpy.JaniModel:
    """
    Raises:
        RuntimeError: Storm refuses the file.
    """
    return stormpy.parse_jani_model_from_string("".join(write(model)))[0]


def exact(model: Model, name: str) -> Exact:
    """The probability of one property, computed by Storm's sparse engine.

    Raises:
        NotExactError: the model has real variables that integers cannot represent (`fixed_point`).
    """
    (least, states), (greatest, _) = (_checked(model, name, operator) for operator in ("Pmin", "Pmax"))
    return Exact(least, greatest, states)


def _checked(model: Model, name: str, operator: str) -> tuple[float, int]:
    """One property at a time: then Storm need not go on where it is decided, without which nothing would be finite."""
    document = json.loads("".join(write(model)))
    (property_,) = (p for p in document["properties"] if p["name"] == name)
    property_["expression"]["values"]["op"] = operator
    document["properties"] = [property_]
    parsed, properties = stormpy.parse_jani_model_from_string(json.dumps(in_fixed_point(document)))
    built = stormpy.build_model(parsed, properties)
    result = stormpy.model_checking(built, properties[0], only_initial_states=True)
    return result.get_value(built.initial_states[0]), built.nr_states


def main(file: str, name: str) -> int:
    """Print Storm's answer; the exit status states why there is none."""
    try:
        print(json.dumps(exact(api.read_jani(file)[0], name)))
    except MemoryError:
        return MEMORY_USED_UP
    except NotExactError as error:
        return _refused(f"a real variable: {error}")
    except RuntimeError as error:
        return MEMORY_USED_UP if "bad_alloc" in str(error) else _refused(str(error))
    return 0


def _refused(reason: str) -> int:
    print(reason.splitlines()[-1], file=sys.stderr)
    return REFUSED


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
