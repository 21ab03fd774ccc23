# SPDX-License-Identifier: Apache-2.0
"""The reserved words of ECMAScript, which cannot be names in an expression."""

from __future__ import annotations

RESERVED = frozenset((
    "break", "case", "catch", "class", "const", "continue", "debugger", "default", "delete", "do", "else", "enum",
    "export", "extends", "false", "finally", "for", "function", "if", "import", "in", "instanceof", "new", "null",
    "return", "super", "switch", "this", "throw", "true", "try", "typeof", "var", "void", "while", "with",
))  # fmt: skip
"""The words that are reserved everywhere."""

CONTEXTUAL = frozenset(("await", "let", "yield"))
"""The words that are reserved in modules, generators and strict code only."""

LITERALS = frozenset(("false", "null", "true"))
OPERATORS = frozenset(("in", "instanceof"))
"""The reserved words that are written between operands."""
PREFIXES = frozenset(("await", "delete", "typeof", "void", "yield"))
"""The reserved words that are written before an operand."""
STATEMENTS = (RESERVED | CONTEXTUAL) - LITERALS - OPERATORS - PREFIXES - {"this"}
"""The other reserved words, such as those of statements, functions and classes."""
