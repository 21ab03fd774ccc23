# SPDX-License-Identifier: Apache-2.0
"""Writes plots into files: SVG, HTML or PDF, as the name of the file says."""

from __future__ import annotations

import os
from collections.abc import Sequence

from as2fm_lsp.outputs import OutputFiles
from roaml.figures.plot import HeatMap, LinePlot, plot_page, plot_pdf, plot_svg


def write_plots(
    outputs: OutputFiles, path: str, plots: Sequence[LinePlot | HeatMap], theme: str, title: str, body: str = ""
) -> None:
    """Write plots into a page, or into one file for each. Several files have numbers behind the name of `path`.

    Args:
        title, body: the title of a page, and the HTML below its plots.

    Raises:
        OSError: a file cannot be written.
    """
    if path.endswith(".html"):
        outputs.write(path, plot_page(title, plots, body))
        return
    stem, suffix = os.path.splitext(path)
    for number, plot in enumerate(plots, 1):
        name = path if len(plots) == 1 else f"{stem}_{number}{suffix}"
        outputs.write(name, plot_pdf(plot) if suffix == ".pdf" else plot_svg(plot, theme))
