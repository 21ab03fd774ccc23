# SPDX-License-Identifier: Apache-2.0
"""The nodes of the libraries as BehaviorTree.CPP and Nav2 execute them (docs/spec/mocks.md#nodes).

definitions/*.txt    the nodes as small programs
assembly             compiles programs to instructions
executed             the executed tree, with the blackboard entries of all ports
board                the entries of the blackboard that the tree needs, with their types
blackboard           creates the plain automaton of the blackboard
scripts              translates scripts to assignments and conditions
nodes                collects everything that determines the automaton of a node
automaton            creates the plain automaton of a node
"""
