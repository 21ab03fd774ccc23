# SPDX-License-Identifier: Apache-2.0
"""The command line: one module for each thing that it does."""
