# SPDX-License-Identifier: Apache-2.0
"""Rules about behavior trees that belong to no system, with the declarations of their nodes in libraries and models."""
