# SPDX-License-Identifier: Apache-2.0
"""The script language of BehaviorTree.CPP 4.9 and newer (docs/spec/scripts.md): a tolerant parser and types.

It is another language than the expressions of HL-SCXML (`roaml.expr`): names have other characters, operators bind
otherwise, statements assign to entries of the blackboard.
"""
