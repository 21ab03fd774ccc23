# SPDX-License-Identifier: Apache-2.0
"""Rules about JSON files: syntax, JSON Schemas of structs, and the form of JANI properties."""
