# SPDX-License-Identifier: Apache-2.0
"""The style sheet of pictures in files: `figure.css`, for timelines also `timeline.css`, for plots also `plot.css`, for
comparisons of two versions also `changes.css`, with the colors of a theme.

Many programs that show SVG do not support CSS variables, so files contain the colors themselves.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from roaml.disk import resource

_FONT = "system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif"

THEMES: Mapping[str, Mapping[str, str]] = {
    "light": {
        "background": "#ffffff",
        "text": "#1f2328",
        "muted": "#57606a",
        "card": "#f6f8fa",
        "border": "#c4cbd3",
        "on-tone": "#ffffff",
        "green": "#1a7f37",
        "blue": "#0969da",
        "purple": "#8250df",
        "orange": "#bc4c00",
        "red": "#cf222e",
        "yellow": "#8a6100",
        "cyan": "#0b7285",
    },
    "dark": {
        "background": "#1f1f1f",
        "text": "#e6e6e6",
        "muted": "#a5a5a5",
        "card": "#2a2a2b",
        "border": "#55585d",
        "on-tone": "#1f1f1f",
        "green": "#89d185",
        "blue": "#6cb6ff",
        "purple": "#c8a2ff",
        "orange": "#f0a45d",
        "red": "#ff8b85",
        "yellow": "#e5c454",
        "cyan": "#5fd3e0",
    },
    "high-contrast": {
        "background": "#000000",
        "text": "#ffffff",
        "muted": "#ffffff",
        "card": "#000000",
        "border": "#ffffff",
        "on-tone": "#000000",
        "green": "#89d185",
        "blue": "#6fc3df",
        "purple": "#d7afff",
        "orange": "#ffb266",
        "red": "#ff9b94",
        "yellow": "#ffe066",
        "cyan": "#5ff0e0",
    },
    "high-contrast-light": {
        "background": "#ffffff",
        "text": "#000000",
        "muted": "#292929",
        "card": "#ffffff",
        "border": "#0f4a85",
        "on-tone": "#ffffff",
        "green": "#0b5c1e",
        "blue": "#0f4a85",
        "purple": "#5b2a9d",
        "orange": "#8a3500",
        "red": "#a1121d",
        "yellow": "#5f4300",
        "cyan": "#00525e",
    },
}
"""The colors of each theme, by the names of the CSS variables `--figure-NAME` without the prefix."""


AUTOMATIC = "auto"
"""The theme of a file that is light, or dark if the reader prefers dark colors."""


def file_style(theme: str, names: tuple[str, ...]) -> str:
    """The style sheet of a file, for a theme or for `AUTOMATIC`."""
    if theme != AUTOMATIC:
        return style_sheet(theme, names)
    dark = f"{style_sheet('dark', names)}.paper {{ fill: {THEMES['dark']['background']}; }}\n"
    return f"{style_sheet('light', names)}@media (prefers-color-scheme: dark) {{\n{dark}}}\n"


def contrast_style(names: tuple[str, ...]) -> str:
    """What follows the pictures of a page, whose theme is `AUTOMATIC`, for readers who prefer a high contrast."""

    def rules(theme: str) -> str:
        background = THEMES[theme]["background"]
        return f"{style_sheet(theme, names)}:root {{ background: {background}; }}\n.paper {{ fill: {background}; }}\n"

    return (
        f"@media (prefers-contrast: more) {{\n{rules('high-contrast-light')}}}\n"
        f"@media (prefers-contrast: more) and (prefers-color-scheme: dark) {{\n{rules('high-contrast')}}}\n"
    )


@cache
def style_sheet(theme: str, names: tuple[str, ...]) -> str:
    """The style sheet of a file, with the colors of a theme. A rule that uses a tone is written once for every tone.

    Args:
        names: the style sheets in this folder.
    """
    css = "".join(resource(__package__, name) for name in names)
    css = re.sub(r"/\*.*?\*/", "", css, flags=re.DOTALL)
    values = {f"--figure-{name}": color for name, color in THEMES[theme].items()} | {"--figure-font": _FONT}
    css = re.sub(r"var\((--figure-[\w-]+)\)", lambda match: values[match[1]], css)
    rules = re.findall(r"([^{}]+)\{([^{}]*)\}", css)
    tones = {
        selector.strip(): body.split(":", 1)[1].strip(" ;")
        for selectors, body in rules
        if "--tone:" in body
        for selector in selectors.split(",")
    }
    return "".join(_written(selectors, body, tones) for selectors, body in rules if "--tone:" not in body)


def _written(selectors: str, body: str, tones: Mapping[str, str]) -> str:
    selectors, body = " ".join(selectors.split()), " ".join(body.split())
    if "var(--tone)" not in body:
        return f"{selectors} {{ {body} }}\n"
    rest = "; ".join(part.strip() for part in body.split(";") if part.strip() and "var(--tone)" not in part)
    toned = [part.strip() for part in body.split(";") if "var(--tone)" in part]
    general = f"{selectors} {{ {rest} }}\n" if rest else ""
    return general + "".join(
        f"{', '.join(_within(tone, s.strip()) for s in selectors.split(','))} "
        f"{{ {'; '.join(part.replace('var(--tone)', color) for part in toned)} }}\n"
        for tone, color in tones.items()
    )


def _within(tone: str, selector: str) -> str:
    """A selector, restricted to the parts of a group that has a tone."""
    scene, _, rest = selector.partition(" ")
    group, arrow, part = rest.partition(" > ")
    return f"{scene} {group}{tone} > {part}" if arrow else f"{scene} {tone} > {group}"
