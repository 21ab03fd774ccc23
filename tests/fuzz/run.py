# SPDX-License-Identifier: Apache-2.0
"""Runs `python -m fuzz` from any folder."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

if __name__ == "__main__":
    tests = Path(__file__).resolve().parents[1]
    sys.path[:1] = [str(tests), str(tests / "mocks"), str(tests / "observers")]
    runpy.run_module("fuzz", run_name="__main__", alter_sys=True)
