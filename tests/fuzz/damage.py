# SPDX-License-Identifier: Apache-2.0
"""Functions that damage a text. Each takes random numbers from a `Random` and returns the new text, which only depends
on them.

- Bytes: changes that a disk, a merge or an editor can make to a file.
- Pieces: characters and words that have a meaning in one of the languages, in the wrong place or many times.
- Elements and attributes: well-formed XML with another meaning.
- JSON and lines: the same for property files, JSON structs and ROS interface definitions.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from random import Random
from typing import Any, TypeAlias

from fuzz.elements import attributes_of, elements_of, piece, put
from roaml.text import Span, decode
from roaml.xml_syntax.escapes import escape

Damage: TypeAlias = Callable[[Random, str, Sequence[str]], str]
"""(random, text, other texts) -> damaged text."""

MARKUP = ["<", ">", "/", "/>", "</", '"', "'", "=", "&", "<!--", "-->", "<![CDATA[", "]]>", "<?xml?>", "?>", "</state>"]
MARKUP += [
    "&lt;",
    "&amp;",
    "&#0;",
    "&#x110000;",
    "&bomb;",
    "<!DOCTYPE a [<!ENTITY b 'c'>]>",
    '<transition event="',
    "x:",
]
MARKUP += [
    "<state",
    "<state id=",
    "<!-- as2fm: ignore",
    'xmlns="..."',
    'xmlns:x="u"',
    'id="s"',
    "ascxml",
    "root",
    "types",
]
CHARACTERS = [
    "\0",
    "\ufeff",
    "\ud800",
    "\uffff",
    "\r",
    "\n",
    "\t",
    " ",
    "\u00a0",
    "\u2028",
    "\x1b",
    "é",
    "\U0001f600",
    "٣",
]
CHARACTERS += ["\u202e", "²", "ﬁ", "\\", "#", "$", "@", "`", "~"]
OPERATORS = [
    "||",
    "&amp;&amp;",
    "==",
    "!=",
    "&lt;",
    "<=",
    ">",
    "+",
    "-",
    "*",
    "/",
    "%",
    "**",
    "=",
    "!",
    "?",
    "? 1 :",
    "|",
    "++",
]
OPERANDS = [
    "_msg",
    "_msg.",
    "_event.data.x",
    "_wrapped_result.code",
    "_bt.status",
    "SUCCESS",
    "true",
    "null",
    "'a'",
    "'",
    "[1, 2]",
]
OPERANDS += [
    "Math.random()",
    "Math.PI",
    "Math.max(1,",
    "{'a': 1}",
    "[]",
    "(",
    ")",
    "[",
    "]",
    ",",
    ".",
    ".length",
    "[0]",
    "[-1]",
]
NUMBERS = [
    "0",
    "-1",
    "0.0",
    "1.5",
    "1e400",
    "1e308",
    "9" * 30,
    "9" * 5000,
    "0x",
    "0" + "9" * 5000,
    "0x" + "f" * 4500,
    "1e-400",
]
NUMBERS += ["NaN", "2147483648", "99999", "-0.0", "010"]
TYPES = [
    "int32",
    "int32[]",
    "int32[0]",
    "int32[99999999999]",
    "string",
    "string[2][]",
    "float64[][][]",
    "bool",
    "uint64[3]",
]
TYPES += ["std_msgs/Int32", "std_msgs/msg/Int32", "a/b/c/d", "Point2D[2]", "string<=3", "int32[<=2]"]
NAMES = [
    "{goal}",
    "{=}",
    "{@x}",
    "{",
    "}",
    ":",
    ";",
    "RUNNING",
    "SubTree",
    "Sequence",
    '"type": "object"',
    '"properties"',
    "main",
]
NAMES += [
    "../..",
    "/dev/zero",
    "/dev/stdin",
    ".",
    "/",
    "main.xml",
    "tree.xml",
    "file:///etc/passwd",
    "a\0b",
    "http://a.b/c",
    "~",
]
PIECES = [*MARKUP, *CHARACTERS, *OPERATORS, *OPERANDS, *NUMBERS, *TYPES, *NAMES]
_LONG = [
    "<a>",
    "<a ",
    " a='1'",
    "<a b='",
    "a.",
    "a[",
    "-",
    "1+",
    "(a)+",
    "a?b:",
    "[[1],",
    "{'a':",
    "(",
    " ",
    " ",
    "\n",
    "\t",
]
_LONG += [
    "a",
    "ab",
    "&amp;",
    "&",
    "\\'",
    "'",
    ",",
    "[,",
    "/",
    "{a} ",
    "0",
    "é",
    "--",
    "]]",
    "x:",
    "/a",
    "a/",
    "[1]",
    "[]",
]
_WORD = re.compile(r"[A-Za-z_][\w.]*|\d+(?:\.\d+)?")


# ----------------------------------------------------------------------- bytes


def flip_bytes(random: Random, text: str, others: Sequence[str]) -> str:
    data = bytearray(_bytes(text))
    for _ in range(random.randint(1, 8)):
        if data:
            data[random.randrange(len(data))] = random.randrange(256)
    return decode("", bytes(data)).text


def insert_bytes(random: Random, text: str, others: Sequence[str]) -> str:
    data = _bytes(text)
    at = random.randint(0, len(data)) if random.random() < 0.7 else 0
    more = random.choice(
        [b"\xff\xfe", b"\xfe\xff", b"\xef\xbb\xbf", b"\0\0", b"\xc3", b"\xed\xa0\x80", random.randbytes(9)]
    )
    return decode("", data[:at] + more + data[at:]).text


def other_encoding(random: Random, text: str, others: Sequence[str]) -> str:
    encoding = random.choice(["utf-16", "utf-16-le", "utf-32", "latin-1", "cp037", "utf-7"])
    return decode("", text.encode(encoding, "replace")).text


def cut(random: Random, text: str, others: Sequence[str]) -> str:
    start, end = _range(random, text)
    return random.choice([text[:start], text[end:], text[:start] + text[end:]])


def repeat(random: Random, text: str, others: Sequence[str]) -> str:
    start, end = _range(random, text)
    return text[:end] + text[start:end] * random.choice([1, 1, 2, 30]) + text[end:]


def line_ends(random: Random, text: str, others: Sequence[str]) -> str:
    return re.sub(r"\r?\n", lambda _: random.choice(["\n", "\r\n", "\r", "\n\r"]), text)


# ---------------------------------------------------------------------- pieces


def insert_pieces(random: Random, text: str, others: Sequence[str]) -> str:
    for _ in range(random.randint(1, 4)):
        at = random.randint(0, len(text))
        text = text[:at] + random.choice(PIECES) + text[at + random.choice([0, 0, 0, 1, 5]) :]
    return text


def stretch(random: Random, text: str, others: Sequence[str]) -> str:
    """Repeat one piece many times: nesting, long values, long lines."""
    start, end = _value(random, text) if random.random() < 0.7 else _range(random, text)
    piece = random.choice([random.choice(PIECES), random.choice(_LONG)])
    many = (piece * random.choice([60, 200, 3000, 20_000]))[:60_000]
    return text[:start] + many + text[random.choice([start, end]) :]


def rename(random: Random, text: str, others: Sequence[str]) -> str:
    """Replace a word by another one of the same file, everywhere or once."""
    words = _WORD.findall(text)
    if not words:
        return text
    old, new = random.choice(words), random.choice([*words[:50], random.choice(words), random.choice(PIECES)])
    return text.replace(old, new, random.choice([1, 1, -1]))


def change_words(random: Random, text: str, others: Sequence[str]) -> str:
    words = list(_WORD.finditer(text))
    for _ in range(random.randint(1, 5)):
        if words:
            one, new = random.choice(words), random.choice([random.choice(words)[0], random.choice(PIECES)])
            text = text[: one.start()] + new + text[one.end() :]
    return text


def shuffle_lines(random: Random, text: str, others: Sequence[str]) -> str:
    lines = text.splitlines(keepends=True)
    for _ in range(random.randint(1, 4)):
        if lines:
            line = lines.pop(random.randrange(len(lines)))
            lines.insert(random.randint(0, len(lines)), line)
            if random.random() < 0.3:
                lines.insert(random.randint(0, len(lines)), line)
    return "".join(lines)


def another_file(random: Random, text: str, others: Sequence[str]) -> str:
    """The text of another file, or a part of it."""
    other = random.choice(others) if others else ""
    if random.random() < 0.3:
        return other
    start, end = _range(random, other)
    at = random.randint(0, len(text))
    return text[:at] + other[start:end] + text[at:]


# ------------------------------------------------------- elements and attributes


def change_elements(random: Random, text: str, others: Sequence[str]) -> str:
    for _ in range(random.randint(1, 3)):
        elements = elements_of(text)
        if not elements:
            break
        one = random.choice(elements).span
        other_text = random.choice([text, random.choice(others) if others else text])
        other = random.choice(elements_of(other_text) or elements[:1]).span
        written = piece(other_text, other)[:20_000]
        match random.randrange(6):
            case 0:
                text = text[: one.start] + text[one.end :]
            case 1:
                text = text[: one.end] + piece(text, one)[:20_000] + text[one.end :]
            case 2:
                text = text[: one.start] + written + text[one.end :]
            case 3:
                text = text[: one.end] + written + text[one.end :]
            case 4:
                inside = random.choice(elements)
                text = text[: inside.open_span.end] + written + text[inside.open_span.end :]
            case 5:
                depth = random.choice([1, 3, 50, 120, 400])
                name = random.choice(elements).name
                nested = f"<{name}>" * depth + piece(text, one) + f"</{name}>" * depth
                text = text[: one.start] + nested + text[one.end :]
    return text


def change_attributes(random: Random, text: str, others: Sequence[str]) -> str:
    for _ in range(random.randint(1, 4)):
        attributes = attributes_of(text)
        if not attributes:
            break
        one = random.choice(attributes)
        other_text = random.choice([text, random.choice(others) if others else text])
        other = random.choice(attributes_of(other_text) or attributes)
        match random.randrange(7):
            case 0:
                text = text[: one.span.start] + text[one.span.end :]
            case 1:
                text = text[: one.span.end] + " " + piece(text, one.span) + text[one.span.end :]
            case 2:
                text = put(text, one.name_span, other.name)
            case 3:
                text = put(text, one.value_span, escape(escape(other.value), "'"))
            case 4:
                text = put(text, one.value_span, escape(escape(random.choice(PIECES)), "'"))
            case 5:
                text = put(text, one.value_span, random.choice([random.choice(PIECES), "", " ", one.value * 30]))
            case 6:
                text = text[: one.span.end] + " " + piece(other_text, other.span) + text[one.span.end :]
    return text


def swap_values(random: Random, text: str, others: Sequence[str]) -> str:
    """Exchange values of attributes, of the same name or of any name."""
    attributes = attributes_of(text)
    if len(attributes) < 2:
        return text
    one = random.choice(attributes)
    same = [a for a in attributes if a.name == one.name and a is not one]
    first, second = sorted((one, random.choice(same or attributes)), key=lambda a: a.value_span)
    if first is second:
        return text
    parts = (text[: first.value_span.start], text[first.value_span.end : second.value_span.start])
    return "".join(
        (
            parts[0],
            piece(text, second.value_span),
            parts[1],
            piece(text, first.value_span),
            text[second.value_span.end :],
        )
    )


# ----------------------------------------------------------- expressions and types

_EXPRESSIONS = (
    "expr",
    "cond",
    "location",
    "goal_id",
    "thread_id",
    "status",
    "id",
    "prob",
    "lower_bound_incl",
    "upper_bound_incl",
)


def change_expressions(random: Random, text: str, others: Sequence[str]) -> str:
    for _ in range(random.randint(1, 3)):
        values = [a.value_span for a in attributes_of(text) if a.name in _EXPRESSIONS]
        if not values:
            break
        span = random.choice(values)
        names = sorted({a.value for a in attributes_of(text) if a.name in ("id", "name", "location")} or {"x"})
        at = random.randint(span.start, span.end)
        new = _expression(random, names, random.randint(0, 6))
        match random.randrange(5):
            case 0:
                text = put(text, span, new)
            case 1:
                text = put(text, Span(at, at), random.choice([*OPERATORS, *OPERANDS, *NUMBERS]))
            case 2:
                text = put(text, span, f"{piece(text, span)} {random.choice(OPERATORS)} {new}")
            case 3:
                text = put(text, Span(at, span.end), "")
            case 4:
                text = put(
                    text, span, f"{piece(text, span)}{random.choice(['.', '[', '(', '.x', '[0]', '.length', '()'])}"
                )
    return text


def _expression(random: Random, names: Sequence[str], depth: int) -> str:
    if depth == 0:
        return random.choice(
            [random.choice(names), random.choice(names), random.choice(OPERANDS), random.choice(NUMBERS)]
        )
    inner = [_expression(random, names, random.randrange(depth)) for _ in range(3)]
    operator = random.choice(OPERATORS[:12])
    forms = [
        f"{inner[0]} {operator} {inner[1]}",
        f"({inner[0]})",
        f"-{inner[0]}",
        f"!{inner[0]}",
        f"{inner[0]}[{inner[1]}]",
    ]
    forms += [
        f"{inner[0]} ? {inner[1]} : {inner[2]}",
        f"[{', '.join(inner)}]",
        f"{{'{names[0]}': {inner[0]}}}",
        f"{inner[0]}.x",
    ]
    forms += [
        f"Math.{random.choice(['abs', 'pow', 'log', 'random', 'sqrt'])}({', '.join(inner[: random.randrange(4)])})"
    ]
    return random.choice(forms)


def change_types(random: Random, text: str, others: Sequence[str]) -> str:
    values = [
        a.value_span for a in attributes_of(text) if a.name in ("type", "src", "path", "event", "topic", "target")
    ]
    if not values:
        return change_words(random, text, others)
    return put(text, random.choice(values), random.choice([*TYPES, *NAMES]))


# ------------------------------------------------------------------------ JSON


def change_json(random: Random, text: str, others: Sequence[str]) -> str:
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        return insert_pieces(random, text, others)
    for _ in range(random.randint(1, 4)):
        value = _change_value(random, value)
    return json.dumps(value, indent=random.choice([None, 2]), ensure_ascii=random.random() < 0.5)


def _change_value(random: Random, value: Any) -> Any:
    if isinstance(value, dict) and value and random.random() < 0.85:
        key = random.choice(list(value))
        changed = dict(value)
        match random.randrange(8):
            case 0:
                del changed[key]
            case 1:
                changed[random.choice([*value, *_WORDS])] = changed.pop(key)
            case 2:
                changed[random.choice([*value, *_WORDS])] = value[key]
            case _:
                changed[key] = _change_value(random, value[key])
        return changed
    if isinstance(value, list) and value and random.random() < 0.85:
        at = random.randrange(len(value))
        match random.randrange(6):
            case 0:
                return value[:at] + value[at + 1 :]
            case 1:
                return value * random.choice([2, 50])
            case _:
                return [*value[:at], _change_value(random, value[at]), *value[at + 1 :]]
    replacement = random.choice(
        [value, [value], {"exp": value}, *_WORDS, None, True, 0, -1, 1e308, 10**400, [], {}, "\ud800"]
    )
    if random.random() < 0.05:
        for _ in range(random.choice([20, 300])):
            replacement = random.choice([{"exp": replacement, "op": "¬"}, [replacement]])
    return replacement


_WORDS = [
    "op",
    "left",
    "right",
    "exp",
    "name",
    "properties",
    "expression",
    "type",
    "object",
    "title",
    "items",
    "$ref",
    "#",
]
_WORDS += [
    "#/definitions/a",
    "U",
    "F",
    "G",
    "∧",
    "=",
    "values",
    "fun",
    "states",
    "step-bounds",
    "upper",
    "constants",
    "x",
]


# ---------------------------------------------------------------------- choice

ANY: tuple[Damage, ...] = (
    flip_bytes,
    insert_bytes,
    other_encoding,
    cut,
    repeat,
    line_ends,
    insert_pieces,
    insert_pieces,
    stretch,
    rename,
    change_words,
    change_words,
    shuffle_lines,
    another_file,
)
XML: tuple[Damage, ...] = (
    *ANY,
    *(change_elements,) * 6,
    *(change_attributes,) * 8,
    *(change_expressions,) * 8,
    *(change_types,) * 4,
    *(swap_values,) * 3,
)
JSON: tuple[Damage, ...] = (*ANY, *(change_json,) * 14)


def ways(path: str) -> tuple[Damage, ...]:
    """The functions that can damage the file at `path`, each repeated by its weight."""
    if path.endswith((".jani", ".json")):
        return JSON
    return ANY if path.endswith((".msg", ".srv", ".action")) else XML


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")


def _range(random: Random, text: str) -> tuple[int, int]:
    start = random.randint(0, len(text))
    return start, min(len(text), start + random.choice([1, 3, 20, 200, 2000]))


def _value(random: Random, text: str) -> tuple[int, int]:
    attributes = attributes_of(text)
    return random.choice(attributes).value_span if attributes else _range(random, text)
