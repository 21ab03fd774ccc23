# SPDX-License-Identifier: Apache-2.0
"""All states of a model: exploration, shortest traces, and exact probabilities and expected rewards.

- `tables`: what a search needs to know of a program beside the program.
- `search`: the states and their choices, in flat memory, by the kernel of `roaml.smc` (compiled by Cython).
- `solver`: components, end components and certified bounds of values (compiled by Cython).
- `space`: runs a search within limits.
- `values`: what a goal asks of a space: minimum, maximum and uniform value.
- `path`: the shortest trace to a state, as a recording that can be told as a story.
"""
