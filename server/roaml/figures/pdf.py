# SPDX-License-Identifier: Apache-2.0
"""Drawings as PDF, converted from the SVG files that `svg_file` writes, so that both look the same.

- The page has the size of the drawing. Lines and texts stay lines and texts.
- Texts use the fonts Helvetica and Symbol, which every program that shows PDF has. Characters that neither of them
  contains are written as `?`.
- The same drawing always leads to the same bytes.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
import zlib
from collections.abc import Iterator, Mapping, Sequence

from roaml.record import Record

_POINTS = 0.75
"""The size of a pixel in points."""
_CIRCLE = 0.5523
"""The distance of the control points of a curve that approximates a quarter of a circle, as part of the radius."""
_CAPS = {"butt": 0, "round": 1, "square": 2}
_JOINS = {"miter": 0, "round": 1, "bevel": 2}
_FONTS = ("Helvetica", "Helvetica-Bold", "Symbol")
_SYMBOLS = dict(
    zip(
        "←↑→↓↔⇐⇒⇔≤≥≠≈∞−¬∧∨∀∃∈∅πΔλεμ",
        bytes.fromhex("acadaeafabdcdedba3b3b9bba52dd8d9da2224cec670446c656d"),
        strict=True,
    )
)
"""The codes of characters in the font Symbol (ISO 32000-1, D.5)."""


def pdf_file(svg: str) -> bytes:
    """A PDF file with the page that the text of an SVG file shows.

    Args:
        svg: the text of a file that `svg_file` has written.
    """
    root = ET.fromstring(svg)
    left, top, width, height = map(float, root.attrib["viewBox"].split())
    page = _Page(_rules(_printed(next(root.iter(_SVG + "style")).text or "")))
    page.add(root, ())
    begin = f"{_POINTS} 0 0 {-_POINTS} {_n(-left * _POINTS)} {_n((top + height) * _POINTS)} cm"
    content = zlib.compress("\n".join([begin, *page.operators]).encode("latin-1"))
    title = next(root.iter(_SVG + "title")).text or ""
    fonts = " ".join(f"/F{index} {number} 0 R" for index, number in enumerate(range(6, 6 + len(_FONTS))))
    states = " ".join(f"/G{index} << /ca {fill} /CA {stroke} >>" for (fill, stroke), index in page.opacities.items())
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R >>",
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {_n(width * _POINTS)} {_n(height * _POINTS)}] /Contents 4 0 R "
        f"/Resources << /Font << {fonts} >> /ExtGState << {states} >> >> >>".encode(),
        f"<< /Length {len(content)} /Filter /FlateDecode >>\nstream\n".encode() + content + b"\nendstream",
        b"<< /Title <" + ("\ufeff" + title).encode("utf-16-be").hex().encode() + b"> >>",
        *(
            f"<< /Type /Font /Subtype /Type1 /BaseFont /{name}{'' if name == 'Symbol' else _ENCODING} >>".encode()
            for name in _FONTS
        ),
    ]
    return _assembled(objects)


def _printed(css: str) -> str:
    """The rules for a light page, without those for readers who prefer dark colors, which are the last ones."""
    return css.partition("@media")[0]


_ENCODING = " /Encoding /WinAnsiEncoding"
_SVG = "{http://www.w3.org/2000/svg}"


def _assembled(objects: Sequence[bytes]) -> bytes:
    """The file: its objects, the table of their places, and the trailer. The first one is the catalog, the fifth the
    title."""
    data = bytearray(b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n")
    places = []
    for number, content in enumerate(objects, 1):
        places.append(len(data))
        data += b"%d 0 obj\n%b\nendobj\n" % (number, content)
    table = len(data)
    data += b"xref\n0 %d\n0000000000 65535 f \n" % (len(objects) + 1)
    data += b"".join(b"%010d 00000 n \n" % place for place in places)
    data += b"trailer\n<< /Size %d /Root 1 0 R /Info 5 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (len(objects) + 1, table)
    return bytes(data)


# ------------------------------------------------------------ styles


class _Rule(Record, frozen=True):
    """A rule of the style sheet. `parts` are the parts of its selector, from left to right: the name of an element or
    its classes, and whether it must be the parent of the next part."""

    parts: tuple[tuple[frozenset[str], bool], ...]
    values: Mapping[str, str]


class _Styled(Record, frozen=True):
    """What a selector can select of an element: its name, and its classes with a dot before each."""

    words: frozenset[str]


def _rules(css: str) -> list[_Rule]:
    """The rules, those that take precedence last."""
    rules = []
    for selectors, body in re.findall(r"([^{}]+)\{([^{}]*)\}", css):
        pairs = (part.split(":", 1) for part in body.split(";") if ":" in part)
        values = {name.strip(): value.strip() for name, value in pairs}
        for selector in selectors.split(","):
            parts: list[tuple[frozenset[str], bool]] = []
            for word in selector.split():
                if word == ">":
                    parts[-1] = (parts[-1][0], True)
                else:
                    parts.append((frozenset(re.findall(r"\.[\w-]+|^\w+", word)), False))
            rules.append(_Rule(tuple(parts), values))
    return sorted(rules, key=lambda rule: sum(word.startswith(".") for words, _ in rule.parts for word in words))


def _selects(rule: _Rule, element: _Styled, around: Sequence[_Styled]) -> bool:
    """Whether a rule applies to an element that is inside others, the outermost first."""
    *outer, (words, _) = rule.parts
    if not words <= element.words:
        return False
    place = len(around)
    for words, is_parent in reversed(outer):
        candidates = (place - 1,) if is_parent else range(place - 1, -1, -1)
        place = next((i for i in candidates if i >= 0 and words <= around[i].words), -1)
        if place < 0:
            return False
    return True


# ------------------------------------------------------------ content


class _Page:
    """The operators that draw a page (ISO 32000-1, 8.2).

    Attributes:
        opacities: the opacities of areas and lines -> the number of their graphics state.
    """

    def __init__(self, rules: Sequence[_Rule]) -> None:
        self._rules = rules
        self._known: dict[tuple[_Styled, ...], Mapping[str, str]] = {}
        self.operators: list[str] = []
        self.opacities: dict[tuple[str, str], int] = {}

    def add(self, element: ET.Element, around: tuple[_Styled, ...]) -> None:
        """Draw an element and those inside it."""
        name = element.tag.removeprefix(_SVG)
        if name in ("title", "desc", "style"):
            return
        styled = _Styled(frozenset({name, *(f".{word}" for word in element.get("class", "").split())}))
        if name in ("svg", "g"):
            for child in element:
                self.add(child, (*around, styled))
            return
        style = {
            **self._style((*around, styled)),
            **({"fill": element.attrib["fill"]} if "fill" in element.attrib else {}),
        }
        if name == "text":
            self._text(element, style)
        else:
            self._paint(list(_outline(name, element.attrib)), style)

    def _style(self, path: tuple[_Styled, ...]) -> Mapping[str, str]:
        if path not in self._known:
            values: dict[str, str] = {}
            for rule in self._rules:
                if _selects(rule, path[-1], path[:-1]):
                    values.update(rule.values)
            self._known[path] = values
        return self._known[path]

    def _paint(self, outline: Sequence[str], style: Mapping[str, str]) -> None:
        fill, stroke = style.get("fill", "#000000"), style.get("stroke", "none")
        if fill == stroke == "none":
            return
        state = []
        opacity = style.get("fill-opacity", "1"), style.get("stroke-opacity", "1")
        if opacity != ("1", "1"):
            state.append(f"/G{self.opacities.setdefault(opacity, len(self.opacities))} gs")
        if fill != "none":
            state.append(f"{_color(fill)} rg")
        if stroke != "none":
            dashes = " ".join(style.get("stroke-dasharray", "").replace(",", " ").split())
            state += [f"{_color(stroke)} RG", f"{style.get('stroke-width', '1')} w", f"[{dashes}] 0 d"]
            state += [
                f"{_CAPS[style.get('stroke-linecap', 'butt')]} J",
                f"{_JOINS[style.get('stroke-linejoin', 'miter')]} j",
            ]
        operator = "S" if fill == "none" else "f" if stroke == "none" else "B"
        self.operators += ["q", *state, *outline, operator, "Q"]

    def _text(self, element: ET.Element, style: Mapping[str, str]) -> None:
        size = element.attrib["font-size"]
        font = 1 if style.get("font-weight") == "700" else 0
        place = f"1 0 0 -1 {element.attrib['x']} {element.attrib['y']} Tm"
        shown = [
            f"/F{2 if is_symbol else font} {size} Tf <{codes.hex()}> Tj"
            for is_symbol, codes in _runs(element.text or "")
        ]
        self.operators += ["BT", f"{_color(style.get('fill', '#000000'))} rg", place, *shown, "ET"]


def _runs(text: str) -> Iterator[tuple[bool, bytes]]:
    """The parts of a text in one font: whether it is Symbol, and the codes of the characters."""
    for run in re.findall(f"[{''.join(_SYMBOLS)}]+|[^{''.join(_SYMBOLS)}]+", text):
        is_symbol = run[0] in _SYMBOLS
        yield is_symbol, bytes(_SYMBOLS[c] for c in run) if is_symbol else run.encode("cp1252", "replace")


def _outline(name: str, attributes: Mapping[str, str]) -> Iterator[str]:
    """The operators that construct the outline of a shape or line."""
    match name:
        case "rect":
            x, y, width, height = (float(attributes[key]) for key in ("x", "y", "width", "height"))
            yield from _rectangle(x, y, width, height, float(attributes.get("rx", "0")))
        case "polygon" | "polyline":
            points = [point.replace(",", " ") for point in attributes["points"].split()]
            yield f"{points[0]} m"
            yield from (f"{point} l" for point in points[1:])
            if name == "polygon":
                yield "h"
        case "path":
            yield from _path(attributes["d"])
        case _:
            raise ValueError(f"`<{name}>` is not an element of drawings")


def _path(data: str) -> Iterator[str]:
    x = y = 0.0
    for letter, numbers in re.findall(r"([MLQ])([^MLQ]*)", data):
        values = [float(number) for number in numbers.split()]
        if letter == "Q":  # PDF has only cubic curves
            bend_x, bend_y, end_x, end_y = values
            controls = [x + (bend_x - x) * 2 / 3, y + (bend_y - y) * 2 / 3]
            controls += [end_x + (bend_x - end_x) * 2 / 3, end_y + (bend_y - end_y) * 2 / 3]
            yield " ".join(map(_n, (*controls, end_x, end_y))) + " c"
        else:
            yield f"{_n(values[0])} {_n(values[1])} {'m' if letter == 'M' else 'l'}"
        x, y = values[-2:]


def _rectangle(x: float, y: float, width: float, height: float, radius: float) -> Iterator[str]:
    radius = min(radius, width / 2, height / 2)
    if radius <= 0:
        yield " ".join(map(_n, (x, y, width, height))) + " re"
        return
    right, bottom, near = x + width, y + height, radius * (1 - _CIRCLE)
    yield f"{_n(x + radius)} {_n(y)} m"
    for line, curve in (
        ((right - radius, y), (right - near, y, right, y + near, right, y + radius)),
        ((right, bottom - radius), (right, bottom - near, right - near, bottom, right - radius, bottom)),
        ((x + radius, bottom), (x + near, bottom, x, bottom - near, x, bottom - radius)),
        ((x, y + radius), (x, y + near, x + near, y, x + radius, y)),
    ):
        yield f"{_n(line[0])} {_n(line[1])} l"
        yield " ".join(map(_n, curve)) + " c"
    yield "h"


def _color(color: str) -> str:
    """The red, green and blue parts of a color such as `#1a7f37`, from 0 to 1."""
    return " ".join(_n(int(color[start : start + 2], 16) / 255) for start in (1, 3, 5))


def _n(number: float) -> str:
    """A number without exponent, as PDF requires."""
    return f"{number:.3f}".rstrip("0").rstrip(".")
