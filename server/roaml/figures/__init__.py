# SPDX-License-Identifier: Apache-2.0
"""Figures as geometry: sizes of texts, layouts of graphs and trees, routes of lines, SVG.

Knows nothing of models: sizes and names in, boxes and points out. All lengths are in pixels, y grows downwards. The
same input gives the same output on every machine: widths of texts come from a table, not from installed fonts.
"""
