# SPDX-License-Identifier: Apache-2.0
"""What a check reports does not depend on the order of sets, which differs between processes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from checked import write_files
from rule_files import cases_of_rules


def test_a_check_reports_the_same_in_every_process(tmp_path: Path) -> None:
    """The last case of each rule. With these seeds, the names `busy` and `id` in the case of unknown-thread have
    different orders in a set."""
    for case in {case.subject: case for case in cases_of_rules()}.values():
        write_files(tmp_path / case.subject, case.text)
    command = (sys.executable, "-m", "as2fm_lsp", "--check", ".", "--severity", "hint", "--format", "json")
    outputs = {
        subprocess.run(
            command, cwd=tmp_path, env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, check=False
        ).stdout
        for seed in ("0", "2")
    }
    assert len(outputs) == 1
    assert b"unknown-thread" in outputs.pop()
