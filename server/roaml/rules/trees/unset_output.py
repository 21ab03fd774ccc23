# SPDX-License-Identifier: Apache-2.0
"""The rule `unset-output`, which unset_output.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.language import HL_SCXML
from roaml.model.machine import Chart, Handler, If, ReturnStatus, SetOutput, Statement, bodies
from roaml.record import Record
from roaml.roles import Direction
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support import misspelled

_SUCCESS = "SUCCESS"
_MIN_SET = 2
"""How many other successes must set a port, unless they are targets of the same transition."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report the only success that does not write an output port which all others write."""
    if not misspelled.is_hidden(context.machine.element, "bt_set_output", HL_SCXML):
        successes = [success for chart in context.machine.charts for success in _successes(chart)]
        for port in context.machine.ports:
            if port.key is not None and port.direction is Direction.OUT:
                yield from _forgotten(context, port.key.value, successes)


class _Success(Record, frozen=True, eq=False):
    """A returned SUCCESS.

    Attributes:
        handler: the handler in which it is returned; `None` for `<onentry>`.
        outputs: the ports that are written in the same content or in content around it.
    """

    element: ReturnStatus
    handler: Handler | None
    outputs: tuple[SetOutput, ...]


def _successes(chart: Chart) -> Iterator[_Success]:
    for _, handler, body in bodies(chart):
        yield from _successes_in(handler, body, ())


def _successes_in(
    handler: Handler | None, body: Sequence[Statement], around: tuple[SetOutput, ...]
) -> Iterator[_Success]:
    outputs = (*around, *(statement for statement in body if isinstance(statement, SetOutput)))
    for statement in body:
        if isinstance(statement, ReturnStatus) and statement.status is not None and statement.status.value == _SUCCESS:
            yield _Success(statement, handler, outputs)
        elif isinstance(statement, If):
            for branch in (*statement.branches, *((statement.otherwise,) if statement.otherwise else ())):
                yield from _successes_in(handler, branch.body, outputs)


def _forgotten(context: MachineContext, name: str, successes: Sequence[_Success]) -> Iterator[Finding]:
    setting = [s for s in successes if any(o.key is not None and o.key.value == name for o in s.outputs)]
    others = [success for success in successes if success not in setting]
    beside = {output for success in setting for output in success.outputs}
    elsewhere = (
        statement
        for chart in context.machine.charts
        for statement in chart.statements
        if isinstance(statement, SetOutput) and statement.key is not None and statement.key.value == name
    )
    if len(others) != 1 or any(output not in beside for output in elsewhere):
        return  # the port keeps the value that was written before
    (other,) = others
    alike = [s for s in setting if s.handler is other.handler and s.handler is not None and s.handler.is_probabilistic]
    if alike or len(setting) >= _MIN_SET:
        message = (
            f"here, the plugin succeeds without writing its output port `{name}`, unlike everywhere else, so nodes "
            "that read the value get an old one or none; add a `<bt_set_output>`"
        )
        related = [Related(success.element.element.name_span, "written here") for success in setting]
        yield RULE.at(other.element.element.name_span, message, related=related)


RULE = Rule(
    "unset-output",
    Severity.WARNING,
    "A plugin succeeds without writing an output port that it writes elsewhere.",
    machine=check,
    whole=True,
)
