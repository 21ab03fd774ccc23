# SPDX-License-Identifier: Apache-2.0
"""JANI 1 (jani-spec.org) as frozen data: models and properties, their reader, writer, types and values.

- Knows JSON and places in texts, nothing of XML, SCXML or robots.
- Everything keeps its `origin`, the place that it exists for; equality does not look at it.
- Expressions may nest as deep as memory allows: no function here recurses on the Python stack.

`model`, `properties`, `expressions`, `types`, `operators` are the data; `reader`, `writer`, `typecheck`, `semantics`
are what is done with them.
"""
