# SPDX-License-Identifier: Apache-2.0
"""The nodes of the libraries as BehaviorTree.CPP and Nav2 execute them (docs/spec/mocks.md#nodes).
`roaml.libraries.programs` contains their definitions.

executed             the executed tree, with the blackboard entries of all ports
entries              an entry of the blackboard
board                the entries of the blackboard that the tree needs, with their types
blackboard           creates the plain automaton of the blackboard
scripts              translates scripts to assignments and conditions
cases                compares the variable and the cases of a `Switch`
code                 everything that determines the automaton of a node
nodes                determines the program of a node and the values of its ports
values               evaluates the expressions of a program
steps                divides instructions that use the blackboard into steps
automaton            creates the plain automaton of a node
refusal              the reason why a tree cannot be translated
"""
