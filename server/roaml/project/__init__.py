# SPDX-License-Identifier: Apache-2.0
"""The user's files as a whole: discovered, read, cached by content, linked into systems and checked."""
