# SPDX-License-Identifier: Apache-2.0
"""Invariants of formatting for all models of the corpus with any damage to their white space."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Iterator

from hypothesis import given, settings
from hypothesis import strategies as st

from examples import examples
from fuzz.corpus import Model, snippets, systems
from roaml import api
from roaml.ide.formatting import can_format, format_edits
from roaml.ide.formatting.layout import FileLayout
from roaml.project.settings import Settings
from roaml.text import apply_edits
from roaml.xml_syntax import Element, Instruction, Node, Text, parse

SPACES = ["", " ", "  ", "\n", "\n\n", "\n \n\n", "\t", "\r\n", " \r\n\r\n ", "\n      ", "\n" + " " * 40]
LAYOUTS = st.builds(
    FileLayout, width=st.sampled_from([2, 4, 8]), tabs=st.booleans(), line_length=st.sampled_from([40, 100])
)
MODELS = st.sampled_from(range(10_000))


def model(number: int) -> Model:
    models = (*systems(), *snippets())
    return models[number % len(models)]


@given(MODELS, st.integers(), LAYOUTS)
@settings(max_examples=examples(150))
def test_formatting_is_idempotent_and_changes_white_space_only(number: int, seed: int, layout: FileLayout) -> None:
    chance = random.Random(seed)
    sample = model(number)
    # What a comment keeps quiet depends on its line, which formatting may change: such comments are made plain ones.
    damaged = {path: damage(chance, path, text).replace("as2fm:", "") for path, text in sample.texts.items()}
    before = check(sample, damaged)
    results = {}
    for path, text in damaged.items():
        if path in before.files:
            results[path] = apply_edits(text, format_edits(before.snapshot.analysis, path, layout))
            assert content(path, results[path]) == content(path, text)
    after = check(sample, damaged | results)
    for path, result in results.items():
        assert format_edits(after.snapshot.analysis, path, layout) == ()
        if can_format(after.snapshot.analysis, path):
            assert is_verbatim(result) or not re.search(r"[ \t]$|\n{3,}", result, re.MULTILINE)
            assert result.endswith(("\n", "\r"))
    assert findings(before) == findings(after)


def is_verbatim(text: str) -> bool:
    """Whether a file has parts that formatting does not touch."""
    root = None if text.startswith("{") else parse(text).root
    strings = [a.value for element in root.walk() for a in element.attributes] if root else []
    texts = [n.value.strip() for e in root.walk() for n in e.nodes if isinstance(n, Text)] if root else []
    return "<!" in text or "preserve" in text or any(texts) or any("\n" in string for string in strings)


def check(sample: Model, texts: dict[str, str]) -> api.CheckResult:
    return api.check([sample.main], sample.ros_paths, Settings(), texts)


def findings(result: api.CheckResult) -> list[tuple[str, str]]:
    """The findings except missing spaces, which formatting inserts, and white space before a file, which it removes."""
    mended = ("a space is missing", "must be at the very beginning")
    return sorted((d.code, d.message) for d in result.diagnostics if not any(text in d.message for text in mended))


def damage(chance: random.Random, path: str, text: str) -> str:
    """A text with other white space between its tokens."""
    places = sorted(json_gaps(text) if path.endswith((".jani", ".json")) else xml_gaps(text))
    rate = chance.choice([0, 0.02, 0.3, 1])
    parts, done = [], 0
    for start, end, least in places:
        if start < done or chance.random() >= rate:
            continue
        parts += [text[done:start], chance.choice([space for space in SPACES if len(space) >= least])]
        done = end
    return "".join([*parts, text[done:]])


def json_gaps(text: str) -> Iterator[tuple[int, int, int]]:
    try:
        json.loads(text)
    except ValueError:
        return
    for token in re.finditer(r'("(?:[^"\\]|\\.)*"|[^\s"\[\]{},:]+|[\[\]{},:])(\s*)', text):
        yield (*token.span(2), 0)


def xml_gaps(text: str) -> Iterator[tuple[int, int, int]]:
    """Start, end and minimum length of white space without meaning."""
    document = parse(text)
    if document.root is None or any(f.code == "xml-syntax" for f in document.findings):
        return
    for element in document.root.walk():
        ends = [element.name_span.end, *(a.span.end for a in element.attributes)]
        starts = [a.span.start for a in element.attributes]
        yield from ((end, start, 1) for end, start in zip(ends, starts, strict=False))
        yield (ends[-1], element.open_span.end - 1 - element.self_closing, 0)
        if element.close_span and element.close_name_span:
            yield (element.close_name_span.end, element.close_span.end - 1, 0)
        texts = [node for node in element.nodes if isinstance(node, Text)]
        if element.close_span and all(text[node.span.start : node.span.end].isspace() for node in texts):
            edges = [element.open_span.end]
            for node in element.nodes:
                if not isinstance(node, Text):
                    edges += node.span
            edges.append(element.close_span.start)
            yield from ((start, end, 0) for start, end in zip(edges[::2], edges[1::2], strict=True))


def content(path: str, text: str) -> object:
    """The text without white space between tokens."""
    if path.endswith((".jani", ".json")):
        try:
            return json.loads(text, object_pairs_hook=lambda pairs: pairs)
        except ValueError:
            return text
    return [*nodes(text, parse(text).nodes)]


def nodes(text: str, siblings: tuple[Node, ...] | list[Node]) -> Iterator[object]:
    for node in siblings:
        raw = text[node.span.start : node.span.end]
        if isinstance(node, Element):
            attributes = [
                (a.name, a.value, text[a.value_span.start - 1 : a.value_span.end + 1]) for a in node.attributes
            ]
            yield (node.prefix, node.name, attributes, node.self_closing, [*nodes(text, node.nodes)])
        elif isinstance(node, Instruction) or raw.strip():
            yield (type(node), raw)
