# SPDX-License-Identifier: Apache-2.0
"""The names of the files that contain the configuration."""

from __future__ import annotations

CONFIG_FILE = "as2fm.toml"
PROJECT_FILE = "pyproject.toml"
"""The name of files that may contain a configuration in the table `tool.as2fm`."""

CONFIG_FILES = (CONFIG_FILE, PROJECT_FILE)
