# SPDX-License-Identifier: Apache-2.0
"""`python docs/readme_pictures.py [FOLDER]`: draw the pictures of the README that the command line draws, in light and
dark.

The pictures of editors are made by `npm run e2e -- --pictures` in `vscode-extension/`.
"""

from __future__ import annotations

import sys
from pathlib import Path

from as2fm_lsp.cli.main import run

ROOT = Path(__file__).resolve().parents[1]
PICTURES = ROOT / "docs/pictures"
EXAMPLES = ROOT / "examples"
THEMES = ("light", "dark")
GRAPH = ("draw", str(EXAMPLES / "delivery_robot/main.xml"))
RUN = ("simulate", str(EXAMPLES / "assembly_robot/main_with_bug.xml"), "--property", "never_placed_empty")
RUN += ("--until", "never_placed_empty", "--seed", "0", "--trace", "20")


def main(folder: Path = PICTURES) -> None:
    for theme in THEMES:
        graph, timeline = (str(folder / f"readme_{name}_{theme}.svg") for name in ("graph", "timeline"))
        for command in ((*GRAPH, "-o", graph), (*RUN, "--svg", timeline)):
            status = run([*command, "--theme", theme, "--quiet"])
            assert status == 0, command


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
