# SPDX-License-Identifier: Apache-2.0
"""How a machine behaves, as a graph: its configurations, its steps, and what each step owes or answers.

`explore` makes the graph of one chart, `duties` finds the steps behind which an answer never comes, `summary` is what
other machines see of a graph, and `instants` tells for a whole system what can happen without any time passing.
"""
