# SPDX-License-Identifier: Apache-2.0
"""The user's files as one: found, read, remembered by content, linked into systems and checked."""
