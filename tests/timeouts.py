# SPDX-License-Identifier: Apache-2.0
"""The timeout of tests that wait for an event."""

from __future__ import annotations

TIMEOUT_S = 300.0
"""Only prevents an endless wait, because other work on the machine can make a process slow."""
