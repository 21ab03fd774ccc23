# SPDX-License-Identifier: Apache-2.0
"""JANI 1 (jani-spec.org) as immutable data: models and properties, with a reader, a writer, types and values.

- The package depends only on JSON and positions in texts, not on XML, SCXML or robots.
- Every part has an `origin`, the place from which it comes. Equality ignores it.
- Expressions may be nested as deeply as memory allows: no function recurses on the Python stack.

`model`, `properties`, `expressions`, `types` and `operators` define the data; `reader`, `writer`, `typecheck` and
`semantics` contain the functions on the data.
"""
