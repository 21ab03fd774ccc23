# SPDX-License-Identifier: Apache-2.0
"""The user interfaces of `roaml`: the language server and the command line."""
