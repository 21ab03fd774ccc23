# SPDX-License-Identifier: Apache-2.0
"""Representations of models and their traces for users: diagrams as DOT, Mermaid or PlantUML, and stories as text."""
