# SPDX-License-Identifier: Apache-2.0
"""Rules about elements and attributes: which may occur where, and which values they take."""
