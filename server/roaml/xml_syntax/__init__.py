# SPDX-License-Identifier: Apache-2.0
"""Tolerant XML: any text gives a lossless tree in which every name and value has a position.

Implements XML 1.0 and namespaces only; `roaml.language` defines the meaning of the elements.
"""

from roaml.xml_syntax.parse import parse
from roaml.xml_syntax.tree import Attribute, CData, Comment, Document, Element, Instruction, Node, Text, children_text

__all__ = [
    "Attribute",
    "CData",
    "Comment",
    "Document",
    "Element",
    "Instruction",
    "Node",
    "Text",
    "children_text",
    "parse",
]
