# SPDX-License-Identifier: Apache-2.0
"""The expression language: a subset of ECMAScript 5 expressions (docs/spec/expressions.md).

Defines operators, syntax and types; `roaml.model` resolves the names in an expression.
"""
