# SPDX-License-Identifier: Apache-2.0
"""Converts properties in JANI of known forms to properties in XML, and back (docs/spec/properties.md#conversion).

- `forms` converts path formulas to patterns and scopes, and back. It is independent of systems and files.
- `to_xml` and `to_jani` convert the conditions, which name variables of ports in XML and global variables in JANI.
- A property is converted only if both have the same answer for every model and seed.
"""
