# SPDX-License-Identifier: Apache-2.0
"""Representations of models and traces for users: diagrams as DOT, Mermaid or PlantUML, and explanations of traces as
text."""
