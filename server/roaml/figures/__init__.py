# SPDX-License-Identifier: Apache-2.0
"""Figures as geometry: sizes of texts, layouts of graphs and trees, routes of lines, SVG.

The package does not depend on models: it gets sizes and names, and returns boxes and points. All lengths are in pixels,
and y grows downwards. The same input gives the same output on every machine, because widths of texts come from a table
and not from installed fonts.
"""
