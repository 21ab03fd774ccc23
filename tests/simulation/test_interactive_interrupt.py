# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C ends a long movement of the interactive simulation; the session continues."""

from __future__ import annotations

import io
import signal
from pathlib import Path

import pytest

from as2fm_lsp.cli.interactive import Terminal
from as2fm_lsp.outputs import OutputFiles
from roaml import api
from roaml.simulation import Session
from roaml.smc.record import TraceStep

ROBOT = Path(__file__).resolve().parents[2] / "examples/assembly_robot/main_with_bug.xml"


@pytest.mark.parametrize("command", ["e", "g 400", "g 9 s", "u /block/placed"])
def test_an_interrupt_ends_a_movement(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    target = api.as_target(api.load(str(ROBOT)))
    session = api.session(target, "block_placed", seed=3)
    take = Session.step
    handler = signal.getsignal(signal.SIGINT)

    def step(self: Session) -> TraceStep | None:
        if self.position == 99:
            signal.raise_signal(signal.SIGINT)
        return take(self)

    monkeypatch.setattr(Session, "step", step)
    Terminal(session, target, OutputFiles(target.files)).run(io.StringIO(f"{command}\n\nq\n"))
    out = capsys.readouterr().out
    assert "  interrupted\nstep 100, " in out
    assert "step 101, " in out
    assert signal.getsignal(signal.SIGINT) is handler
