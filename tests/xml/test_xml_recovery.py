# SPDX-License-Identifier: Apache-2.0
"""Mistakes as people make them: what is said, where, and what tree goes on. See `marked` for the notation."""

from __future__ import annotations

import pytest
from xml_cases import shape

from marked import Case, found
from roaml.xml_syntax import parse

CASES = {
    # ------------------------------------------------------------ start tags
    "half-typed tag, nothing behind": """
<a><b
   ^^ the start tag `<b` has no `>`
 ^ `<a>` is never closed
=> a(b~)~
""",
    "half-typed tag before a sibling": """
<a>
  <b
  ^^ the start tag `<b` has no `>`
  <c/>
</a>
=> a(b~ c/)
""",
    "half-typed tag with attributes before a sibling": """
<a>
  <b x="1" y
  ^^ the start tag `<b` has no `>`
           ^ the attribute `y` has no value
  <c/><d/>
</a>
=> a(b[x=1 y]~ c/ d/)
""",
    "half-typed tag that has its end tag": """
<a><b <c/></b></a>
   ^^ the start tag `<b` has no `>`
=> a(b(c/)~)
""",
    "half-typed tag before its parent's end": """
<a><b x="1" </a>
   ^^ the start tag `<b` has no `>`
=> a(b[x=1]~)
""",
    "half-typed tag before a comment": """
<a><b <!-- c --></a>
   ^^ the start tag `<b` has no `>`
=> a(b~ !c)
""",
    "only a bracket": """
<a><</a>
   ^ `<` does not begin a tag here; write `&lt;` for the character
=> a('<')
""",
    "less than in text": """
<a>1 < 2 and 3 <4</a>
     ^ `<` does not begin a tag here; write `&lt;` for the character
               ^ `<` does not begin a tag here; write `&lt;` for the character
=> a('1' '<' '2 and 3' '<' '4')
""",
    "slash that closes nothing": """
<a / b="1"></a>
   ^ `/` is not an attribute; write `name="value"`
=> a[b=1]
""",
    "junk in a tag": """
<a {x} b="1" ;/>
   ^^^ `{x}` is not an attribute; write `name="value"`
             ^ `;` is not an attribute; write `name="value"`
=> a[b=1]/
""",
    "no name that XML knows": """
<a$b><c#/></a$b>
 ^^^ `a$b` is not a valid XML name
      ^^ `c#` is not a valid XML name
=> a$b(c#/)
""",
    # ------------------------------------------------------------ attributes
    "open quote at the end of the tag": """
<a b="c>
   ^^^^ the value of `b` has no closing "
</a>
=> a[b=c]
""",
    "open quote before `/>`": """
<a><b c="d/></a>
      ^^^^ the value of `c` has no closing "
=> a(b[c=d]/)
""",
    "open quote at the end of the line": """
<a b="c
   ^^^^ the value of `b` has no closing "
   d="e">
</a>
=> a[b=c d=e]
""",
    "open quote before another attribute": """
<a b="c d="e"/>
   ^^^^ the value of `b` has no closing "
=> a[b=c d=e]/
""",
    "open quote with nothing in it before another attribute": """
<a b=" d="e"/>
   ^^^ the value of `b` has no closing "
=> a[b= d=e]/
""",
    "open quote, then a tag": """
<a><b c="d
      ^^^^ the value of `c` has no closing "
   ^^ the start tag `<b` has no `>`
<e f="g"/></a>
=> a(b[c=d]~ e[f=g]/)
""",
    "open quote at the end of the text": """
<a b="
   ^^^ the value of `b` has no closing "
^^ the start tag `<a` has no `>`
=> a[b=]~
""",
    "open single quote": """
<a b='c>
   ^^^^ the value of `b` has no closing '
</a>
=> a[b=c]
""",
    "no quotes": """
<a b=c d="e"/>
     ^ an attribute value needs quotes
=> a[b=c d=e]/
""",
    "no value": """
<a b= c="d"/>
   ^^ the attribute `b` has no value; write `b="…"`
=> a[b c=d]/
""",
    "no equals sign": """
<a b c="d"/>
   ^ the attribute `b` has no value
=> a[b c=d]/
""",
    "value without equals sign": """
<a b "c"/>
   ^ the attribute `b` has no value
     ^^^ `"c"` is not an attribute; write `name="value"`
=> a[b]/
""",
    "no space between attributes": """
<a b="c"d="e"/>
        ^ a space is missing before this attribute
=> a[b=c d=e]/
""",
    "given twice": """
<a b="1" c="2" b="3"/>
               ^ the attribute `b` is given twice
=> a[b=1 c=2 b=3]/
""",
    "given twice beside another mistake": """
<a b="1" b="3" c/>
         ^ the attribute `b` is given twice
               ^ the attribute `c` has no value
=> a[b=1 b=3 c]/
""",
    "less than in a value": """
<a b="c < d" e="f<g"/>
        ^ `<` in an attribute value must be written `&lt;`
                 ^ `<` in an attribute value must be written `&lt;`
=> a[b=c < d e=f<g]/
""",
    "ampersands in a value": """
<a b="c && d"/>
        ^ a literal `&` must be written `&amp;`
         ^ a literal `&` must be written `&amp;`
=> a[b=c && d]/
""",
    "name that XML does not know": """
<a @b="1" 2c="3" d:e:f="4"/>
   ^^ `@b` is not a valid XML name
          ^^ `2c` is not a valid XML name
                 ^^^^^ `d:e:f` is not a valid XML name
                 ^ the prefix `d` is not declared with `xmlns:d`
=> a[@b=1 2c=3 d:e:f=4]/
""",
    "space that is none": """
<a\u00a0b="c" \u2003d="e"\u00a0>x</a\u00a0>
  ^ the character U+00A0 is not white space in XML; replace it with a space
         ^ the character U+2003 is not white space in XML; replace it with a space
               ^ the character U+00A0 is not white space in XML; replace it with a space
                     ^ the character U+00A0 is not white space in XML; replace it with a space
=> a[b=c d=e]('x')
""",
    # -------------------------------------------------------------- end tags
    "end tag missing before the parent's": """
<a>
  <b>text
   ^ `<b>` is never closed
</a>
=> a(b('text')~)
""",
    "end tags missing at the end": """
<a><b><c/>
 ^ `<a>` is never closed
    ^ `<b>` is never closed
=> a(b(c/)~)~
""",
    "misspelled end tag": """
<state><onentry></onetry></state>
                  ^^^^^^ `</onetry>` does not match `<onentry>`
=> state(onentry)
""",
    "end tag of a wrong case": """
<a><Sequence><b/></sequence></a>
                   ^^^^^^^^ `</sequence>` does not match `<Sequence>`
=> a(Sequence(b/))
""",
    "stray end tag": """
<a><b/></xyz><c/></a>
       ^^^^^^ `</xyz>` closes no element; the open element is `<a>`
=> a(b/ c/)
""",
    "end tag behind the root": """
<a/></a>
    ^^^^ `</a>` closes no element; remove it
=> a/
""",
    "crossed tags": """
<a><b></a></b>
    ^ `<b>` is never closed
          ^^^^ `</b>` closes no element; remove it
=> a(b~)
""",
    "end tag without `>`": """
<a><b></b</a>
      ^^^ the end tag has no `>`
=> a(b)
""",
    "end tag without name": """
<a><b></></a>
      ^^^ the end tag has no name; the open element is `<b>`
=> a(b)
""",
    "end tag being typed": """
<a><b></
      ^^ the end tag has no name; the open element is `<b>`
 ^ `<a>` is never closed
=> a(b)~
""",
    "end tag with a space before its name": """
<a></ a>
     ^ the name must follow `</` directly
=> a
""",
    "end tag with more than a name": """
<a><b></b c="d"></a>
         ^^^^^^ an end tag contains only its name
=> a(b)
""",
    "end tag with another prefix": """
<x:a xmlns:x="u"></a>
                   ^ `</a>` does not match `<x:a>`
=> x:a[xmlns:x=u]
""",
    # ------------------------------------------------------------------ rest
    "comment without end": """
<a><!-- b <c/></a>
   ^^^^ the comment is never closed with `-->`
 ^ `<a>` is never closed
=> a(!b <c/></a>)~
""",
    "comment with two hyphens": """
<a><!-- b -- c --></a>
          ^^ `--` is not allowed inside a comment
=> a(!b -- c)
""",
    "comment that ends with a hyphen": """
<a><!-- b ---></a>
          ^^ `--` is not allowed inside a comment
=> a(!b -)
""",
    "CDATA without end": """
<a><![CDATA[ b <c/></a>
   ^^^^^^^^^ the CDATA section is never closed with `]]>`
 ^ `<a>` is never closed
=> a({ b <c/></a>})~
""",
    "end of CDATA in text": """
<a>b ]]> c</a>
     ^^^ `]]>` is only allowed at the end of a CDATA section; write `]]&gt;` for the text
=> a('b ]]> c')
""",
    "instruction without end": """
<a><?b c
   ^^^^^ the processing instruction is never closed with `?>`
<d/></a>
=> a(?b d/)
""",
    "instruction without name": """
<a><? b?></a>
   ^^^^^^ a processing instruction must begin with a name
=> a(?b)
""",
    "declaration behind something": """
 <?xml version="1.0"?>
 ^^^^^^^^^^^^^^^^^^^^^ the XML declaration must be at the very beginning of the file
<a/>
=> ?xml a/
""",
    "declaration without version": """
<?xml encoding="UTF-8"?><a/>
^^^^^^^^^^^^^^^^^^^^^^^^ an XML declaration must have the form `<?xml version="1.0" encoding="UTF-8"?>`
=> ?xml a/
""",
    "encoding that does not exist": """
<?xml version="1.0" encoding="UTF-9"?><a/>
                              ^^^^^ unknown encoding `UTF-9`; the file was read as UTF-8
=> ?xml a/
""",
    "document type": """
<!DOCTYPE a><a/>
^^^^^^^^^^^^ a document type declaration has no effect and is not read
=> ?DOCTYPE a/
""",
    "document type with entities": """
<!DOCTYPE a [<!ENTITY b "]>"><!-- ]> -->]><a>&b;</a>
^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ entities are not expanded; write out their text
                                             ^^^ the entity `&b;` is not defined; entities are not expanded
=> ?DOCTYPE a('&b;')
""",
    "document type without end": """
<!DOCTYPE a [ <a/>
^^^^^^^^^^^^^^^^^^ a document type declaration has no effect and is not read
^ the file contains no element
=> ?DOCTYPE
""",
    "document type with an apostrophe": """
<!DOCTYPE it's><a b="c"/>
^^^^^^^^^^^^^^^ a document type declaration has no effect and is not read
=> ?DOCTYPE a[b=c]/
""",
    "references": """
<a>&lt; &nbsp; & &#0; &#x110000; &; &#65;</a>
        ^^^^^^ the entity `&nbsp;` is not defined; entities are not expanded
               ^ a literal `&` must be written `&amp;`
                 ^^^^ `&#0;` is not a character that XML allows
                      ^^^^^^^^^^ `&#x110000;` is not a character that XML allows
                                 ^ a literal `&` must be written `&amp;`
=> a('< &nbsp; & &#0; &#x110000; &; A')
""",
    "prefix that nobody declares": """
<a xmlns:x="u" x:b="1" y:c="2"><z:d/><e xmlns:z="v"><z:f xml:lang="g"/></e></a>
                       ^ the prefix `y` is not declared with `xmlns:y`
                                ^ the prefix `z` is not declared with `xmlns:z`
=> a[xmlns:x=u x:b=1 y:c=2](z:d/ e[xmlns:z=v](z:f[xml:lang=g]/))
""",
    "two roots": """
<a/>
<b/>
 ^ a document must have one root; `<b>` is outside of `<a>`
=> a/ b/
""",
    "text outside the root": """
hello
^^^^^ text outside of the root element
<a/>
 &amp; bye
 ^^^^^^^^^ text outside of the root element
=> 'hello' a/ '& bye'
""",
    "CDATA outside the root": """
<![CDATA[ ]]><a/>
^^^^^^^^^^^^^ text outside of the root element
=> { } a/
""",
    "no element": """
<!-- nothing -->
^ the file contains no element
=> !nothing
""",
}


@pytest.mark.parametrize("written", CASES.values(), ids=CASES.keys())
def test_recovery(written: str) -> None:
    case = Case(written)
    document = parse(case.text)
    assert found(document.findings) == case.found
    assert shape(document) == case.result


def test_nothing_at_all() -> None:
    assert found(parse("").findings) == [(0, 0, "the file contains no element")]


CHARACTERS = [
    # text, place and message
    ("<a>\0</a>", (3, 4, "the character U+0000 is not allowed in XML")),
    ("<a b='\x1b'/>", (6, 7, "the character U+001B is not allowed in XML")),
    ("<a>\ud800</a>", (3, 4, "the character U+D800 is not allowed in XML")),
    ("<a>\ufffe</a>", (3, 4, "the character U+FFFE is not allowed in XML")),
]


@pytest.mark.parametrize(("text", "expected"), CHARACTERS, ids=ascii)
def test_characters_that_xml_forbids(text: str, expected: tuple[int, int, str]) -> None:
    assert found(parse(text).findings) == [expected]
