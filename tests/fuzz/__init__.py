# SPDX-License-Identifier: Apache-2.0
"""Hostile input, made at random.

    .venv/bin/python tests/fuzz/run.py --cases 50000 --seed 0 --jobs 2

The cases are made by strategies, one module each in `fuzz/strategies`. Each case is named `STRATEGY:SEED`, which alone
says what it is: `run.py --case STRATEGY:SEED` does it again. No case may raise an exception, take more than two seconds
of processor time or more than 500 MB.
"""
