# SPDX-License-Identifier: Apache-2.0
"""Tolerant XML: any text gives a lossless tree in which every name and value knows its place.

Knows XML 1.0 and namespaces only; what the elements mean is stated in `roaml.language`.
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
