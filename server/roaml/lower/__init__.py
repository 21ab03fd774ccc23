# SPDX-License-Identifier: Apache-2.0
"""HL-SCXML systems -> plain SCXML (docs/spec/plain-scxml.md).

- Total: every system without errors is lowered; a rule has reported everything that cannot be lowered. An assertion
  that fails here is a bug in the tool, never an error in a model.
- All output has an origin, including the added automata.
- Pure, except for the package's own resources: the nodes of BehaviorTree.CPP in `nodes/`.
"""

from roaml.lower.program import TranslatableSystem
from roaml.lower.system import lower

__all__ = ["TranslatableSystem", "lower"]
