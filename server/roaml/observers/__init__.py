# SPDX-License-Identifier: Apache-2.0
"""Observers: small deterministic programs that read a trace letter by letter and determine whether a property holds on
it. A letter is a step of the trace: it states which conditions are true, and whether the clock advances.

- The package does not depend on SCXML, XML or JANI: conditions are named inputs, times are steps of a clock.
- An observer is data (`program.Observer`): registers and assignments. It can be interpreted, and translated to any
  language that has booleans and small integers.
- Memory is bounded: a few registers, and one bit for each clock step of a lower bound on time.
"""
