# SPDX-License-Identifier: Apache-2.0
"""Editor features: one module or package of pure functions for each.

- A function takes the analysis of the files at one moment (`roaml.project.analysis`), a path and, if needed, an offset.
  It returns plain frozen data with spans.
- Incomplete files give fewer results, never an exception.
- Independent of any protocol: the callers convert lines, columns and types.
"""
