# SPDX-License-Identifier: Apache-2.0
"""All states of a model: exploration, shortest traces, and exact probabilities and expected rewards.

- `tables`: tables about a program that a search needs in addition to the program.
- `liveness`: variables that are dead in a location, which a search resets.
- `independence`, `ample`: choices that a search may leave out.
- `search`: the states and their choices, in flat memory, computed by the kernel of `roaml.smc` (compiled by Cython).
- `solver`: components, end components and certified bounds of values (compiled by Cython).
- `space`: runs a search within limits.
- `values`: the value that a property asks for: its minimum and maximum over all schedulers, and its value under uniform
  choices.
- `path`: the shortest trace to a state, as a `Recording`.
"""
