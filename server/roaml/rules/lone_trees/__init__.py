# SPDX-License-Identifier: Apache-2.0
"""Behavior trees that belong to no system, and what libraries and models say of their nodes."""
