# SPDX-License-Identifier: Apache-2.0
"""Rules about files: their kinds, the files that they refer to, configuration and suppressions."""
