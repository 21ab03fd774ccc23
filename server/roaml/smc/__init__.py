# SPDX-License-Identifier: Apache-2.0
"""Statistical model checking: estimates the probabilities and expected rewards that the properties of a JANI model ask
for.

- Depends on `roaml.jani`, not on SCXML, XML, robots or the disk.
- `compile` turns a model into flat arrays once; `kernel` simulates them. `kernel.py` is plain Python and is compiled by
  Cython, with the types in `kernel.pxd`, if there is a compiler. Both generate the same traces. A step takes 0.03 to
  0.06 µs compiled in ROS systems, and 10 µs as Python. Numba was measured as an alternative: it takes 0.5 s to import,
  0.3 s to load a cached function and 305 MB (two cores of an AMD EPYC), while a whole verification takes 0.8 s.
- A *question* is what a property asks about all traces (`goal.Question`); an *answer* is the estimate. A *goal* is what
  the kernel evaluates on each trace for one or more questions (`program.Goal`).
- A step of the kernel evaluates again only what it changes: the actions of the locations that are left and entered, and
  the guards that read a changed variable. Of many guards that compare variables with constants, it evaluates those that
  may be true (`index`).
- `packing` packs states of a kernel into a few words each, and numbers them.
- `states` remembers the states that traces have reached, and where their steps lead. A known step takes 0.005 to
  0.02 µs. This is switched off for models whose states do not repeat.
- A trace is a pure function of the compiled model, the seed and its number; neither the number of workers nor the order
  of work influences it.
- An undefined operation of a model (an index outside of an array, a division by zero) is reported as a `FaultError`
  with its position.
"""
