# SPDX-License-Identifier: Apache-2.0
"""The nodes of the libraries as programs (docs/spec/mocks.md#nodes).

definitions/*.txt    the programs
assembly             compiles programs to instructions
effects              what a node does with its children, and the statuses that it can return
"""
