# SPDX-License-Identifier: Apache-2.0
"""Hostile input: models damaged at random, each checked completely.

    .venv/bin/python tests/fuzz/run.py --cases 20000 --seed 0

Every case has one seed, which alone says what is damaged and how: `run.py --case SEED` does it again.
"""
