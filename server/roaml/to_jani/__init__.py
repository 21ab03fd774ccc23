# SPDX-License-Identifier: Apache-2.0
"""Plain SCXML -> JANI (docs/spec/jani.md): every automaton an automaton, every event a buffer of one place.

Knows `roaml.scxml` and `roaml.jani`, nothing of HL-SCXML, ROS or files.
"""

from roaml.to_jani.network import translate

__all__ = ["translate"]
