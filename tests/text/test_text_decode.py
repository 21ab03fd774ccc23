# SPDX-License-Identifier: Apache-2.0
"""Bytes to text: byte order marks, declared encodings, bytes that do not fit."""

from __future__ import annotations

import codecs
import encodings.aliases

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.text import SourceFile, decode

XML = '<?xml version="1.0" encoding="{}"?>'
BYTES = [
    # bytes, text
    (b"", ""),
    (b"<a/>", "<a/>"),
    ("<ä/>".encode(), "<ä/>"),
    (codecs.BOM_UTF8 + "<ä/>".encode(), "<ä/>"),
    (codecs.BOM_UTF8, ""),
    (codecs.BOM_UTF16_LE + "<ä😀/>".encode("utf-16-le"), "<ä😀/>"),
    (codecs.BOM_UTF16_BE + "<ä😀/>".encode("utf-16-be"), "<ä😀/>"),
    (codecs.BOM_UTF32_LE + "<ä😀/>".encode("utf-32-le"), "<ä😀/>"),
    (codecs.BOM_UTF32_BE + "<ä😀/>".encode("utf-32-be"), "<ä😀/>"),
    (codecs.BOM_UTF8 + codecs.BOM_UTF8, "\ufeff"),
    (b"a\r\nb\rc\nd", "a\r\nb\rc\nd"),
    (b"a\0b", "a\0b"),
]


@pytest.mark.parametrize(("data", "text"), BYTES)
def test_decode(data: bytes, text: str) -> None:
    source = decode("x", data)
    assert source.text == text
    assert source.undecodable is None


DECLARED = [
    # declared encoding, encoding of the bytes
    ("UTF-8", "utf-8"),
    ("utf8", "utf-8"),
    ("ISO-8859-1", "latin-1"),
    ("latin1", "latin-1"),
    ("windows-1252", "cp1252"),
    ("ISO-8859-15", "iso8859-15"),
    ("KOI8-R", "utf-8"),
]


@pytest.mark.parametrize(("declared", "encoding"), DECLARED)
def test_declared_encoding(declared: str, encoding: str) -> None:
    text = XML.format(declared) + "<a b='ü'/>"
    if declared == "KOI8-R":
        text = text.replace("ü", "я")
        encoding = "koi8-r"
    source = decode("x", text.encode(encoding))
    assert (source.text, source.undecodable) == (text, None)


NOT_HONOURED = [
    # Unknown, no text encodings, or not a superset of ASCII: read as UTF-8.
    "no-such",
    "rot13",
    "hex",
    "base64",
    "undefined",
    "idna",
    "punycode",
    "unicode_escape",
    "raw_unicode_escape",
    "utf-7",
    "utf-16",
    "utf-32",
    "cp037",
    "hz",
    "aliases",
    "x" * 300,
]


@pytest.mark.parametrize("declared", NOT_HONOURED)
def test_encoding_that_is_not_honoured(declared: str) -> None:
    text = XML.format(declared) + r"<a b='ü +AGE- ~{ \u0041'/>"
    source = decode("x", text.encode())
    assert (source.text, source.undecodable) == (text, None)


def test_byte_order_mark_beats_declaration() -> None:
    text = XML.format("latin-1") + "<ü/>"
    assert decode("x", codecs.BOM_UTF8 + text.encode()).text == text


def test_declaration_counts_at_the_beginning_only() -> None:
    text = "<a/>" + XML.format("latin-1") + "ü"
    assert decode("x", text.encode()).text == text


BROKEN = [
    # bytes, text, the first of the characters that were not readable
    (b"ab\xffcd", "ab\ufffdcd", 2),
    (b"\xff", "\ufffd", 0),
    ("ä".encode() + b"\xc3", "ä\ufffd", 1),
    (b"\xe2\x82", "\ufffd", 0),
    (b"a\xed\xa0\x80", "a\ufffd\ufffd\ufffd", 1),
    (codecs.BOM_UTF8 + b"a\xff", "a\ufffd", 1),
    (codecs.BOM_UTF16_LE + b"a\0b", "a\ufffd", 1),
    (codecs.BOM_UTF16_BE + b"\xd8\x00\x00a", "\ufffda", 0),
    (XML.format("ascii").encode() + b"\xfc", XML.format("ascii") + "\ufffd", 38),
]


@pytest.mark.parametrize(("data", "text", "at"), BROKEN)
def test_bytes_that_do_not_fit(data: bytes, text: str, at: int) -> None:
    source = decode("x", data)
    assert source.text == text
    assert source.undecodable == (at, at + 1)


@given(st.binary(max_size=80), st.sampled_from(("", *sorted(encodings.aliases.aliases))))
def test_any_bytes(data: bytes, declared: str) -> None:
    source = decode("x", (XML.format(declared.replace("_", "-")).encode() if declared else b"") + data)
    if source.undecodable is not None:
        assert 0 <= source.undecodable.start <= source.undecodable.end <= len(source.text)
        assert "\ufffd" in source.text


@given(st.text())
def test_utf8_comes_back(text: str) -> None:
    expected = text.removeprefix("\ufeff")
    assert decode("x", text.encode()).text == expected


def test_equal_texts_have_equal_digests() -> None:
    one, other = SourceFile("x", "a\ud800"), SourceFile("y", "a\ud800")
    assert one.digest == other.digest
    assert one.digest != SourceFile("x", "a").digest
