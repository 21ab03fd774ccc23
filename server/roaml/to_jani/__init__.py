# SPDX-License-Identifier: Apache-2.0
"""Translates plain SCXML to JANI (docs/spec/jani.md). Every automaton becomes a JANI automaton. Every event that is
sent, except the steps of the clock and the ticks of timers, becomes a JANI automaton that is a buffer of size one.

The package depends on `roaml.scxml` and `roaml.jani`, but not on HL-SCXML, ROS or files.
"""

from roaml.to_jani.network import translate

__all__ = ["translate"]
