# SPDX-License-Identifier: Apache-2.0
"""The expression language: a subset of ECMAScript 5 expressions (docs/spec/expressions.md).

Knows operators, syntax and types; what the names in an expression stand for is the business of `roaml.model`.
"""
