# SPDX-License-Identifier: Apache-2.0
"""Debugging a run: breakpoints, stacks, variables and expressions in the terms of the sources.

A debugger is at a position of a run (`roaml.simulation`). It shows the statement that is executed next, which the seed
or a choice of the user determines, so that a breakpoint stops the run before its line is executed. The package does not
depend on files, editors or protocols.
"""
