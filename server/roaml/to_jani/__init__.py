# SPDX-License-Identifier: Apache-2.0
"""Plain SCXML -> JANI (docs/spec/jani.md): every automaton becomes an automaton, every event a buffer of size one.

Depends on `roaml.scxml` and `roaml.jani`, not on HL-SCXML, ROS or files.
"""

from roaml.to_jani.network import translate

__all__ = ["translate"]
