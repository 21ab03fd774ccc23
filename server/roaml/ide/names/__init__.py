# SPDX-License-Identifier: Apache-2.0
"""Names: where each is used in a file, what it denotes, and all uses of the same thing in a workspace."""
