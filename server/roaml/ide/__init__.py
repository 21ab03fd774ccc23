# SPDX-License-Identifier: Apache-2.0
"""What an editor asks about a place in a file: pure functions (analysis, path, offset) -> plain frozen data.

Knows nothing of the protocol that editors speak. Half-written documents give half answers, never exceptions.
"""
