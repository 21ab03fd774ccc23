# SPDX-License-Identifier: Apache-2.0
"""Statistical model checking: does a property of a JANI model hold, and how often?

- Sees `roaml.jani` and nothing of SCXML, XML, robots or the disk.
- `compile` turns a model into flat arrays once; `kernel` walks them. `kernel.py` is plain Python and is compiled by
  Cython, with the types in `kernel.pxd`, where there is a compiler. Both give the same traces.
- A trace is a pure function of the compiled model, the seed and its number; nothing else, not the number of workers
  nor the order of work, has an influence on it.
- What a model does wrong while it runs (an index outside of an array, a division by zero) is a `Fault` with its place.
"""
