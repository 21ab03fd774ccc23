# SPDX-License-Identifier: Apache-2.0
"""The behaviour of a machine as a graph: its configurations, its steps, and the duties that each step creates or
fulfils.

`explore` builds the graph of one chart, `duties` finds the steps after which an answer never comes, `summary` is the
part of a graph that other machines use, and `instants` determines for a whole system what can happen without the
passing of time.
"""
