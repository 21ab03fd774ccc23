# SPDX-License-Identifier: Apache-2.0
"""Rules about expressions: syntax, types, operators, functions, random numbers."""
