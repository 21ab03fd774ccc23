# SPDX-License-Identifier: Apache-2.0
"""HL-SCXML systems -> plain SCXML (docs/spec/plain-scxml.md).

- Total: a system without errors is lowered; whatever has no plain form, a rule has reported. An assertion that fails
  here is our mistake, never the user's.
- Everything that comes out has an origin, the synthesised automata included.
- Pure, but for the package's own resources: the nodes of BehaviorTree.CPP in `nodes/`.
"""

from roaml.lower.program import TranslatableSystem
from roaml.lower.system import lower

__all__ = ["TranslatableSystem", "lower"]
