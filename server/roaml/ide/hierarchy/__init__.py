# SPDX-License-Identifier: Apache-2.0
"""The hierarchies of LSP: calls (senders and receivers) and types (messages and their fields)."""
