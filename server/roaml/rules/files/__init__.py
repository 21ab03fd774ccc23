# SPDX-License-Identifier: Apache-2.0
"""Rules about files: what they are, which files they name, configuration and suppressions."""
