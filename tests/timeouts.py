# SPDX-License-Identifier: Apache-2.0
"""The timeout of tests that wait for an event."""

from __future__ import annotations

TIMEOUT_S = 300.0
"""Prevents only an endless wait: other work on the machine makes a process slow, not wrong."""
