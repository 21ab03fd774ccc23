# SPDX-License-Identifier: Apache-2.0
"""Rules about elements and attributes: where they are allowed, and which values they accept."""
