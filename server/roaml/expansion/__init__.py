# SPDX-License-Identifier: Apache-2.0
"""Expands what plain HL-SCXML does not have, parameters and instances, at the level of texts (docs/spec/parameters.md).

- The files of a system become other texts, which are plain HL-SCXML. Everything behind this door (rules, linking,
  translation) reads only these texts, so it needs no special cases.
- Each expanded text knows its edits, so that every place in it leads back to the file of the user.
- A system that uses none of these is not expanded.
"""

from roaml.expansion.declarations import has_channels
from roaml.expansion.expand import expand, expand_file, needs_expansion
from roaml.expansion.result import SystemExpansion
from roaml.expansion.text import ExpandedText

__all__ = ["ExpandedText", "SystemExpansion", "expand", "expand_file", "has_channels", "needs_expansion"]
