# SPDX-License-Identifier: Apache-2.0
"""Verifying a model and telling what came of it, for the command line and the server alike."""
