# SPDX-License-Identifier: Apache-2.0
"""What an editor can ask of a file: one pure module for each feature.

- A function takes what is known at one moment (`roaml.project.analysis`), a path and, where one is meant, an offset;
  it gives plain frozen data with spans.
- Half-typed files give less, never an exception.
- Knows nothing of any protocol: lines, columns and the protocol's types are the business of the faces.
"""
