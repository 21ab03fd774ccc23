# SPDX-License-Identifier: Apache-2.0
"""Finds and reads the user's files, links them into systems, and checks them. Results are cached by content."""
