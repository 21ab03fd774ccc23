#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Starts the corpus gate; `--help` explains it."""

import sys
from pathlib import Path

for folder in ("", "debug", "explicit", "smc", "translate"):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / folder))

from corpus.gate import main  # noqa: E402

if __name__ == "__main__":
    sys.exit(main())
