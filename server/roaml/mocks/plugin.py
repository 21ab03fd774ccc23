# SPDX-License-Identifier: Apache-2.0
"""Creates plugins in HL-SCXML that return the statuses of mocks."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from xml.sax.saxutils import escape, quoteattr

from roaml.distributions.outcomes import decimal_text, hazards
from roaml.lower.programs.values import ticks_of
from roaml.mocks.mock import Mock, drawn_ticks
from roaml.model.drawn_durations import DrawnDuration
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

    Raises:
        MockError: a drawn duration has too many different numbers of ticks.
    """
    duration, ends = 0, tuple[float, ...]()
    if not is_condition:
        if isinstance(mock.duration, DrawnDuration):
            ends = hazards(drawn_ticks(mock.duration, rate))
        else:
            duration = ticks_of(mock.duration, rate)
    return "\n".join(_Plugin(name, mock, duration, ends, tuple(ports), is_condition).lines()) + "\n"


class _Plugin(Record, frozen=True):
    """A plugin. `ends` contains the probabilities with which an action whose duration is drawn ends after 0, 1, …
    ticks if it has not ended before; the last one is 1. It is empty for a fixed `duration`."""

    name: str
    mock: Mock
    duration: int
    ends: tuple[float, ...]
    ports: tuple[MockPort, ...]
    is_condition: bool

    def lines(self) -> list[str]:
        what = "Answers" if self.duration == 0 else f"Is RUNNING for {self.duration} ticks, then answers"
        if self.ends:
            what = f"Is RUNNING for {self.mock.behaviour().partition(' in ')[2]}, then answers"
        share = f"{self.mock.probability:g}"
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
            return self.state("idle", [*_choice(self.answers("idle", "idle")), *_halt("idle")])
        lines = []
        if self.ends:
            for ticks, share in enumerate(self.ends):
                body = [*self.ended(share, f"running_{ticks + 1}"), *_halt("idle")]
                lines += self.state(f"running_{ticks}" if ticks else "idle", body)
        elif self.duration > 0:
            data = '        <data id="left" type="int32" expr="0" />'
            lines += ["    <datamodel>", data, "    </datamodel>", ""]
            start = [f'<assign location="left" expr="{self.duration}" />', _answer("RUNNING")]
            lines += self.state("idle", [*_tick("running", start), *_halt("idle")])
            again = ['<assign location="left" expr="left - 1" />', _answer("RUNNING")]
            waiting = _tick("running", again, cond="left &gt; 1")
            lines += self.state("running", [*waiting, *self.ended(), *_halt("idle")])
        else:
            lines += self.state("idle", [*self.ended(), *_halt("idle")])
        lines += self.state("succeeded", [*_tick("succeeded", [_answer("SUCCESS")]), *_halt("idle")])
        return lines + self.state("failed", [*_tick("failed", [_answer("FAILURE")]), *_halt("idle")])

    def state(self, name: str, body: Sequence[str]) -> list[str]:
        return [f'    <state id="{name}">', *(f"        {line}" for line in body), "    </state>"]

    def ended(self, share: float = 1.0, otherwise: str = "") -> list[str]:
        """The handler of a tick at which the action ends with the probability `share`; otherwise it is RUNNING, and the
        plugin is in the state `otherwise`."""
        outcomes = [(1 - share, otherwise, [_answer("RUNNING")])] if share < 1 else []
        outcomes += (
            (share * part, target, body) for part, target, body in self.answers("succeeded", "failed") if share > 0
        )
        return _choice(outcomes)

    def answers(self, succeeded: str, failed: str) -> list[tuple[float, str, list[str]]]:
        """The probabilities, targets and bodies of the answers; with SUCCESS, random outputs are written."""
        success = self.mock.probability
        answers: list[tuple[float, str, list[str]]] = []
        if success > 0:
            for share, outputs in self.outputs():
                answers.append((success * share, succeeded, [*outputs, _answer("SUCCESS")]))
        if success < 1:
            answers.append((1 - success, failed, [_answer("FAILURE")]))
        return answers

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


def _choice(outcomes: Sequence[tuple[float, str, list[str]]]) -> list[str]:
    """The handler of a tick with random outcomes: their probabilities, targets and bodies."""
    if len(outcomes) == 1:
        return _tick(outcomes[0][1], outcomes[0][2])
    lines = ["<bt_tick>"]
    for index, (share, target, body) in enumerate(outcomes):
        probability = f' prob="{decimal_text(share)}"' if index < len(outcomes) - 1 else ""
        lines += [
            f'    <target id="{target}"{probability}>',
            *(f"        {line}" for line in body),
            "    </target>",
        ]
    return [*lines, "</bt_tick>"]


def _tick(target: str, body: Sequence[str], cond: str = "") -> list[str]:
    condition = f' cond="{cond}"' if cond else ""
    return [f'<bt_tick{condition} target="{target}">', *(f"    {line}" for line in body), "</bt_tick>"]


def _halt(target: str) -> list[str]:
    return [f'<bt_halt target="{target}">', "    <bt_return_halted />", "</bt_halt>"]


def _answer(status: str) -> str:
    return f'<bt_return_status status="{status}" />'
