# SPDX-License-Identifier: Apache-2.0
"""The meaning of definition files, and the findings in files with errors."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

from roaml.diagnostics import Severity
from roaml.interfaces import Constant, Definition, Field, Kind, Section, parse
from roaml.interfaces.report import CODE
from roaml.text import LineIndex, Span, TextEdit, apply_edits

# ----------------------------------------------------------------------------------------------------- what is meant

ELEMENTS = [
    # numbers, bools
    ("int32 x", "int32 x"),
    ("  int32\t x  ", "int32 x"),
    ("int8 x -128", "int8 x -128"),
    ("int64 x +9223372036854775807", "int64 x 9223372036854775807"),
    ("uint8 x 0xFF", "uint8 x 255"),
    ("uint8 x 0b101", "uint8 x 5"),
    ("uint8 x 0o17", "uint8 x 15"),
    ("uint8 x 007", "uint8 x 7"),
    ("byte x 255", "byte x 255"),
    ("char x 97", "char x 97"),
    ("float32 x 1", "float32 x 1.0"),
    ("float64 x -1.5e-3", "float64 x -0.0015"),
    ("float64 x .5", "float64 x 0.5"),
    ("float64 x 5.", "float64 x 5.0"),
    ("bool x true", "bool x True"),
    ("bool x False", "bool x False"),
    ("bool x 1", "bool x True"),
    # constants
    ("int32 X=1", "int32 X=1"),
    ("int32 X = -1", "int32 X=-1"),
    ("uint16 A_1B= 2", "uint16 A_1B=2"),
    ("float32 PI =3.14", "float32 PI=3.14"),
    ("bool ON=TRUE", "bool ON=True"),
    # strings
    ("string s", "string s"),
    ("string s abc", "string s 'abc'"),
    ("string s two words", "string s 'two words'"),
    ('string s "a # b"', "string s 'a # b'"),
    ('string s "a = b"', "string s 'a = b'"),
    ("string s 'it is \"quoted\"'", "string s 'it is \"quoted\"'"),
    (r'string s "say \"hi\""', "string s 'say \"hi\"'"),
    (r"string s 'it\'s'", 'string s "it\'s"'),
    (r'string s "tab\tline\n\\ \x41\u00e4"', r"string s 'tab\tline\n\\ Aä'"),
    (r'string s "\d stays"', r"string s '\\d stays'"),
    (r"string s C:\new", r"string s 'C:\\new'"),
    ("string s don't", 'string s "don\'t"'),
    ('string s ""', "string s ''"),
    ('string S=" x "', "string S=' x '"),
    ("string S=plain # comment", "string S='plain'  # comment"),
    ("string S='#' # comment", "string S='#'  # comment"),
    ("string S=", "string S=''"),
    ("string<=3 s abc", "string<=3 s 'abc'"),
    ("wstring w ä", "wstring w 'ä'"),
    ("wstring<=10 w", "wstring<=10 w"),
    # arrays
    ("int32[] a", "int32[] a"),
    ("int32[3] a", "int32[3] a"),
    ("int32[<=3] a", "int32[<=3] a"),
    ("string<=10[<=5] a", "string<=10[<=5] a"),
    ("int32[] a []", "int32[] a ()"),
    ("int32[] a [1, 2 ,-3]", "int32[] a (1, 2, -3)"),
    ("int32[2] a [ 1,2 ] # both", "int32[2] a (1, 2)  # both"),
    ("bool[<=2] a [true]", "bool[<=2] a (True,)"),
    ("float32[] a [1, 2.5]", "float32[] a (1.0, 2.5)"),
    ("""string[] a ["a, #]", 'b', c d]""", "string[] a ('a, #]', 'b', 'c d')"),
    # messages
    ("Point p", "my_pkg/Point p"),
    ("Point[3] p", "my_pkg/Point[3] p"),
    ("geometry_msgs/Point p", "geometry_msgs/Point p"),
    ("geometry_msgs/msg/Point[<=2] p", "geometry_msgs/Point[<=2] p"),
    # comments
    ("int32 x# of x", "int32 x  # of x"),
    ("# of the message\nint32 x", "int32 x"),
    ("\n# of x\nint32 x", "int32 x  # of x"),
    ("\n# above\nint32 x  ## beside\n  # below\n  #   deeper", "int32 x  # above | beside | below |   deeper"),
    ("\n# of nothing\n\nint32 x", "int32 x"),
    ("int32 x\n\n  # of y\nint32 y", "int32 x\nint32 y  # of y"),
    ("int32 x\n# of y\n  # still of y\nint32 y", "int32 x\nint32 y  # of y | still of y"),
    ("int32 x\r\n# of y\r\nint32 y\rint32 z", "int32 x\nint32 y  # of y\nint32 z"),
]


@pytest.mark.parametrize(("text", "expected"), ELEMENTS)
def test_elements(text: str, expected: str) -> None:
    definition, findings = parse(text, "my_pkg", "Name", "msg")
    assert not findings
    assert spelled(definition.sections[0]) == expected


def spelled(section: Section) -> str:
    """Fields and constants in the order of the file, each with the value that was read and its comment lines."""
    elements: list[Field | Constant] = sorted([*section.fields, *section.constants], key=lambda e: e.name_span)
    return "\n".join(_spelled(element) for element in elements)


def _spelled(element: Field | Constant) -> str:
    text = f"{element.type} {element.name}"
    if isinstance(element, Constant):
        text += f"={element.value!r}"
    elif element.default is not None:
        text += f" {element.default!r}"
    return f"{text}  # {element.comment.replace(chr(10), ' | ')}" if element.comment else text


SECTIONS: list[tuple[Kind, str, list[str]]] = [
    ("msg", "", [""]),
    ("msg", "int32 a", ["int32 a"]),
    ("srv", "---", ["", ""]),
    ("srv", "int32 a\n---\nint32 a\n", ["int32 a", "int32 a"]),
    ("srv", "int32 a\r\n---\r\nint32 A=1\r\n", ["int32 a", "int32 A=1"]),
    ("action", "---\n---", ["", "", ""]),
    ("action", "# Goal\nint32 a\n---\n# Result\n---   \n# Feedback\nint32 c", ["int32 a", "", "int32 c"]),
]


@pytest.mark.parametrize(("kind", "text", "expected"), SECTIONS)
def test_sections(kind: Kind, text: str, expected: list[str]) -> None:
    definition, findings = parse(text, "my_pkg", "Name", kind)
    assert not findings
    assert [spelled(section) for section in definition.sections] == expected


def test_opening_comments_belong_to_the_sections() -> None:
    definition, _ = parse(
        "# Drive.\n#   Slowly.\n\n# no more\n---\n# How it went\nbool ok\n---", "p", "Drive", "action"
    )
    assert definition.comment == "Drive.\n  Slowly."
    assert [section.comment for section in definition.sections] == ["Drive.\n  Slowly.", "How it went", ""]


def test_spans_and_texts() -> None:
    text = 'uint8 MAX = 0x10 # c\nstring<=5[] names ["a"]\n'
    section = parse(text, "p", "N", "msg")[0].sections[0]
    (constant,), (field,) = section.constants, section.fields
    assert constant.value_text == "0x10"
    assert field.default_text == '["a"]'
    spans = [constant.type_span, constant.name_span, constant.value_span, field.type_span, field.name_span]
    assert [text[slice(*span)] for span in spans] == ["uint8", "MAX", "0x10", "string<=5[]", "names"]
    assert field.default_span
    assert text[slice(*field.default_span)] == '["a"]'


def test_equality_is_of_meaning() -> None:
    plain = parse("int32 x 16\n---\nbool ok\n", "p", "N", "srv")[0]
    dressed = parse("# doc\n\nint32   x 0x10  # why\n\n---\n\n# so\nbool ok", "p", "N", "srv")[0]
    assert plain == dressed
    assert hash(plain) == hash(dressed)
    for other in ("int32 y 16\n---\nbool ok\n", "int32 x 17\n---\nbool ok", "int64 x 16\n---\nbool ok"):
        assert parse(other, "p", "N", "srv")[0] != plain


def test_sections_and_fields_by_name() -> None:
    definition = parse("int32 a\n---\nint32 b\n---\nint32 c", "p", "N", "action")[0]
    assert definition.full_name == "p/N"
    assert [definition.section(name).fields[0].name for name in ("goal", "result", "feedback")] == ["a", "b", "c"]
    assert definition.section("goal").field("a") is definition.sections[0].fields[0]
    assert definition.section("goal").field("b") is None
    with pytest.raises(KeyError):
        definition.section("request")


# --------------------------------------------------------------------------------------------------------- mistakes

# Below a line, `^^^` marks the span of a finding (`|` an empty one) and its message begins as written behind it.
MISTAKES = [
    # types
    """
int33 x
^^^^^ there is no type `int33`; did you mean `int32`?
    """,
    """
double x
^^^^^^ there is no type `double`; did you mean `float64`?
    """,
    """
foo_bar x
^^^^^^^ there is no type `foo_bar`; a message type is written `Name` or `package/Name`
    """,
    """
time stamp
^^^^ `time` is a type of ROS 1; in ROS 2 write `builtin_interfaces/Time`
    """,
    """
duration[] d
^^^^^^^^ `duration` is a type of ROS 1; in ROS 2 write `builtin_interfaces/Duration`
    """,
    """
Header header
^^^^^^ a bare `Header` is read as `std_msgs/Header`
    """,
    """
Geometry/Point p
^^^^^^^^^^^^^^ `Geometry` is not a valid package name; package names are lower_snake_case
    """,
    """
geometry_msgs/point p
^^^^^^^^^^^^^^^^^^^ `point` is not a valid message name; message names are CamelCase
    """,
    """
std_srvs/srv/Empty e
^^^^^^^^^^^^^^^^^^ the type of a field must be a message; `std_srvs/srv/Empty` is a service
    """,
    """
p/action/Go g
^^^^^^^^^^^ the type of a field must be a message; `p/action/Go` is an action
    """,
    """
a/b/c/D d
^^^^^^^ `a/b/c/D` is not the name of a message type; write `package/Name`
    """,
    """
[3] x
^^^ a type is missing
    """,
    # bounds and sizes
    """
string<=0 s
^^^^^^^^^ the bound of a string is written `string<=N`, with N from 1 to 4294967295
    """,
    """
string<10 s
^^^^^^^^^ the bound of a string is written `string<=N`
    """,
    """
int32<=5 x
^^^^^^^^ only strings can have a bound `<=N`; an array of at most N elements is written `T[<=N]`
    """,
    """
int32[0] x
^^^^^^^^ an array is written `T[N]`, `T[<=N]` or `T[]`, with N from 1
    """,
    """
int32[<=] x
^^^^^^^^^ an array is written `T[N]`
    """,
    """
int32[n] x
^^^^^^^^ an array is written `T[N]`
    """,
    """
int32[99999999999] x
^^^^^^^^^^^^^^^^^^ an array is written `T[N]`
    """,
    """
int32[5 x
^^^^^^^ the array has no closing `]`; write `int32[5]`
    """,
    """
int32[][] x
^^^^^^^^^ an array has only one dimension; for more, use an array of messages
    """,
    """
string <= 10 s
^^^^^^^^^^^^ a type cannot contain spaces; write `string<=10`
    """,
    """
int32 x[5]
^^^^^^^^^^ the size of an array is part of its type; write `int32[5] x`
    """,
    # names
    """
int32
^^^^^ the field of type `int32` has no name; a field is written `type name`
    """,
    """
int32 myValue
      ^^^^^^^ `myValue` is not a valid field name; field names are lower_snake_case
    """,
    """
int32 X
      ^ `X` is not a valid field name; field names are lower_snake_case, and a constant is written `NAME=value`
    """,
    """
int32 x;
      ^^ `x;` is not a valid field name
    """,
    """
int32 a__b
      ^^^^ `a__b` is not a valid field name
    """,
    """
int32 a_
      ^^ `a_` is not a valid field name
    """,
    """
int32 class
      ^^^^^ `class` is a keyword of C++, so ROS 2 generates invalid code; rename this field
    """,
    """
int32 lambda
      ^^^^^^ `lambda` is a keyword of Python
    """,
    """
uint8 structure_needs_at_least_one_member
      ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ `structure_needs_at_least_one_member` is reserved for the member
    """,
    """
int32 Max=3
      ^^^ `Max` is not a valid constant name; constants are UPPER_SNAKE_CASE
    """,
    """
int32 x = 3
      ^ `x` is not a valid constant name; constants are UPPER_SNAKE_CASE
    """,
    """
X=3
^^^ the type of the constant is missing; write `type NAME=value`
    """,
    """
int32 = 3
      | a name is missing; a constant is written `type NAME=value`
    """,
    """
int32 a
string a
       ^ `a` is defined twice; rename or remove one definition
    """,
    # constants
    """
int32[] X=[1]
^^^^^^^ a constant must be a single value; ROS 2 does not support array constants
    """,
    """
Point P=1
^^^^^ a constant must have a primitive type; `my_pkg/Point` is a message type
    """,
    """
string<=5 S=abc
^^^^^^^^^ the string of a constant cannot have a bound; write `string`
    """,
    """
int32 X=
        | a value of type `int32` is missing
    """,
    # values
    """
uint8 x 256
        ^^^ `256` does not fit into `uint8`, whose range is 0 to 255
    """,
    """
int8 X=-129 # too small
       ^^^^ `-129` does not fit into `int8`, whose range is -128 to 127
    """,
    """
byte x -1
       ^^ `-1` does not fit into `byte`, whose range is 0 to 255
    """,
    """
int32 x 1.0
        ^^^ `1.0` is not an integer; a `int32` is an integer from -2147483648 to 2147483647
    """,
    """
int32 x 1_000
        ^^^^^ `1_000` is not an integer
    """,
    """
char c 'a'
       ^^^ in ROS 2, a `char` is a number from 0 to 255; write `97`
    """,
    """
float32 x 1e39
          ^^^^ `1e39` is out of the range of `float32`
    """,
    """
float64 x 1e999
          ^^^^^ `1e999` is out of the range of `float64`
    """,
    """
float64 x 1.0f
          ^^^^ `1.0f` is not a number; write for example `1.5`, `-2` or `1e-3`
    """,
    """
float64 x nan
          ^^^ `nan` is not a number
    """,
    """
bool x yes
       ^^^ `yes` is not a bool; write `true` or `false`
    """,
    """
string s "abc # def
         ^^^^ the string has no closing `"`
    """,
    """
string s "abc" def
              ^^^^ the string ends before this text; inside a string, write `\\"` for `"`
    """,
    """
string<=2 s abc
            ^^^ the string has 3 characters, but `string<=2` allows at most 2
    """,
    """
int32 x [1]
        ^^^ `int32` is not an array, so its value cannot be a list; use the type `int32[]` or `int32[N]`
    """,
    """
Point p 3
        ^ a field of the message type `my_pkg/Point` cannot have a default; only primitive types can
    """,
    """
int32[] x 1, 2
          ^^^^ the default of an array must be a list in brackets: `[1, 2]`
    """,
    """
int32[] x [1, 2
          ^^^^^ the list has no closing `]`
    """,
    """
int32[] x [1] 2
             ^^ unexpected text after the list; only a comment may follow
    """,
    """
int32[2] x [1]
           ^^^ `int32[2]` must have exactly 2 elements, not 1
    """,
    """
int32[<=2] x [1, 2, 3]
             ^^^^^^^^^ `int32[<=2]` must have at most 2 elements, not 3
    """,
    """
uint8[] x [1, 300, -1,]
              ^^^ `300` does not fit into `uint8`
                   ^^ `-1` does not fit into `uint8`
                      | a value of type `uint8` is missing
    """,
    """
string<=1[] x ["a", "bc"]
                    ^^^^ the string has 2 characters, but `string<=1` allows at most 1
    """,
    # sections
    """
int32 a
---
^^^ only services (.srv) and actions (.action) have sections; remove this `---`
int32 a
    """,
    """srv
---
---
^^^ a service has 2 sections, request and response; this `---` begins an additional one
    """,
    """srv
int32 a
-----
^^^^^ the line between two sections must be exactly `---`
int32 b
    """,
    """srv
--- # response
^^^^^^^^^^^^^^ the line between two sections must be exactly `---`
    """,
    """srv
int32 a
^^^^^^^ a service has the sections request and response, separated by lines `---`; missing here: response
    """,
    """action
---
^^^ an action has the sections goal, result and feedback, separated by lines `---`; missing here: feedback
    """,
]

_MARKER = re.compile(r" *(\^+|\|) ")


@pytest.mark.parametrize("case", MISTAKES, ids=lambda case: case.strip().splitlines()[-1].strip(" ^|"))
def test_mistakes(case: str) -> None:
    head, _, body = case.rstrip(" ").partition("\n")
    kind: Kind = "srv" if head == "srv" else "action" if head == "action" else "msg"
    lines = body.splitlines()
    text = "".join(f"{line}\n" for line in lines if not _MARKER.match(line))
    findings = parse(text, "my_pkg", "Name", kind)[1]
    expected = list(_expected(lines, text))
    assert [finding.span for finding in findings] == [span for span, _ in expected]
    for finding, (_, beginning) in zip(findings, expected, strict=True):
        assert finding.message.startswith(beginning)
    assert {finding.code for finding in findings} == {CODE}


def _expected(lines: list[str], text: str) -> Iterator[tuple[Span, str]]:
    """The findings that the marks among `lines` state. A `|` below the first column means the end of the text."""
    index, line_start = LineIndex(text), 0
    row = 0
    for line in lines:
        if marker := _MARKER.match(line):
            start = line_start + line.index(marker[1])
            span = Span(start, start + len(marker[1]))
            if marker[1] == "|":
                span = Span(start, start) if start > line_start else Span(len(text), len(text))
            yield span, line[marker.end() :]
        else:
            line_start = index.line_start(row)
            row += 1


FIXES = [
    ("msg", "int33 x", "int32 x"),
    ("msg", "time t\nduration[3] d", "builtin_interfaces/Time t\nbuiltin_interfaces/Duration[3] d"),
    ("msg", "Header header", "std_msgs/Header header"),
    ("msg", "string <= 10 [ <= 5 ] s", "string<=10[<=5] s"),
    ("msg", "int32[5 x", "int32[5] x"),
    ("msg", "float32 x[3]  # why", "float32[3] x  # why"),
    ("msg", "int32 myHTTPValue", "int32 my_httpvalue"),
    ("msg", "int32 x;", "int32 x"),
    ("msg", "int32 max-speed=3", "int32 MAX_SPEED=3"),
    ("msg", "char c 'a'", "char c 97"),
    ("msg", "string<=5 S=abc", "string S=abc"),
    ("srv", "int32 a\n--\nint32 b", "int32 a\n---\nint32 b"),
    ("srv", "int32 a\nint32 b", "int32 a\nint32 b\n---\n"),
    ("srv", "# Why.\nbool ok", "# Why.\n---\nbool ok"),
    ("srv", "", "---\n"),
    ("action", "int32 a\n", "int32 a\n---\n---\n"),
]


@pytest.mark.parametrize(("kind", "text", "fixed"), FIXES)
def test_fixes(kind: Kind, text: str, fixed: str) -> None:
    edits: tuple[TextEdit, ...] = ()
    for finding in parse(text, "my_pkg", "Name", kind)[1]:
        edits += tuple(edit for fix in finding.fixes[:1] for edit in fix.edits)
    assert apply_edits(text, edits) == fixed


def test_warnings_are_those_that_ros_may_take() -> None:
    findings = parse("Header header\nint32 class\nint33 x", "p", "N", "msg")[1]
    assert [finding.severity for finding in findings] == [Severity.WARNING, Severity.WARNING, None]


def test_header_in_its_own_package() -> None:
    definition, findings = parse("Header header", "std_msgs", "N", "msg")
    assert (definition.sections[0].fields[0].type.name, findings) == ("std_msgs/Header", ())


def test_duplicates_point_to_the_first() -> None:
    findings = parse("int32 a\nstring a\n", "p", "N", "msg")[1]
    assert [related.place for related in findings[0].related] == [Span(6, 7)]


def test_what_can_be_told_is_kept() -> None:
    definition = parse(
        "int33 x\nfoo/srv/Bar y\nint32 myValue 300000000000\nint32[5] z [1]\nint32 z\nK=3", "p", "N", "msg"
    )
    assert spelled(definition[0].sections[0]) == "p/int33 x\nfoo/Bar y\nint32 myValue\nint32[5] z"


def test_missing_sections_are_there() -> None:
    assert parse("int32 a", "p", "N", "action")[0].sections[1:] == (Section(), Section())
    assert len(parse("---\n---\n---\n---", "p", "N", "action")[0].sections) == 3


def test_definition_of_nothing() -> None:
    assert parse("", "p", "N", "msg") == (Definition("p", "N", "msg", (Section(),)), ())
