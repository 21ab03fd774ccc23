# SPDX-License-Identifier: Apache-2.0
"""The parser of expressions: accepted texts with their trees, and findings about all other texts
(docs/spec/expressions.md#grammar)."""

from __future__ import annotations

import pytest
from expr_cases import show, tree_of

from marked import Case, found
from roaml.expr.parse import MAX_DEPTH, MAX_FINDINGS, SYNTAX, UNSUPPORTED, parse
from roaml.expr.words import CONTEXTUAL, LITERALS, OPERATORS, PREFIXES, RESERVED, STATEMENTS
from roaml.text import Decoded

ACCEPTED = [
    # text, tree
    ("a", "a"),
    (" a ", "a"),
    ("$x_1", "$x_1"),
    ("größe", "größe"),
    ("true && false", "(&& true false)"),
    ("a || b && c", "(|| a (&& b c))"),
    ("a && b || c", "(|| (&& a b) c)"),
    ("a == b && c != d", "(&& (== a b) (!= c d))"),
    ("a == b < c", "(== a (< b c))"),
    ("a < b + c", "(< a (+ b c))"),
    ("a + b * c", "(+ a (* b c))"),
    ("(a + b) * c", "(* (+ a b) c)"),
    ("a - b - c", "(- (- a b) c)"),
    ("a - (b - c)", "(- a (- b c))"),
    ("a / b * c % d", "(% (* (/ a b) c) d)"),
    ("a < b == c < d", "(== (< a b) (< c d))"),
    ("-a * b", "(* (- a) b)"),
    ("!a == b", "(== (! a) b)"),
    ("- -a", "(- (- a))"),
    ("!!a", "(! (! a))"),
    ("-a.b[0]", "(- a.b[0])"),
    ("a - -1", "(- a (- 1))"),
    ("+a", "(+ a)"),
    ("a === b", "(== a b)"),
    ("a !== b", "(!= a b)"),
    ("a ? b : c", "(? a b c)"),
    ("a ? b : c ? d : e", "(? a b (? c d e))"),
    ("a || b ? c + 1 : d", "(? (|| a b) (+ c 1) d)"),
    ("a.b.c", "a.b.c"),
    ("a.true", "a.true"),
    ("a . b", "a.b"),
    ("a[1][b + 2].c", "a[1][(+ b 2)].c"),
    ("(a)[0]", "a[0]"),
    ("Math.max(a, 1 + 2)", "Math.max(a, (+ 1 2))"),
    ("Math.random()", "Math.random()"),
    ("[1, -2, [true], 'a',]", "[1, (- 2), [true], 'a']"),
    ("[]", "[]"),
    ("{'x': 1, \"y\": [2], z: {}}", "{x: 1, y: [2], z: {}}"),
    ("a\n  &&\t\r\nb", "(&& a b)"),
    ("a&&b||!c", "(|| (&& a b) (! c))"),
    ("a<-1", "(< a (- 1))"),
    ("null", "null"),
]


@pytest.mark.parametrize(("text", "tree"), ACCEPTED)
def test_accepted(text: str, tree: str) -> None:
    expr, findings = parse(Decoded(text, 0))
    assert findings == ()
    assert show(expr) == tree


NUMBERS = [
    # text, value; a float is real in the sense of docs/spec/expressions.md#number-literals
    ("0", 0),
    ("42", 42),
    ("1.0", 1.0),
    ("5.", 5.0),
    (".5", 0.5),
    ("1e3", 1000),
    ("1E+3", 1000),
    ("1e-3", 0.001),
    ("1.0e3", 1000.0),
    ("0x10", 16),
    ("0XfF", 255),
    ("010", 8),
    ("089", 89),
    ("00", 0),
    ("9007199254740993", 9007199254740993),
    ("18446744073709551615", 18446744073709551615),
    ("1e308", int(1e308)),
    ("1e-999", 0),
    ("0.0", 0.0),
]


@pytest.mark.parametrize(("text", "value"), NUMBERS)
def test_numbers(text: str, value: float) -> None:
    expr, findings = parse(Decoded(text, 0))
    assert findings == ()
    assert show(expr) == repr(value)


TOO_LARGE = ["1e309", "9" * 400, "9" * 6000, "0" + "9" * 6000, "0x" + "f" * 6000, "0" + "7" * 6000]


@pytest.mark.parametrize("text", TOO_LARGE, ids=lambda text: text[:5])
def test_numbers_that_are_too_large(text: str) -> None:
    expr, findings = parse(Decoded(text, 0))
    assert show(expr) == "_"
    assert found(findings) == [(0, len(text), "the number is too large; the maximum is 1.8e308")]


STRINGS = [
    # text, value
    ("'a'", "a"),
    ('"a"', "a"),
    ("''", ""),
    ("'a\"b'", 'a"b'),
    (r"'a\'b'", "a'b"),
    (r"'\\n'", r"\n"),
    (r"'\n\t\r\b\f\v\0'", "\n\t\r\b\f\v\0"),
    (r"'\x41B\u{43}\q'", "ABCq"),
    (r"'\u{1F600} \ud83d\ude00'", "\U0001f600 \U0001f600"),
    (r"'\ud83d \u{110000}'", "\ufffd \ufffd"),
    ("'\ud800'", "\ufffd"),
    ("'a\\\nb'", "ab"),
    ("'hé'", "hé"),
]


@pytest.mark.parametrize(("text", "value"), STRINGS, ids=ascii)
def test_strings(text: str, value: str) -> None:
    expr, findings = parse(Decoded(text, 0))
    assert findings == ()
    assert show(expr) == repr(value)


UNSUPPORTED_CASES = [
    """
a ** b
  ^^ `**` is not supported: use `Math.pow(x, y)`
=> _<a b>
""",
    """
a & b
  ^ `&` is not supported: write `&&` for a logical AND
=> _<a b>
""",
    """
a | b == c
  ^ `|` is not supported: write `||` for a logical OR
=> _<a (== b c)>
""",
    """
a ^ b
  ^ `^` is not supported: bit operations are not supported
=> _<a b>
""",
    """
a << b >> c >>> d
  ^^ `<<` is not supported: bit operations are not supported
       ^^ `>>` is not supported: bit operations are not supported
            ^^^ `>>>` is not supported: bit operations are not supported
=> _<_<_<a b> c> d>
""",
    """
~a + b
^ `~` is not supported: bit operations are not supported
=> (+ a b)
""",
    """
typeof a
^^^^^^ `typeof` is not supported in expressions
=> _<a>
""",
    """
void
^^^^ `void` is not supported in expressions
=> _
""",
    """
a = 1
  ^ `=` is not supported: write `==` to compare; use `<assign>` to store a value
=> _<a 1>
""",
    """
a += 1
  ^^ `+=` is not supported: use `<assign>` to store a value
=> _<a 1>
""",
    """
a++ + b
 ^^ `++` is not supported; use `<assign>` to change a variable
=> (+ _<a> b)
""",
    """
--a
^^ `--` is not supported: use `<assign>` to change a variable
=> a
""",
    """
a, b
 ^ `,` is not supported: an expression is a single value
=> a
""",
    """
(a, b) + c
  ^ `,` is not supported: an expression is a single value
=> (+ a c)
""",
    """
a; b
 ^ an expression must be a single value; statements are not supported
=> a
""",
    """
v[i++] == (b & c)
   ^^ `++` is not supported; use `<assign>` to change a variable
             ^ `&` is not supported: write `&&` for a logical AND
=> (== v[_<i>] _<b c>)
""",
    """
new Date()
^^^ `new` is not supported: an expression is a single value
=> _
""",
    """
function (x) { return x }
^^^^^^^^ `function` is not supported: an expression is a single value
=> _
""",
    """
x => x + 1
  ^^ `=>` is not supported: write `>=` to compare; functions are not supported
=> _<x (+ x 1)>
""",
    """
if (a) b
^^ `if` is not supported: an expression is a single value
=> _
""",
    """
this.x
^^^^ `this` is not supported; use the name of the variable
=> _.x
""",
    """
a in b
  ^^ `in` is not supported: write the comparison explicitly
=> _<a b>
""",
    """
/ab+c/g
^^^^^^^ regular expressions are not supported; compare strings with `==`
=> _
""",
    """
`a${b}`
^^^^^^^ template strings are not supported; write the string in single quotes
=> _
""",
    """
a <> b
  ^^ `<>` is not supported: write `!=` to compare
=> _<a b>
""",
    """
a =< b
  ^^ `=<` is not supported: write `<=` to compare
=> _<a b>
""",
]


@pytest.mark.parametrize("written", UNSUPPORTED_CASES, ids=lambda written: written.split("\n")[1])
def test_unsupported(written: str) -> None:
    case = Case(written)
    expr, findings = parse(Decoded(case.text, 0))
    assert found(findings) == case.found
    assert {f.code for f in findings} == {UNSUPPORTED}
    assert show(expr) == case.result


MISTAKES = [
    """
_msg.
    ^ a name is missing after the `.`
=> _msg._
""",
    """
_msg. + 1
    ^ a name is missing after the `.`
=> (+ _msg._ 1)
""",
    """
a +
  ^ a value is missing after `+`
=> (+ a _)
""",
    """
a + * b
    ^ a value is missing before `*`
=> (+ a (* _ b))
""",
    """
* b
^ a value is missing before `*`
=> (* _ b)
""",
    """
a &&
  ^^ a value is missing after `&&`
=> (&& a _)
""",
    """
!
^ a value is missing after `!`
=> (! _)
""",
    """
f(
 ^ `(` is never closed with `)`
=> f()
""",
    """
f(a,
 ^ `(` is never closed with `)`
=> f(a)
""",
    """
f(a, , b)
     ^ a value is missing before `,`
=> f(a, _, b)
""",
    """
(a + b
^ `(` is never closed with `)`
=> (+ a b)
""",
    """
a + b)
     ^ `)` closes no bracket; remove it
=> (+ a b)
""",
    """
(a]
^ `(` is never closed with `)`
  ^ `]` closes no bracket; remove it
=> a
""",
    """
(a b) + c
   ^ an operator is missing before `b`
=> (+ a c)
""",
    """
f(a b (c) d, e) + g
    ^ an operator is missing before `b`
=> (+ f(a) g)
""",
    """
a[
 ^ a value is missing after `[`
=> a[_]
""",
    """
a[]
  ^ a value is missing before `]`
=> a[_]
""",
    """
[1, 2
^ `[` is never closed with `]`
=> [1, 2]
""",
    """
{'a': 1
^ `{` is never closed with `}`
=> {a: 1}
""",
    """
{'a'}
 ^^^ `:` and a value are missing after `'a'`
=> {a: _}
""",
    """
{+: 1}
 ^ a member name in quotes is missing
=> {}
""",
    """
'abc
^^^^ the string has no closing `'`
=> 'abc'
""",
    """
a == "b + 1
     ^^^^^^ the string has no closing `"`
=> (== a 'b + 1')
""",
    """
a b
  ^ an operator is missing before `b`
=> a
""",
    """
2x
 ^ `2x` is neither a number nor a name
=> 2
""",
    """
a ? b
    ^ `:` with the second value of `?` is missing after `b`
=> (? a b _)
""",
    """
a and b OR not c
  ^^^ `and` is not an operator; write `&&`
        ^^ `OR` is not an operator; write `||`
           ^^^ `not` is not an operator; write `!`
=> (|| (&& a b) (! c))
""",
    """
a @ b
  ^ an operator is missing before `@`
=> a
""",
    """
@a
^ `@` is not allowed in an expression; remove it
=> a
""",
    """
a = = b
  ^ `=` is not supported: write `==` to compare; use `<assign>` to store a value
    ^ a value is missing before `=`
=> _<_<a _> b>
""",
    """
.x
^ a value is missing before `.`
=> _.x
""",
    """
)
^ a value is missing before `)`
=> _
""",
]


@pytest.mark.parametrize("written", MISTAKES, ids=lambda written: written.split("\n")[1])
def test_mistakes(written: str) -> None:
    case = Case(written)
    expr, findings = parse(Decoded(case.text, 0))
    assert found(findings) == case.found
    assert {f.code for f in findings} <= {SYNTAX, UNSUPPORTED}
    assert show(expr) == case.result


@pytest.mark.parametrize("text", ["", " ", "\n\t "])
def test_nothing(text: str) -> None:
    expr, findings = parse(Decoded(text, 5))
    assert show(expr) == "_"
    assert found(findings) == [(5, 5 + len(text), "an expression is missing")]


DEEP = ["(" * 400, "(" * 400 + "a" + ")" * 400, "-" * 400 + "a", "[" * 400, "a" + ".b" * 400, "a" + "[0]" * 400]
DEEP += ["1+" * 400 + "1", "a?" * 400, "a&" * 400 + "a", "@" * 400, "typeof " * 400, "~" * 400 + "a", "{a:" * 400]
DEEP += ["f(" * 5000, "a?b:" * 5000 + "c", "a++" + "++" * 5000]


@pytest.mark.parametrize("text", DEEP, ids=lambda text: text[:6])
def test_nested_too_deep(text: str) -> None:
    expr, findings = parse(Decoded(text, 0))
    assert show(expr) == "_"
    assert found(findings) == [(0, len(text), f"the expression is nested more than {MAX_DEPTH} levels deep")]


def test_deep_but_not_too_deep() -> None:
    text = "(" * (MAX_DEPTH - 1) + "a" + ")" * (MAX_DEPTH - 1)
    assert parse(Decoded(text, 0))[1] == ()
    assert show(tree_of("1" + "+1" * (MAX_DEPTH - 2))).count("+") == MAX_DEPTH - 2


def test_mistakes_are_bounded() -> None:
    assert len(parse(Decoded("[" + "," * 9000, 0))[1]) == MAX_FINDINGS


SIMPLE = ["a", "a.b", "_msg.data.x", "a.new.b_1", "and.x", "a" + ".b" * 8, "a" + ".b" * 9, "true", "true.x", "this.x"]
SIMPLE += ["0", "12", "012", "0.5", "2.0", "10.250", "0.1234567890123456789", "1234567890123456"]


@pytest.mark.parametrize("text", SIMPLE)
def test_simple_ones_are_read_like_all_others(text: str) -> None:
    """With white space behind it, an expression is parsed in the general way instead of the fast one, with the same
    result."""
    assert parse(Decoded(text, 5)) == parse(Decoded(f"{text} ", 5))


def test_reserved_words_by_their_use() -> None:
    """Each reserved word has one use. Words of other kinds of expressions are reported."""
    kinds = (LITERALS, OPERATORS, PREFIXES, STATEMENTS, {"this"})
    assert sorted(word for kind in kinds for word in kind) == sorted(RESERVED | CONTEXTUAL)
    for word in (RESERVED | CONTEXTUAL) - LITERALS:
        _, findings = parse(Decoded(f"a {word} b" if word in OPERATORS else word, 0))
        assert findings, word
