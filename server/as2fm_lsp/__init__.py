# SPDX-License-Identifier: Apache-2.0
"""The faces of `roaml`: the language server and the command line."""
