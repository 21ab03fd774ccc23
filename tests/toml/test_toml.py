# SPDX-License-Identifier: Apache-2.0
"""Places in TOML: the text at the position of a value is that value."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.text import Span
from roaml.toml import Path, TomlError, loads, places

DOCUMENTS = [
    "",
    "# nothing\n",
    "a = 1",
    "a = 1 # one\r\nb = 'two' # 'x'\r\n",
    'a.b."c.d" = [1, [2, "]"], { x = 1, y.z = "}" }]\n',
    "[a]\nb = 1\n[a.c]\nd = 1979-05-27 07:32:00\n[[e]]\nf = 1\n[[e]]\nf = 2\n[e.g]\nh = 3\n",
    "[[a]]\n[[a.b]]\nx = 1\n[[a.b]]\nx = 2\n[[a]]\n[[a.b]]\nx = 3\n",
    'a = """x"y""]"""\nb = \'\'\'it\'s\'\'\'\nc = """\nlines\\\n  on"""""\nd = ""\ne = \'\'\n',
    '"quoted \\u0041" = true\n\'li#teral\' = "\\"" # "\n',
    "a = [ # first\n 1, # one ]\n\n 2 ,\n]\nb = {}\nc = []\n",
    f"a = {'[' * 20}1{']' * 20}\nb = {'{ x = ' * 20}'}}'{' }' * 20}\nc = 3\n",
]


@pytest.mark.parametrize("text", DOCUMENTS)
def test_places_of_values(text: str) -> None:
    assert_places(text)


KEYS = st.text("ab-_ .\"'#=[]\n\\é", min_size=1, max_size=4)
SCALARS = (
    st.integers() | st.booleans() | st.text("ab\"'\\\n#]},={[ \té", max_size=6) | st.floats(allow_nan=False, width=32)
)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3), max_leaves=8
)


@given(st.dictionaries(KEYS, VALUES, max_size=4), st.sampled_from(["", " ", "\t"]), st.sampled_from(["\n", "\r\n"]))
def test_places_in_any_document(table: dict[str, Any], space: str, end: str) -> None:
    lines = [f"{quoted(key)}{space}={space}{written(value, space)}{space}# ]}}'\"" for key, value in table.items()]
    text = end.join(lines)
    assert loads(text) == table
    assert_places(text)


def quoted(text: str) -> str:
    escapes = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t"}
    return '"' + "".join(escapes.get(character, character) for character in text) + '"'


def written(value: Any, space: str) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return quoted(value)
        case float():
            return repr(value)
        case list():
            return f"[{space}{f',{space}'.join(written(item, space) for item in value)}{space}]"
        case dict():
            inner = (f"{quoted(key)}{space}={space}{written(item, space)}" for key, item in value.items())
            return f"{{{space}{f',{space}'.join(inner)}{space}}}"
    return str(value)


def assert_places(text: str) -> None:
    table, known = loads(text), places(text)
    for path, value in everything(table, ()):
        if path in known.keys:
            span = known.keys[path]
            assert list(loads(f"{text[span.start : span.end]} = 0")) == [path[-1]]
        if len(path) <= 8:
            assert path in known.values or isinstance(value, dict), path
        span = known.values.get(path)
        if span is not None and not is_header(text, span):
            assert loads(f"x = {text[span.start : span.end]}")["x"] == value, path


def is_header(text: str, span: Span) -> bool:
    """Whether a table has its header as its place, `[a]` or `[[a]]` at the beginning of a line."""
    return text[span.start] == "[" and not text[: span.start].rpartition("\n")[2].strip()


def everything(value: Any, path: Path) -> list[tuple[Path, Any]]:
    rows = [(path, value)] if path else []
    items: Any = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        rows += everything(inner, (*path, key))
    return [row for row in rows if row[0]]


@pytest.mark.parametrize(
    ("text", "offset"),
    [("a = ", 2), ("a = 1\r\nb == 2", 10), ("x = [1,\n", 6), ("a = 1\na = 2", 10), ("", None), ("\n\n[", 2)],
)
def test_the_place_of_a_mistake(text: str, offset: int | None) -> None:
    if offset is None:
        assert loads(text) == {}
        return
    with pytest.raises(TomlError) as raised:
        loads(text)
    assert raised.value.span.start == offset
    assert "line" not in str(raised.value)


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["a"] * 20_000) + " = 1",
        "[" + " . ".join(['"a.b"'] * 20_000) + "]",
        "a = { " + ".".join(["b"] * 21) + " = 1 }",
    ],
    ids=["key", "header", "inline table"],
)
def test_a_key_with_many_parts_is_refused(text: str) -> None:
    with pytest.raises(TomlError, match="at most 20 are supported"):
        loads(text)


@pytest.mark.parametrize("quoted", ["'{}'", '"{}"', "'''{}'''", '"""{}\n{}"""', "1 # {}", "[1, '{}']"])
def test_many_dots_outside_of_keys_are_allowed(quoted: str) -> None:
    assert "a" in loads(f"a = {quoted.replace('{}', 'x.' * 100)}")
