# SPDX-License-Identifier: Apache-2.0
"""The grammar of the languages, in tables that are written from `schemas/`.

The schemas define the syntax and the roles of its parts; completion, hover, validation, navigation and the reference
manual read them through this package.
"""

from roaml.language.grammar import (
    BEHAVIOR_TREE,
    HL_SCXML,
    PLAIN_SCXML,
    STRUCTS,
    SYSTEM,
    XML_PROPERTIES,
    AttributeType,
    ElementType,
    Grammar,
    PortType,
    ValueChoice,
)

__all__ = [
    "BEHAVIOR_TREE",
    "HL_SCXML",
    "PLAIN_SCXML",
    "STRUCTS",
    "SYSTEM",
    "XML_PROPERTIES",
    "AttributeType",
    "ElementType",
    "Grammar",
    "PortType",
    "ValueChoice",
]
