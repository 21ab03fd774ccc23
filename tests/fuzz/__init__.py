# SPDX-License-Identifier: Apache-2.0
"""Random hostile input.

    .venv/bin/python tests/fuzz/run.py --cases 50000 --seed 0 --jobs 2

Strategies make the cases; each is a module in `fuzz/strategies`. The name of a case, `STRATEGY:SEED`, determines it:
`run.py --case STRATEGY:SEED` repeats it. No case may raise an exception, take more than two seconds of CPU time or use
more than 500 MB.
"""
