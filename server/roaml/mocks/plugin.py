# SPDX-License-Identifier: Apache-2.0
"""Creates plugins in HL-SCXML that return the statuses of mocks."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from xml.sax.saxutils import escape, quoteattr

from roaml.lower.programs.values import ticks_of
from roaml.mocks.mock import Mock
from roaml.record import Record


class MockPort(Record, frozen=True):
    """A port of a mock.

    Attributes:
        type: the type in HL-SCXML, such as `int32`.
        key: the name of the port.
        is_output: whether the mock writes the port when it succeeds.
        values: the possible values of an output, as expressions; all have the same probability.
    """

    key: str
    type: str
    is_output: bool = False
    values: tuple[str, ...] = ()


def mock_plugin(name: str, mock: Mock, rate: Fraction, ports: Sequence[MockPort] = (), *, is_condition: bool) -> str:
    """The text of a plugin in HL-SCXML that returns the statuses of a mock.

    Args:
        name: the name of the plugin, which is the type of the node.
        rate: the ticks of the tree per second; the plugin counts ticks.
        is_condition: whether the plugin never returns RUNNING, and draws a new status for each tick.
    """
    duration = 0 if is_condition else ticks_of(mock.duration, rate)
    return "\n".join(_Plugin(name, mock.probability, duration, tuple(ports), is_condition).lines()) + "\n"


class _Plugin(Record, frozen=True):
    name: str
    success: float
    duration: int
    ports: tuple[MockPort, ...]
    is_condition: bool

    def lines(self) -> list[str]:
        what = "Answers" if self.duration == 0 else f"Is RUNNING for {self.duration} ticks, then answers"
        share = f"{self.success:g}"
        lines = [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f"<!-- A mock of {escape(self.name).replace('--', '- -')}. {what} SUCCESS with probability {share}. -->",
            f'<ascxml name={quoteattr(self.name)} version="1.0" initial="idle">',
        ]
        for port in self.ports:
            direction = "out" if port.is_output else "in"
            lines.append(f'    <bt_declare_port_{direction} key={quoteattr(port.key)} type="{port.type}" />')
        lines += ["", *self.states(), "</ascxml>"]
        return lines

    def states(self) -> list[str]:
        """The states of the plugin. An action that has ended returns the same status until it is halted; a condition is
        evaluated again."""
        if self.is_condition:
            return self.state("idle", [*self.drawn("idle", "idle"), *_halt("idle")])
        lines = []
        if self.duration > 0:
            data = '        <data id="left" type="int32" expr="0" />'
            lines += ["    <datamodel>", data, "    </datamodel>", ""]
            start = [f'<assign location="left" expr="{self.duration}" />', _answer("RUNNING")]
            lines += self.state("idle", [*_tick("running", start), *_halt("idle")])
            again = ['<assign location="left" expr="left - 1" />', _answer("RUNNING")]
            waiting = _tick("running", again, cond="left &gt; 1")
            lines += self.state("running", [*waiting, *self.drawn("succeeded", "failed"), *_halt("idle")])
        else:
            lines += self.state("idle", [*self.drawn("succeeded", "failed"), *_halt("idle")])
        lines += self.state("succeeded", [*_tick("succeeded", [_answer("SUCCESS")]), *_halt("idle")])
        return lines + self.state("failed", [*_tick("failed", [_answer("FAILURE")]), *_halt("idle")])

    def state(self, name: str, body: Sequence[str]) -> list[str]:
        return [f'    <state id="{name}">', *(f"        {line}" for line in body), "    </state>"]

    def drawn(self, succeeded: str, failed: str) -> list[str]:
        """The handler of a tick that returns a random status and, with SUCCESS, writes random outputs."""
        outcomes: list[tuple[float, str, list[str]]] = []
        if self.success > 0:
            for share, outputs in self.outputs():
                outcomes.append((self.success * share, succeeded, [*outputs, _answer("SUCCESS")]))
        if self.success < 1:
            outcomes.append((1 - self.success, failed, [_answer("FAILURE")]))
        if len(outcomes) == 1:
            return _tick(outcomes[0][1], outcomes[0][2])
        lines = ["<bt_tick>"]
        for index, (share, target, body) in enumerate(outcomes):
            probability = f' prob="{share!r}"' if index < len(outcomes) - 1 else ""
            lines += [
                f'    <target id="{target}"{probability}>',
                *(f"        {line}" for line in body),
                "    </target>",
            ]
        return [*lines, "</bt_tick>"]

    def outputs(self) -> list[tuple[float, list[str]]]:
        """The combinations of values of the outputs, with their probabilities."""
        combinations: list[tuple[float, list[str]]] = [(1.0, [])]
        for port in self.ports:
            if port.is_output and port.values:
                combinations = [
                    (
                        share / len(port.values),
                        [*written, f"<bt_set_output key={quoteattr(port.key)} expr={quoteattr(v)} />"],
                    )
                    for share, written in combinations
                    for v in port.values
                ]
        return combinations


def _tick(target: str, body: Sequence[str], cond: str = "") -> list[str]:
    condition = f' cond="{cond}"' if cond else ""
    return [f'<bt_tick{condition} target="{target}">', *(f"    {line}" for line in body), "</bt_tick>"]


def _halt(target: str) -> list[str]:
    return [f'<bt_halt target="{target}">', "    <bt_return_halted />", "</bt_halt>"]


def _answer(status: str) -> str:
    return f'<bt_return_status status="{status}" />'
