# SPDX-License-Identifier: Apache-2.0
"""The changes that the interactive simulation shows after a command."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from as2fm_lsp.cli.interactive import Terminal
from as2fm_lsp.outputs import OutputFiles
from roaml import api
from roaml.smc.record import TraceStep, VariableChange
from roaml.views.arrays import ArrayReader

ROBOT = Path(__file__).resolve().parents[2] / "examples/assembly_robot/main_with_bug.xml"
COMMANDS = ["g 120", *[""] * 10, "t", "t", "b 30", *["1", "2"] * 8, "g 60", *["1"] * 20, "g 150", "b", "t", "g 300"]


@pytest.fixture(scope="module")
def target() -> api.VerificationTarget:
    return api.as_target(api.load(str(ROBOT)))


def test_changes_are_those_of_the_whole_run(target: api.VerificationTarget, capsys: pytest.CaptureFixture[str]) -> None:
    """A terminal that has shown earlier steps, and gone back from them, shows the same as a new one."""
    sessions = [api.session(target, "block_placed", seed=3) for _ in range(2)]
    continued = Terminal(sessions[0], target, OutputFiles(target.files))
    shown = []
    for command in COMMANDS:
        continued.run(io.StringIO(f"{command}\nq\n"))
        output = capsys.readouterr().out
        Terminal(sessions[1], target, OutputFiles(target.files)).run(io.StringIO(f"{command}\nq\n"))
        assert capsys.readouterr().out == output
        shown.append("→" in output)
    back = COMMANDS.index("b 30")
    assert any(shown[:back])
    assert any(shown[back:])


def test_going_forwards_reads_each_step_once(
    target: api.VerificationTarget, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    numbers = []
    read = ArrayReader.read

    def counted(self: ArrayReader, step: TraceStep) -> list[VariableChange]:
        numbers.append(step.number)
        return read(self, step)

    session = api.session(target, "block_placed", seed=3)
    terminal = Terminal(session, target, OutputFiles(target.files))
    monkeypatch.setattr(ArrayReader, "read", counted)
    terminal.run(io.StringIO("g 100\n\n\nt\nt\nq\n"))
    assert numbers == list(range(1, session.position + 1))
    numbers.clear()
    terminal.run(io.StringIO("b 50\n\nq\n"))
    assert numbers == list(range(1, session.position + 1))
    assert "→" in capsys.readouterr().out
