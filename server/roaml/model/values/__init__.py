# SPDX-License-Identifier: Apache-2.0
"""The values that variables, fields and conditions of a machine can have: an abstract interpretation of each machine.

`analyse` interprets one machine with the data that can arrive. `outline` contains what a machine can send, and
`arriving` what can arrive at each machine of a system. The results contain at least every value that occurs in a trace:
a value that they exclude never occurs, a value that they contain may not occur.
"""
