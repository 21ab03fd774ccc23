# SPDX-License-Identifier: Apache-2.0
"""Experiments: the values of properties for many values of parameters, curves over time, and the value that is enough.

`grid` computes a grid, `curves` curves from one set of traces, `enough` searches for the smallest or greatest value of
a parameter that meets an expectation, `derivatives` computes derivatives of exact values, and `plots` draws all of
these. `roaml.api` and the command line use only these modules.
"""
