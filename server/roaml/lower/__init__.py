# SPDX-License-Identifier: Apache-2.0
"""Translates systems in HL-SCXML to plain SCXML (docs/spec/plain-scxml.md). This is called lowering; the
function is `roaml.lower.system.lower`.

- Every system without errors can be lowered: rules report everything that cannot be lowered. If an assertion in this
  package fails, the tool has a bug; it is never an error in a model.
- All output has an origin, including the automata that the translation adds.
- The functions depend only on their arguments, and on the files of this package with the nodes of BehaviorTree.CPP.
"""
