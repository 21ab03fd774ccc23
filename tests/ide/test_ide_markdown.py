# SPDX-License-Identifier: Apache-2.0
"""Our Markdown in editors that show HTML: it creates no tag, picture or link, whatever the files contain."""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.sax.saxutils import escape

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from ide_case import analysis_of, path_of
from ide_models import CORNERS, ROBOT
from markdown_it import MarkdownIt

from fixture import split_files
from roaml.ide.completion import complete
from roaml.ide.completion.document import document
from roaml.ide.describe.markdown import code, file, lines, name, names, paragraphs, plain, prose
from roaml.ide.hover import hover
from roaml.ide.inlay_hints import explain, inlay_hints
from roaml.ide.signature_help import signature_help
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace
from roaml.text import Span

COMMONMARK = MarkdownIt("commonmark", {"html": True})
OURS = ("https://", "http://")
EVIL = '<img src="x" onerror="alert(1)"> <!-- --> <a@b.c> ![p](x.png) [l](x) [r]: x `<b>` \\`<i>` &lt;b&gt; ```'


def active_markup(text: str) -> list[str]:
    """The tags, pictures and links that a Markdown parser finds."""
    active = []
    for token in COMMONMARK.parse(text):
        for inner in (token, *(token.children or ())):
            if inner.type in ("html_inline", "html_block", "image", "link_open"):
                active.append(f"{inner.type}: {inner.content or inner.attrs}")
    return active


def test_the_reader_finds_them() -> None:
    assert {token.partition(":")[0] for token in active_markup(EVIL)} == {"html_inline", "image", "link_open"}
    assert active_markup("<div>\n\ntext")


FRAGMENTS = (
    *"ab<>&;#/!`\\*_[]():~ \n\"'=-",
    "<b>",
    "</b>",
    "<!--",
    "![x](",
    "[x](y)",
    "&lt;",
    "\n\n",
    "```",
    "<a:b>",
    "`<i>`",
    "\\`",
)
anything = st.lists(st.sampled_from(FRAGMENTS), max_size=12).map("".join)


@given(anything, anything, anything)
@example("`<i>``<i>`", "[x](y)`<i>`", "")
@example("[x]`(y)<i>`", "", "")
def test_pieces(first: str, second: str, third: str) -> None:
    """In any combination of the pieces."""
    made = paragraphs(lines(prose(first), name(second), file(third)), lines(names([first, third]), prose(second)))
    assert active_markup(made) == []
    assert active_markup(paragraphs(prose(first), code(second), prose(third))) == []


PROSE = [
    # as a user writes it, as Markdown, as it is read
    ("speed [m/s], at `speed_limit`", None, "speed [m/s], at speed_limit"),
    ("a < b && c > d", "a &lt; b && c > d", "a < b && c > d"),
    ("if `a < b` holds", "if a &lt; b holds", "if a < b holds"),
    ("<b>bold</b>", "&lt;b>bold&lt;/b>", "<b>bold</b>"),
    ("&lt;b&gt;", "&amp;lt;b&amp;gt;", "&lt;b&gt;"),
    ("![x](http://a/b.png)", r"\![x\](http://a/b.png)", "![x](http://a/b.png)"),
    ("one\ntwo\n\nthree", "one two\n\nthree", "one two\n\nthree"),
    ("# no heading", r"\# no heading", "# no heading"),
    ("```\nno block", r"\`\`\` no block", "``` no block"),
    ("a lone ` here", r"a lone \` here", "a lone ` here"),
]


@pytest.mark.parametrize(("written", "markdown", "read"), PROSE)
def test_prose(written: str, markdown: str | None, read: str) -> None:
    assert prose(written) == (markdown or written)
    assert plain(prose(written)).replace("&gt;", ">") == read.replace("&gt;", ">")


def hostile(text: str, suffix: str, pattern: str) -> str:
    """A model whose names end with a suffix, and whose comments contain it."""
    if text.lstrip().startswith("<"):
        text = re.sub(
            rf'\b({pattern})="([^"]+)"', lambda m: f'{m[1]}="{m[2]}{escape(suffix, {chr(34): "&quot;"})}"', text
        )
        return re.sub(r"(<[a-z_A-Z]+[ >])", lambda m: f"<!-- {suffix.replace('--', '')} -->{m[1]}", text)
    written = suffix.replace("\\", "\\\\").replace('"', '\\"')
    return re.sub(r'"(name|comment)": "([^"]+)"', lambda m: f'"{m[1]}": "{m[2]}{written}"', text)


def shown(texts: dict[str, str]) -> Iterator[str]:
    """All descriptions of the content of files, as Markdown."""
    workspace = Workspace((), Settings())
    for path, text in texts.items():
        workspace.open(path_of(path), text)
    snapshot = workspace.snapshot()
    for path, text in texts.items():
        yield from _of_file(snapshot, path_of(path), text)


def _of_file(snapshot: Snapshot, path: str, text: str) -> Iterator[str]:
    analysis = snapshot.analysis
    for offset in range(0, len(text), 3):
        actual_hover = hover(analysis, path, offset)
        if actual_hover:
            yield actual_hover.text
        signature = signature_help(analysis, path, offset)
        if signature:
            yield signature.documentation
    for offset in range(0, len(text), 41):
        completions = complete(snapshot, path, offset)
        for item in completions.items if completions else ():
            if item.about is not None:
                yield document(analysis, item.about)
    for hint in inlay_hints(analysis, path, Span(0, len(text))):
        for part in hint.parts:
            if part.symbol is not None:
                yield explain(analysis, part.symbol).text


@pytest.mark.parametrize("suffix", ["<img src=x onerror=alert(1)>", "`<b>` ![p](x) [l](x)", "\\`<i>` <script>"])
@pytest.mark.parametrize("pattern", ["id|target|name|ID|event|key", "topic|service_name|expr|cond|location|src|type"])
@pytest.mark.parametrize("model", [ROBOT, CORNERS], ids=["robot", "corners"])
def test_texts_of_hostile_models_are_escaped(model: str, pattern: str, suffix: str) -> None:
    texts = {path: hostile(text, suffix, pattern) for path, text in split_files(model).items()}
    rendered = set(filter(None, shown(texts)))
    assert len(rendered) > 20
    for text in rendered:
        # Links of our own lead to the documents of the languages.
        assert [tag for tag in active_markup(text) if not any(ours in tag for ours in OURS)] == [], text


def test_analysis_of_hostile_models_is_one() -> None:
    """The suffix is in the descriptions, so the test above is not empty."""
    texts = {path: hostile(text, "<img>", "id|target") for path, text in split_files(ROBOT).items()}
    assert analysis_of(texts)
    assert any("<img>" in text or "&lt;img>" in text for text in shown(texts))
