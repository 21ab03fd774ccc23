# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C, which the terminal sends to `experiment` and to its worker processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from timeouts import TIMEOUT_S

INTERRUPTIBLE = """
import runpy, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
runpy.run_module("as2fm_lsp", run_name="__main__", alter_sys=True)
"""
"""Processes that a shell starts in the background ignore SIGINT, unless it is reset."""
COIN = """\
<ascxml name="Coin" version="1.0" initial="toss">
    <parameter name="p" type="float64" value="0.5" min="0" max="1" />
    <datamodel><data id="tails" type="int32" expr="0" /></datamodel>
    <state id="toss">
        <transition cond="tails &lt; 1000000">
            <target id="heads" prob="p * 0.00001" />
            <target id="toss"><assign location="tails" expr="tails + 1" /></target>
        </transition>
    </state>
    <state id="heads"><onentry><send event="heads" /></onentry></state>
</ascxml>
"""
PROPERTIES = """\
{"properties": [{"name": "heads", "expression": {"op": "filter", "fun": "values", "states": {"op": "initial"}, "values":
    {"op": "Pmin", "exp": {"op": "F", "exp": "heads.valid"}}}}]}
"""


def children(main: int) -> list[int]:
    """The workers of a process: the children of its children, from which they are forked."""
    rows = subprocess.run(["ps", "-A", "-o", "ppid=,pid="], capture_output=True, text=True, check=True).stdout
    parents = {int(child): int(parent) for parent, child in (row.split() for row in rows.splitlines())}
    return [child for child, parent in parents.items() if parents.get(parent) == main]


@pytest.mark.parametrize("workers", [1, 2])
def test_no_worker_prints_a_traceback(tmp_path: Path, workers: int) -> None:
    """The last worker is interrupted while it starts."""
    (tmp_path / "coin.ascxml").write_text(COIN)
    (tmp_path / "p.jani").write_text(PROPERTIES)
    (tmp_path / "main.xml").write_text(
        '<roaml><parameters><max_time value="1" unit="s" /></parameters>'
        '<node_models><input type="node-ascxml" src="coin.ascxml" /></node_models>'
        '<properties><input type="jani" src="p.jani" /></properties></roaml>'
    )
    options = ("--set", "Coin.p=0:1:0.1", "--jobs", "2", "--method", "fixed", "--max-traces", "900000000")
    command = [sys.executable, "-c", INTERRUPTIBLE, "experiment", "main.xml", *options]
    with subprocess.Popen(
        command, cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    ) as running:
        try:
            while len(children(running.pid)) < workers:
                assert running.poll() is None
                time.sleep(0.005)
            os.killpg(running.pid, signal.SIGINT)
            _, err = running.communicate(timeout=TIMEOUT_S)
        finally:
            running.kill()
    assert (running.returncode, err) == (130, "as2fm-lsp: interrupted: 0 of 11 points are known\n")
