# SPDX-License-Identifier: Apache-2.0
"""The exit statuses of the command line."""

from __future__ import annotations

CLEAN, FOUND, USAGE, FAILURE = 0, 1, 2, 3
"""The exit statuses if no errors were found, if errors were found, after a usage error, and after an internal error."""
