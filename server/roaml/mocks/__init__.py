# SPDX-License-Identifier: Apache-2.0
"""Behavior trees that are executed without a system: the nodes of the libraries as BehaviorTree.CPP executes them, and
mocks instead of all other leaves (docs/spec/mocks.md).

    mock       reads mocks such as `FollowPath: 0.9 in 2 s`
    unfolding  trees -> the executed tree, with the blackboard entries of all ports
    proposal  assumptions
               mocks that are proposed for leaves, with reasons
    network    an executed tree -> plain SCXML; `roaml.lower.programs` translates its nodes
    system_leaves  system_mocks  plugin
               the leaves of a system without a plugin, and plugins for them
"""
