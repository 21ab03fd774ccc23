# SPDX-License-Identifier: Apache-2.0
"""Edits of XML text: elements that are added, renamed and removed, in the layout of the file."""
