# SPDX-License-Identifier: Apache-2.0
"""Measurements of time and memory, without assertions.

    .venv/bin/python tests/bench/run.py [NAME...]

A benchmark is a function that returns rows of the table. Those of the checker are in `check`; other modules are listed
in `__main__`.
"""
