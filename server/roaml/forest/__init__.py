# SPDX-License-Identifier: Apache-2.0
"""Trees that belong to no system of HL-SCXML: what models and libraries say of their nodes, and what follows from it
(docs/spec/lone-trees.md).

A `Forest` is the file that is looked at with the files that it is seen with. Nothing is concluded from what is not
known: a node without a model has unknown ports and may answer anything.
"""
