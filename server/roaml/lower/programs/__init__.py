# SPDX-License-Identifier: Apache-2.0
"""The nodes of the libraries as BehaviorTree.CPP and Nav2 execute them (docs/spec/mocks.md#nodes).

definitions/*.txt    the nodes as small programs
assembly             a program -> instructions
executed             the executed tree, with the blackboard entries of all ports
board                the entries of the blackboard that the tree needs, with their types
scripts              scripts -> instructions
nodes                a node of an executed tree -> everything that determines its automaton
automaton            this -> a plain automaton
"""
