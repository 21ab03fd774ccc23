# SPDX-License-Identifier: Apache-2.0
"""Names: their uses in a file, their symbols, and all uses of the same symbol in a workspace."""
