# SPDX-License-Identifier: Apache-2.0
"""Measurements of time and memory, without assertions.

    .venv/bin/python tests/bench/run.py [NAME...]

A benchmark is a function that gives rows of the table. Those of the checker are in `check`; others stand beside it and
are listed in `__main__`.
"""
