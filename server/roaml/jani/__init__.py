# SPDX-License-Identifier: Apache-2.0
"""JANI 1 (jani-spec.org) as frozen data: models and properties, their reader, writer, types and values.

- Depends on JSON and positions in texts only, not on XML, SCXML or robots.
- Every part has an `origin`, the place from which it comes; equality ignores it.
- Expressions may nest as deeply as memory allows: no function here recurses on the Python stack.

`model`, `properties`, `expressions`, `types`, `operators` are the data; `reader`, `writer`, `typecheck`, `semantics`
are the functions on them.
"""
