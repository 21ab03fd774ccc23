# SPDX-License-Identifier: Apache-2.0
"""Drawings as PDF: the structure of the file, and its content compared with the SVG file."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
import zlib

import pytest

from roaml.figures.drawing import Drawing, Group, Item, Outline, Polyline, Shape, TextItem, Tone
from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.pdf import pdf_file
from roaml.figures.svg import TIMELINE_STYLES, svg_file
from roaml.figures.themes import THEMES

SYMBOLS = {0xAE: "→", 0xA3: "≤"}


def one_group(*items: Item, tone: Tone = Tone.ROS) -> Drawing:
    return Drawing(Extent(200.0, 100.0), (Group("node", tone, items),), {})


def content(pdf: bytes) -> list[str]:
    """The operators of the page."""
    stream = re.search(rb"/FlateDecode >>\nstream\n(.*?)\nendstream", pdf, re.DOTALL)
    assert stream
    return zlib.decompress(stream[1]).decode("ascii").splitlines()


def texts(pdf: bytes) -> list[str]:
    """The texts of the page, with the font of each part."""
    result: list[str] = []
    for line in content(pdf):
        if line == "BT":
            result.append("")
        elif shown := re.fullmatch(r"/F(\d) [\d.]+ Tf <(\w*)> Tj", line):
            codes = bytes.fromhex(shown[2])
            result[-1] += "".join(SYMBOLS[code] for code in codes) if shown[1] == "2" else codes.decode("cp1252")
    return result


def color(name: str, theme: str = "light") -> str:
    value = THEMES[theme][name]
    return " ".join(f"{int(value[i : i + 2], 16) / 255:.3f}".rstrip("0").rstrip(".") for i in (1, 3, 5))


def test_the_table_leads_to_all_objects() -> None:
    pdf = pdf_file(svg_file(one_group(TextItem("a", 1.0, 2.0, 12.0, "text")), "a title – ü"))
    assert pdf.startswith(b"%PDF-1.4\n")
    table = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", pdf)[1])  # type: ignore[index]
    assert pdf[table:].startswith(b"xref\n0 9\n")
    places = [int(place) for place in re.findall(rb"(\d{10}) 00000 n", pdf[table:])]
    assert [pdf[place:].split(b"\n", 1)[0] for place in places] == [b"%d 0 obj" % n for n in range(1, 9)]
    assert ("\ufeff" + "a title – ü").encode("utf-16-be").hex().encode() in pdf
    # The margin of the SVG file is 16 pixels; a pixel has three quarters of a point.
    assert b"/MediaBox [0 0 174 99]" in pdf
    assert content(pdf)[0] == "0.75 0 0 -0.75 12 87 cm"


def test_texts_are_those_of_the_svg_file() -> None:
    words = ["count := count + 1", "é € …", "a → b ≤ 3", "x (\\) y"]
    svg = svg_file(one_group(*(TextItem(word, 1.0, 20.0, 12.0, "text") for word in words)), "texts")
    assert [element.text for element in ET.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")] == words
    assert texts(pdf_file(svg)) == words
    missing = svg_file(one_group(TextItem("日本 5", 1.0, 2.0, 12.0, "text")), "texts")
    assert texts(pdf_file(missing)) == ["?? 5"]


def test_bold_and_muted_texts() -> None:
    items = (TextItem("title", 1.0, 20.0, 14.0, "text", bold=True), TextItem("note", 1.0, 40.5, 12.0, "muted"))
    lines = content(pdf_file(svg_file(one_group(*items), "texts")))
    title = lines.index(f"/F1 14 Tf <{b'title'.hex()}> Tj")
    note = lines.index(f"/F0 12 Tf <{b'note'.hex()}> Tj")
    assert lines[title - 2 : title] == [f"{color('text')} rg", "1 0 0 -1 1 20 Tm"]
    assert lines[note - 2 : note] == [f"{color('muted')} rg", "1 0 0 -1 1 40.5 Tm"]


@pytest.mark.parametrize("theme", THEMES)
def test_shapes_and_lines_have_the_colors_of_the_style_sheet(theme: str) -> None:
    line = Polyline((Point(0.0, 0.0), Point(50.0, 0.0), Point(50.0, 50.0)), has_arrow=True)
    items = (Shape(Box(10.0, 10.0, 60.0, 30.0), Outline.ROUNDED, "card"), line)
    lines = content(pdf_file(svg_file(one_group(*items), "shapes", theme)))
    drawn = "\n".join(lines).split("q\n")[1:]
    background, card, curve, head = drawn
    assert background.startswith(f"{color('background', theme)} rg\n-16 -16 232 132 re\nf")
    assert f"{color('card', theme)} rg\n{color('blue', theme)} RG\n1.25 w" in card
    assert card.count(" c\n") == 4
    assert card.endswith("h\nB\nQ\n")
    # The line bends once, with a radius of 6 pixels; it ends in the middle of the arrow head.
    assert f"{color('blue', theme)} RG\n1.5 w" in curve
    assert curve.endswith("0 0 m\n44 0 l\n48 0 50 2 50 6 c\n50 45.5 l\nS\nQ\n")
    assert f"{color('blue', theme)} rg\n50 50 m\n45.5 41 l\n54.5 41 l\nh\nf" in head


def test_areas_and_rules_of_timelines_are_translucent() -> None:
    items = (
        Shape(Box(0.0, 0.0, 60.0, 20.0), Outline.RECTANGLE, "span"),
        Shape(Box(60.0, 0.0, 6.0, 20.0), Outline.RECTANGLE, "busy"),
    )
    rule = Group("axis", Tone.PLAIN, (Polyline((Point(5.0, 0.0), Point(5.0, 90.0)), role="rule"),))
    drawing = Drawing(Extent(200.0, 100.0), (rule, Group("state", Tone.RUNNING, items)), {})
    pdf = pdf_file(svg_file(drawing, "run", "light", TIMELINE_STYLES))
    states = b"/G0 << /ca 1 /CA 0.25 >> /G1 << /ca 0.18 /CA 1 >> /G2 << /ca 0.55 /CA 1 >>"
    assert b"/ExtGState << " + states + b" >>" in pdf
    lines = content(pdf)
    for state, following in (
        ("/G0", f"{color('muted')} RG"),
        ("/G1", f"{color('orange')} rg"),
        ("/G2", f"{color('orange')} rg"),
    ):
        assert lines[lines.index(f"{state} gs") + 1] == following


def test_unknown_elements_are_an_error() -> None:
    svg = svg_file(one_group(), "none").replace("</svg>", '<circle r="3"/></svg>')
    with pytest.raises(ValueError, match="circle"):
        pdf_file(svg)
