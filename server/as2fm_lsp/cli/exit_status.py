# SPDX-License-Identifier: Apache-2.0
"""The exit statuses of the command line."""

from __future__ import annotations

CLEAN, FOUND, USAGE, FAILURE = 0, 1, 2, 3
"""The exit statuses: no errors were found and all expectations are met; an error was found or an expectation is not
met; a usage error; an internal error."""
