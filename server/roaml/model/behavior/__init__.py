# SPDX-License-Identifier: Apache-2.0
"""The behaviour of a machine as a graph of configurations and steps, with the duties that each step creates or fulfils.

A duty is an answer that the machine must send, such as the status after a tick or the response to a request. `explore`
builds the graph of one chart: the states of a machine, or those of one of its action threads. `duties` finds the steps
after which an answer is never sent. `summary` extracts the part of a graph that other machines depend on. `instants`
determines which events can occur in a whole system without the passing of time.
"""
