# SPDX-License-Identifier: Apache-2.0
"""Rules about system files and the size of the systems that they describe."""
