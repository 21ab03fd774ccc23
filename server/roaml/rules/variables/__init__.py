# SPDX-License-Identifier: Apache-2.0
"""Rules about variables, their types and names."""
