# SPDX-License-Identifier: Apache-2.0
"""The typed semantic model: machines, trees, structs, the system file, and the whole system linked across files."""
