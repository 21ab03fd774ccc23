# SPDX-License-Identifier: Apache-2.0
"""The corpus gate: every complete system at hand goes through every command.

`python tests/corpus/run.py` is the whole gate; `test_corpus*.py` run a part of it.
"""
