# SPDX-License-Identifier: Apache-2.0
"""Types as values: parsing, printing, fitting, joining, and access to parts."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.expr.types import (
    BASE_TYPES,
    BOOL,
    EMPTY_ARRAY,
    INT,
    INTEGER_RANGES,
    REAL,
    STRING,
    UNKNOWN,
    Array,
    ScalarKind,
    Struct,
    Type,
    TypeName,
    fits,
    join,
    leaves,
    parse_type,
    resolve_type,
    unwrap,
    wrap,
)

INNER = Struct("Inner", (("a", INT), ("b", Array(REAL, 2))))
OUTER = Struct("Outer", (("first", INNER), ("many", Array(INNER, None)), ("flag", BOOL)))
STRUCTS = {"Inner": INNER, "Outer": OUTER}

WRITTEN = [
    # text, base and dimensions
    ("int32", ("int32", ())),
    ("int32[]", ("int32", (None,))),
    ("int32[3]", ("int32", (3,))),
    ("int32[3][]", ("int32", (3, None))),
    ("int32[][3][0]", ("int32", (None, 3, 0))),
    ("_My_Struct9[]", ("_My_Struct9", (None,))),
    ("int32[1000000000000]", ("int32", (100000000,))),
]


@pytest.mark.parametrize(("text", "expected"), WRITTEN)
def test_parse_type(text: str, expected: tuple[str, tuple[int | None, ...]]) -> None:
    assert parse_type(text) == TypeName(*expected)


NO_TYPES = ["", " int32", "int32 ", "int32[", "int32]", "int32[-1]", "int32[a]", "int32[1 ]", "[]", "9a", "a-b", "a/b"]
NO_TYPES += ["int32[٣]", "größe", "int32\n", "a<b>"]


@pytest.mark.parametrize("text", NO_TYPES)
def test_not_a_type(text: str) -> None:
    assert parse_type(text) is None


RESOLVED = [
    ("bool", "bool"),
    ("uint8[4]", "uint8[4]"),
    ("float64[][2]", "float64[][2]"),
    ("Inner[3]", "Inner[3]"),
    ("string[0]", "string[0]"),
    ("int", "None"),
    ("Other", "None"),
]


@pytest.mark.parametrize(("text", "shown"), RESOLVED)
def test_resolve_type(text: str, shown: str) -> None:
    name = parse_type(text)
    assert name is not None
    assert str(resolve_type(name, STRUCTS.get)) == shown


def test_integer_ranges() -> None:
    assert INTEGER_RANGES["int8"] == (-128, 127)
    assert INTEGER_RANGES["uint64"] == (0, 18446744073709551615)
    assert INTEGER_RANGES.keys() == {n for n, t in BASE_TYPES.items() if t.kind is ScalarKind.INT}


def test_leaves() -> None:
    assert [(".".join(path), str(leaf)) for path, leaf in leaves(Array(OUTER, 4))] == [
        ("first.a", "int[4]"),
        ("first.b", "float[4][2]"),
        ("many.a", "int[4][]"),
        ("many.b", "float[4][][2]"),
        ("flag", "bool[4]"),
    ]


def test_leaves_of_a_scalar() -> None:
    assert list(leaves(Array(INT, 2), ("x",))) == [(("x",), Array(INT, 2))]


FITS = [
    # value, target
    (INT, BASE_TYPES["uint8"]),
    (BASE_TYPES["int64"], BASE_TYPES["int8"]),
    (INT, REAL),
    (REAL, BASE_TYPES["float32"]),
    (STRING, STRING),
    (EMPTY_ARRAY, Array(STRING, 2)),
    (Array(INT, 9), Array(REAL, 2)),
    (Array(EMPTY_ARRAY, 1), Array(Array(BOOL, None), None)),
    (Struct("Inner", ()), INNER),
    (UNKNOWN, OUTER),
    (OUTER, UNKNOWN),
    (Array(UNKNOWN, 1), Array(INT, 1)),
]
MISFITS = [
    (REAL, INT),
    (BOOL, INT),
    (INT, BOOL),
    (INT, STRING),
    (EMPTY_ARRAY, INT),
    (INT, Array(INT, 1)),
    (Array(INT, 1), INT),
    (Array(REAL, 1), Array(INT, 1)),
    (Array(INT, 1), Array(Array(INT, 1), 1)),
    (Array(INT, 1), EMPTY_ARRAY),
    (OUTER, INNER),
    (INNER, INT),
]


@pytest.mark.parametrize(("value", "target", "expected"), [(*c, True) for c in FITS] + [(*c, False) for c in MISFITS])
def test_fits(value: Type, target: Type, expected: bool) -> None:
    assert fits(value, target) is expected


JOINED = [
    # two types, what both fit
    (INT, REAL, "float"),
    (INT, BASE_TYPES["int8"], "int8"),
    (BOOL, BOOL, "bool"),
    (BOOL, INT, "None"),
    (STRING, Array(INT, 2), "None"),
    (EMPTY_ARRAY, Array(INT, 2), "int[2]"),
    (EMPTY_ARRAY, EMPTY_ARRAY, "[]"),
    (Array(INT, 2), Array(INT, 5), "int[5]"),
    (Array(INT, 5), Array(INT, 2), "int[5]"),
    (Array(INT, 5), Array(INT, None), "int[]"),
    (Array(INT, 5), Array(REAL, 2), "float[5]"),
    (Array(Array(INT, 1), 1), Array(EMPTY_ARRAY, 2), "int[2][1]"),
    (Array(Array(INT, 1), 3), Array(Array(REAL, 4), 2), "float[3][4]"),
    (Array(INT, 1), Array(BOOL, 1), "None"),
    (INNER, INNER, "Inner"),
    (INNER, OUTER, "None"),
    (UNKNOWN, INT, "int"),
]


@pytest.mark.parametrize(("left", "right", "shown"), JOINED, ids=str)
def test_join(left: Type, right: Type, shown: str) -> None:
    assert str(join(left, right)) == shown
    backward = join(right, left)
    assert (backward is None) is (shown == "None")


SCALARS: list[Type] = [BOOL, INT, REAL, STRING, EMPTY_ARRAY, UNKNOWN, INNER, OUTER, *BASE_TYPES.values()]
TYPES = st.recursive(
    st.sampled_from(SCALARS), lambda inner: st.builds(Array, inner, st.none() | st.integers(0, 5)), max_leaves=4
)


@given(TYPES, TYPES)
def test_both_fit_what_joins_them(left: Type, right: Type) -> None:
    joined = join(left, right)
    if joined is not None:
        assert fits(left, joined)
        assert fits(right, joined)
    else:
        assert not fits(left, right)
        assert not fits(right, left)


@given(TYPES)
def test_unwrap_is_the_inverse_of_wrap(type_: Type) -> None:
    assert wrap(*unwrap(type_)) == type_
    assert fits(type_, type_)


@given(st.sampled_from(sorted(BASE_TYPES)), st.lists(st.none() | st.integers(0, 99), max_size=3))
def test_printed_types_can_be_read(base: str, bounds: list[int | None]) -> None:
    type_ = wrap(BASE_TYPES[base], tuple(bounds))
    name = parse_type(str(type_))
    assert name is not None
    assert resolve_type(name, STRUCTS.get) == type_
