# SPDX-License-Identifier: Apache-2.0
"""Helpers that several rules use. Rules do not import each other."""
