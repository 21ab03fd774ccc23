# SPDX-License-Identifier: Apache-2.0
"""Editor features: one pure module for each.

- A function takes the state of one moment (`roaml.project.analysis`), a path and, if needed, an offset; it returns
  plain frozen data with spans.
- Incomplete files give fewer results, never an exception.
- Independent of any protocol: the callers convert lines, columns and types.
"""
