# SPDX-License-Identifier: Apache-2.0
"""How long a test waits for something that must come."""

from __future__ import annotations

PATIENCE = 300.0
"""Seconds. A guard against waiting for ever: other work on the machine makes a process slow, not wrong."""
