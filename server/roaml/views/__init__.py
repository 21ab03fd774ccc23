# SPDX-License-Identifier: Apache-2.0
"""What people see of models and their traces: diagrams as DOT, Mermaid or PlantUML, and stories in words."""
