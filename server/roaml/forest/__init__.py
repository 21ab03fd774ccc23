# SPDX-License-Identifier: Apache-2.0
"""Behavior trees that belong to no HL-SCXML system, analysed with the declarations of their nodes in models and
libraries (docs/spec/lone-trees.md).

A `Forest` is a file together with the files that belong to it. Nothing is concluded from missing declarations: a node
without a model has unknown ports and may return any status.
"""
