# SPDX-License-Identifier: Apache-2.0
"""The HTML page that `verify --explain` and `simulate --html` write."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.model_arguments import line_of
from roaml.jani.node import Origin
from roaml.smc.story import Story
from roaml.verification.target import VerificationTarget
from roaml.views.parting import Parting
from roaml.views.story import as_html


def story_page(
    stories: Sequence[Story],
    target: VerificationTarget,
    main: str,
    near: Mapping[str, tuple[Parting, Story]] = MappingProxyType({}),
) -> str:
    """The HTML page with the explanations of traces. Its paths are relative to the folder of the main file."""
    folder = os.path.dirname(os.path.abspath(main))

    def place_of(origin: Origin) -> str:
        return line_of(target, origin, folder)

    def file_of(origin: Origin) -> str:
        return line_of(target, origin)

    return as_html(stories, place_of, shown_path(main, os.path.dirname(folder)), near, file_of)
