# SPDX-License-Identifier: Apache-2.0
"""The ports that a machine reads and writes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.model.machine import Machine, SetOutput
from roaml.model.syntax import Name, PortRead
from roaml.model.value_types import TypedMachine


def reads(machine: Machine, typed: TypedMachine) -> Iterator[Name]:
    """The ports that a machine reads."""
    for value in typed.values:
        if isinstance(value.value, PortRead) and value.value.key is not None:
            yield value.value.key
    for declaration in machine.declarations:
        for read in (declaration.interface, declaration.rate):
            if isinstance(read, PortRead) and read.key is not None:
                yield read.key


def writes(machine: Machine) -> Iterator[Name]:
    """The ports that a machine writes."""
    for chart in machine.charts:
        for statement in chart.statements:
            if isinstance(statement, SetOutput) and statement.key is not None:
                yield statement.key
