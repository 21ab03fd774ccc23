# SPDX-License-Identifier: Apache-2.0
"""The script language of BehaviorTree.CPP 4 (docs/spec/scripts.md): a tolerant parser for the grammars before and since
version 4.9, and types.

It differs from the expressions of HL-SCXML (`roaml.expr`) in the characters of names and the precedence of operators,
and it has statements, which assign to entries of the blackboard.
"""
