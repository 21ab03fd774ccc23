# SPDX-License-Identifier: Apache-2.0
"""Hierarchies of LSP: calls (who sends what to whom) and types (which message contains which)."""
