# SPDX-License-Identifier: Apache-2.0
"""The obligations of a machine in its system: each tick, halt, request and goal that it receives, until it is answered.

`protocols` says which requests and goals the clients can send while others are pending. `losses` follows an obligation
on the paths of a graph (`roaml.model.behavior`) and returns the places where it is lost. Rules report them.
"""
