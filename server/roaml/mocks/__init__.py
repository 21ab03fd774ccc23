# SPDX-License-Identifier: Apache-2.0
"""Behavior trees that are executed without a system: the nodes of the libraries as BehaviorTree.CPP executes them, and
mocks instead of all other leaves (docs/spec/mocks.md).

    programs/*.txt    the nodes as small programs
    assembly          a program -> instructions
    unfolding         trees -> the executed tree, with the blackboard entries of all ports
    scripts           scripts -> instructions
    automaton         instructions of a node -> a plain automaton
    network           an executed tree -> plain SCXML
"""
