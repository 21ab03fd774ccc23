# SPDX-License-Identifier: Apache-2.0
"""Text -> tree, for any text.

- Never fails and takes time linear in the text: every error becomes a finding, and parsing continues after it.
- Recovers for texts that are being typed: an attribute whose quote is open ends with its line or tag; a start tag
  without `>` ends before the next `<`; a missing end tag ends with its parent; a misspelled end tag closes the element
  with the similar name.
- Reads only the text: document type declarations are skipped, entities are never expanded.
- Does not recurse. Elements that are nested deeper than `MAX_DEPTH` are left out of the tree, so other functions may
  recurse over it.
"""

from __future__ import annotations

import codecs
import re

from roaml.diagnostics import Finding, Fix, Related
from roaml.interruption import checkpoint
from roaml.regex import regex
from roaml.suggest import are_similar
from roaml.text import Span, TextEdit, span_of
from roaml.xml_syntax.escapes import FORBIDDEN, PREDEFINED, REFERENCE, is_character, unescape
from roaml.xml_syntax.names import ASCII_NAME, SCXML_NAMESPACE, SPACE, is_name, leading_local_name
from roaml.xml_syntax.tree import Attribute, CData, Comment, Document, Element, Instruction, Node, Text, children_text

MAX_DEPTH = 100
"""The maximum nesting depth; deeper elements are reported and left out of the tree."""

MAX_FINDINGS = 100
"""The maximum number of errors; a text with more is unlikely to be XML and is not read further. Those that
BehaviorTree.CPP tolerates do not count."""

MAX_TOLERATED = 1000
"""The maximum number of reported errors that BehaviorTree.CPP tolerates."""

_MAX_SKIPPED_DEPTH = 10_000
"""The maximum number of open elements that are left out of the tree; a text with more is not read further."""

# A tag without errors whose names are ASCII. Other tags are read with the general patterns, which are slower.
_SPACE = f"[{SPACE}]"
_SOUND_TAG = regex(
    f"<({ASCII_NAME})((?:{_SPACE}+{ASCII_NAME}{_SPACE}*={_SPACE}*(?:\"[^\"<]*\"|'[^'<]*'))*){_SPACE}*(/)?>"
)
_SOUND_ATTRIBUTE = regex(r"([^\s=]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")

# The general patterns. They also match invalid names, white space and values, which are then reported.
_NAME = r"[^\s<>/=\"'&!?;,()\[\]{}]+"
_TAG_OPEN = regex(rf"<((?=[^\W\d]|:){_NAME})")
_END_TAG = regex(rf"</(\s*)({_NAME})?\s*(>)?")
_END_TAG_JUNK = regex(r"[^<>\r\n]*>")
_ATTRIBUTE = regex(rf"\s*({_NAME})(?:(\s*=\s*)(?:\"([^\"<]*)\"|'([^'<]*)')?)?")
_TAG_END = regex(r"\s*(/?>)")
_JUNK = regex(r"\s*([^\s<>/]+|/(?!>))")
_TAG_SPACE = regex(r"\s*")
_ODD_SPACE = regex(rf"[^\S{SPACE}]+")
_LESS = regex("<")
_AMPERSAND = regex("&")
_MAX_ODD_VALUE_LENGTH = 5000
_UNQUOTED = regex(r"[^\s<>/\"']*")
_SWALLOWED = regex(rf"\s{_NAME}\s*=\s*\Z")
_NEXT_ATTRIBUTE = regex(rf"{_NAME}\s*=")
_AFTER_VALUE = regex(r"[\s/>?]|\Z")
_DASHES = regex(r"--+")
_DOCTYPE_MARK = regex(r"<!--|<\?|[\[\]>\"']")
_DOCTYPE_CLOSERS = {"<!--": "-->", "<?": "?>", '"': '"', "'": "'"}
_XML_DECLARATION = regex(
    rf"""xml{_SPACE}+version{_SPACE}*={_SPACE}*(["'])1\.[0-9]+\1
    (?:{_SPACE}+encoding{_SPACE}*={_SPACE}*(["'])(?P<encoding>[A-Za-z][A-Za-z0-9._-]*)\2)?
    (?:{_SPACE}+standalone{_SPACE}*={_SPACE}*(["'])(?:yes|no)\4)?{_SPACE}*""".replace("\n    ", "")
)


def parse(text: str) -> Document:
    """The tree of `text` and its syntax errors."""
    return _Parser(text).run()


class _Parser:
    def __init__(self, text: str) -> None:
        self.text = text
        self.findings: list[Finding] = []
        self.reported = {True: 0, False: 0}  # the numbers of findings that BehaviorTree.CPP tolerates, and of others
        self.nodes: list[Node] = []
        self.stack: list[Element] = []
        self.names: list[str] = []  # of the elements in `stack`, including prefixes
        self.open_names: dict[str, int] = {}
        self.declared: list[tuple[int, str]] = []  # prefixes, with the depth of the element that declares them
        self.prefixes = {"xml": ["xml"], "xmlns": ["xmlns"]}  # the namespaces that elements in `stack` declare for each
        self.namespaces = {SCXML_NAMESPACE}  # those of the language: the namespaces of SCXML and of the root
        self.skipped_depth = 0
        self.instructions_end = True  # true until a search for `?>` has failed
        self.hopeless = False  # too many errors, or nested too deeply

    def run(self) -> Document:
        text, length = self.text, len(self.text)
        self.check_characters()
        at = 0
        while at < length and not self.hopeless:
            less = text.find("<", at)
            if less != at:
                end = length if less < 0 else less
                self.add_text(at, end)
                at = end
                continue
            checkpoint()
            at = self.markup(at)
        while self.stack:
            self.close_unclosed(length)
        root = self.check_roots()
        self.findings.sort(key=lambda f: f.span)
        return Document(text, root, tuple(self.nodes), tuple(self.findings))

    # ---------------------------------------------------------------- markup

    def markup(self, at: int) -> int:
        """Read the markup that begins with the `<` at `at`; return the offset after it."""
        text = self.text
        following = text[at + 1 : at + 2]
        if following == "/":
            return self.end_tag(at)
        if following == "!":
            if text.startswith("<!--", at):
                return self.comment(at)
            if text.startswith("<![CDATA[", at):
                return self.cdata(at)
            if text[at + 2 : at + 9].upper() == "DOCTYPE":
                return self.document_type(at)
        elif following == "?":
            return self.instruction(at)
        if sound := _SOUND_TAG.match(text, at):
            return self.sound_tag(sound)
        match = _TAG_OPEN.match(text, at)
        if match is None:
            escape = Fix("Write `&lt;`", (TextEdit(Span(at, at + 1), "&lt;"),), safe=True)
            self.report(Span(at, at + 1), "`<` does not begin a tag here; write `&lt;` for the character", escape)
            self.add(Text("<", Span(at, at + 1)))
            return at + 1
        return self.start_tag(at, match)

    def sound_tag(self, match: re.Match[str]) -> int:
        """Read a start tag without errors. This is the most common case, so it must be fast."""
        attributes: list[Attribute] = []
        start, end = match.span(2)
        if start != end:
            seen: dict[str, Attribute] = {}
            for written in _SOUND_ATTRIBUTE.finditer(self.text, start, end):
                group = written.lastindex or 2
                name, value = written[1], written[group]
                value_span = span_of(written.span(group))
                if "&" in value:
                    self.check_references(value_span)
                    value = unescape(value)
                attribute = Attribute(name, value, span_of(written.span(1)), value_span, span_of(written.span()))
                attributes.append(attribute)
                if seen.setdefault(name, attribute) is not attribute:
                    self.duplicate(attribute, seen[name])
        return self.open_element(match, attributes, match.end(), match[3] is not None, complete=True)

    def start_tag(self, at: int, match: re.Match[str]) -> int:
        """Read a start tag with errors."""
        text = self.text
        attributes: list[Attribute] = []
        first: dict[str, Attribute] = {}
        position = match.end()
        self.check_name(Span(*match.span(1)))
        while not self.hopeless:
            if tag_end := _TAG_END.match(text, position):
                self.check_space(position, tag_end.start(1))
                return self.open_element(match, attributes, tag_end.end(), tag_end[1] == "/>", complete=True)
            written = _ATTRIBUTE.match(text, position)
            if written is None:
                junk = _JUNK.match(text, position)
                if junk is None:
                    break
                drop = Fix("Remove it", (TextEdit(Span(*junk.span(1)), ""),), preferred=False)
                self.report(Span(*junk.span(1)), f'`{junk[1][:20]}` is not an attribute; write `name="value"`', drop)
                position = junk.end()
                continue
            attribute = self.attribute(written, position)
            if first.setdefault(attribute.name, attribute) is not attribute:
                self.duplicate(attribute, first[attribute.name])
            attributes.append(attribute)
            position = attribute.span.end
        self.report(
            Span(*match.span()),
            f"the start tag `<{shown(match[1])}` has no `>`",
            Fix("Insert `>`", (TextEdit(Span(position, position), ">"),), preferred=False),
        )
        space = _TAG_SPACE.match(text, position)
        return self.open_element(match, attributes, space.end() if space else position, False, complete=False)

    def attribute(self, match: re.Match[str], at: int) -> Attribute:
        """Read the attribute that follows the offset `at`, possibly after white space."""
        name, equals = match[1], match[2]
        name_span = Span(*match.span(1))
        self.check_name(name_span)
        if name_span.start > at:
            self.check_space(at, name_span.start)
        else:
            insert = Fix("Insert a space", (TextEdit(Span(at, at), " "),), safe=True)
            self.report(name_span, "a space is missing before this attribute", insert, tolerated=True)
        if equals is not None:
            self.check_space(*match.span(2))
        else:
            insert = Fix('Add `=""`', (TextEdit(Span(name_span.end, name_span.end), '=""'),), preferred=False)
            self.report(name_span, f"the attribute `{shown(name)}` has no value", insert)
            return Attribute(name, "", name_span, Span(name_span.end, name_span.end), name_span, has_value=False)
        group = 3 if match[3] is not None else 4
        raw = match[group]
        if raw is not None:
            value_span = Span(*match.span(group))
            if (end := self.swallowing(value_span)) is not None:
                return self.open_value(name, name_span, Span(value_span.start, end))
            if "&" in raw:
                self.check_references(value_span)
            return Attribute(name, unescape(raw), name_span, value_span, Span(name_span.start, match.end()))
        return self.odd_value(name, name_span, match.end(2))

    def odd_value(self, name: str, name_span: Span, at: int) -> Attribute:
        """Read a value that contains `<`, has no closing quote, or has no quotes at all."""
        text = self.text
        quote = text[at : at + 1]
        if quote not in ('"', "'"):
            unquoted = _UNQUOTED.match(text, at)
            end = unquoted.end() if unquoted else at
            if text[at - 1].isspace() and _NEXT_ATTRIBUTE.match(text, at):
                end = at = self.trim(name_span.end, at)
            value_span = Span(at, end)
            if end == at:
                insert = Fix('Add `""`', (TextEdit(Span(at, at), '""'),), preferred=False)
                message = f'the attribute `{shown(name)}` has no value; write `{shown(name)}="…"`'
                self.report(Span(name_span.start, at), message, insert)
                return Attribute(name, "", name_span, value_span, Span(name_span.start, end), has_value=False)
            quoted = (TextEdit(Span(at, at), '"'), TextEdit(Span(end, end), '"'))
            self.report(value_span, "an attribute value needs quotes", Fix("Add quotes", quoted))
            self.check_references(value_span)
            return Attribute(name, unescape(text[at:end]), name_span, value_span, Span(name_span.start, end))
        start = at + 1
        close = text.find(quote, start, start + _MAX_ODD_VALUE_LENGTH)
        if close >= 0 and self.is_plausible_value(start, close):
            value_span = Span(start, close)
            for less in _LESS.finditer(text, start, close):
                if self.hopeless:
                    break
                place = Span._make(less.span())
                escape = Fix("Write `&lt;`", (TextEdit(place, "&lt;"),), safe=True)
                self.report(place, "`<` in an attribute value must be written `&lt;`", escape, tolerated=True)
            self.check_references(value_span)
            raw = text[start:close]
            return Attribute(name, unescape(raw), name_span, value_span, Span(name_span.start, close + 1))
        next_tag = text.find("<", start)
        stop = len(text) if next_tag < 0 else next_tag
        line_end = next((i for i in (text.find("\n", start, stop), text.find("\r", start, stop)) if i >= 0), stop)
        greater = text.find(">", start, line_end)
        end = line_end if greater < 0 else greater
        if end > start and text[end - 1] == "/":
            end -= 1
        return self.open_value(name, name_span, Span(start, end))

    def open_value(self, name: str, name_span: Span, value: Span) -> Attribute:
        """Read a value without its closing quote."""
        start, end = value.start, self.trim(*value)
        quote = self.text[start - 1]
        self.report(
            Span(name_span.start, end),
            f"the value of `{shown(name)}` has no closing {quote}",
            Fix(f"Insert {quote}", (TextEdit(Span(end, end), quote),)),
        )
        self.check_references(Span(start, end))
        raw = self.text[start:end]
        return Attribute(name, unescape(raw), name_span, Span(start, end), Span(name_span.start, end))

    def swallowing(self, value: Span) -> int | None:
        """The end of a value without a closing quote, if `value` ends at the opening quote of the next attribute;
        `None` if the quote at the end of `value` closes it."""
        text = self.text
        if text[value.end - 1] != "=" and not text[value.end - 1].isspace():
            return None
        next_attribute = _SWALLOWED.search(text, *value)
        if next_attribute is None:
            return None
        on_next_line = "\n" in text[value.start : value.end]
        return next_attribute.start() if on_next_line or not _AFTER_VALUE.match(text, value.end + 1) else None

    def is_plausible_value(self, start: int, close: int) -> bool:
        """Whether the quote at `close` ends the value that begins at `start`. Otherwise it probably belongs to a later
        attribute, and the value has no closing quote."""
        text = self.text
        if text[close - 1] == "=" and close - 1 >= start:
            return False
        if not _AFTER_VALUE.match(text, close + 1):
            return False
        less = text.find("<", start, close)
        while less >= 0:
            # A `<` that begins a line, or that begins `</`, `<!` or `<?`, is a tag and not "less than".
            before = text.rfind("\n", start, less)
            if text[less + 1 : less + 2] in ("/", "!", "?") or (before >= 0 and not text[before:less].strip()):
                return False
            less = text.find("<", less + 1, close)
        return True

    def open_element(
        self, match: re.Match[str], attributes: list[Attribute], end: int, self_closing: bool, *, complete: bool
    ) -> int:
        name = match[1]
        prefix, colon, local = name.partition(":")
        if not colon:
            prefix, local = "", prefix
        element = Element(local, prefix, span_of(match.span(1)), attributes, span_of((match.start(), end)))
        element.self_closing = self_closing
        element.complete = complete
        if not self.stack and not colon:
            self.namespaces |= {attribute.value for attribute in attributes if attribute.name == "xmlns"}
        if colon or ":" in self.text[match.end(1) : end]:
            self.check_prefixes(element)
        if len(self.stack) < MAX_DEPTH:
            self.add(element)
        else:
            self.skipped_depth += not self_closing
            self.hopeless = self.hopeless or self.skipped_depth > _MAX_SKIPPED_DEPTH
            if self.skipped_depth == (0 if self_closing else 1):
                self.too_deep(element)
        if not self_closing:
            self.stack.append(element)
            self.names.append(name)
            self.open_names[name] = self.open_names.get(name, 0) + 1
        return end

    def end_tag(self, at: int) -> int:
        match = _END_TAG.match(self.text, at)
        assert match is not None
        name = match[2]
        if name is None:
            return self.nameless_end_tag(Span(at, match.end() if match[3] else at + 2))
        name_span = span_of(match.span(2))
        if match[1]:
            gap = Span(*match.span(1))
            self.report(gap, "the name must follow `</` directly", Fix("Remove the space", (TextEdit(gap, ""),)))
        if match[3]:
            self.check_space(name_span.end, match.end())
        end = match.end() if match[3] else self.end_tag_junk(Span(at, name_span.end))
        tag = span_of((at, end))
        if not self.stack:
            drop = Fix("Remove it", (TextEdit(tag, ""),))
            self.stray(tag, f"`</{shown(name)}>` closes no element; remove it", drop)
        elif self.open_names.get(name) and not self.is_misnamed(name, at):
            while self.names[-1] != name:
                self.close_unclosed(at)
            self.close(tag, name_span)
        elif resemble(name, self.names[-1]) or self.is_misnamed(name, at):
            open_name = self.names[-1]
            self.report(
                name_span,
                f"`</{shown(name)}>` does not match `<{shown(open_name)}>`",
                Fix(f"Write `{shown(open_name)}`", (TextEdit(name_span, open_name),)),
                related=(Related(self.stack[-1].name_span, "opened here"),),
            )
            self.close(tag, name_span)
        else:
            drop = Fix("Remove it", (TextEdit(tag, ""),), preferred=False)
            message = f"`</{shown(name)}>` closes no element; the open element is `<{shown(self.names[-1])}>`"
            self.stray(tag, message, drop)
        return end

    def is_misnamed(self, name: str, at: int) -> bool:
        """Whether the end tag `name` at `at` closes the innermost element although the names differ.

        This is so if the end tag is indented like the innermost element, but not like the innermost open element that
        is called `name`, or, if there is none, the parent of the innermost element.
        """
        if self.names[-1] == name or len(self.stack) < 2:
            return False
        indentation = self.indentation(at)
        if indentation is None or self.indentation(self.stack[-1].open_span.start) != indentation:
            return False
        outer = self.stack[-2]
        if self.open_names.get(name):
            outer = next(e for e, other in zip(self.stack[::-1], self.names[::-1], strict=True) if other == name)
        return self.indentation(outer.open_span.start) not in (indentation, None)

    def indentation(self, at: int) -> str | None:
        """The white space before `at` in its line; `None` if other text precedes it."""
        line = self.text[self.text.rfind("\n", 0, at) + 1 : at]
        return None if line.strip() else line

    def stray(self, tag: Span, message: str, drop: Fix) -> None:
        self.report(tag, message, drop)
        self.add(Text("", tag))

    def nameless_end_tag(self, tag: Span) -> int:
        if not self.stack:
            self.stray(tag, "the end tag has no name", Fix("Remove it", (TextEdit(tag, ""),)))
            return tag.end
        open_name = self.names[-1]
        write = Fix(f"Write `</{shown(open_name)}>`", (TextEdit(tag, f"</{open_name}>"),))
        self.report(tag, f"the end tag has no name; the open element is `<{shown(open_name)}>`", write)
        self.close(tag, Span(tag.start + 2, tag.start + 2))
        return tag.end

    def end_tag_junk(self, tag: Span) -> int:
        """Report text after the name in an end tag; return where the tag ends."""
        if junk := _END_TAG_JUNK.match(self.text, tag.end):
            place = Span(junk.start(), junk.end() - 1)
            self.report(place, "an end tag contains only its name", Fix("Remove it", (TextEdit(place, ""),)))
            return junk.end()
        insert = Fix("Insert `>`", (TextEdit(Span(tag.end, tag.end), ">"),))
        self.report(tag, "the end tag has no `>`", insert)
        return tag.end

    # --------------------------------------------------------------- closing

    def close(self, tag: Span, name_span: Span) -> None:
        element = self.pop()
        element.span = span_of((element.span.start, tag.end))
        element.close_span = tag
        element.close_name_span = name_span

    def close_unclosed(self, at: int) -> None:
        """End the innermost element, whose end tag is missing, before offset `at`."""
        name = self.names[-1]
        element = self.pop()
        was_complete, element.complete = element.complete, False
        if not was_complete:
            # The start tag is still being typed: the text after it is its sibling, not its child.
            siblings = self.stack[-1] if self.stack else None
            nodes, elements = element.nodes, element.elements
            element.nodes, element.elements = [], []
            (siblings.nodes if siblings else self.nodes).extend(nodes)
            if siblings:
                siblings.elements.extend(elements)
            return
        element.span = Span(element.span.start, at)
        end = self.trim(element.open_span.end, at)
        close_tag = Fix(f"Insert `</{shown(name)}>`", (TextEdit(Span(end, end), f"</{name}>"),))
        if not element.elements and not children_text(element).strip(SPACE):
            slash = element.open_span.end - 1
            close_tag = Fix("Close it with `/>`", (TextEdit(Span(slash, slash), " /"),))
        self.report(element.name_span, f"`<{shown(name)}>` is never closed", close_tag)

    def pop(self) -> Element:
        element, name = self.stack.pop(), self.names.pop()
        self.open_names[name] -= 1
        if self.skipped_depth:
            self.skipped_depth -= 1
        self.forget_prefixes()
        return element

    def forget_prefixes(self) -> None:
        """Remove the prefixes that no element in `stack` declares."""
        while self.declared and self.declared[-1][0] >= len(self.stack):
            self.prefixes[self.declared.pop()[1]].pop()

    # ------------------------------------------------------ everything else

    def comment(self, at: int) -> int:
        close = self.text.find("-->", at + 4)
        end = len(self.text) if close < 0 else close + 3
        if close < 0:
            self.report(Span(at, at + 4), "the comment is never closed with `-->`")
        content_end = end if close < 0 else close
        if (double := self.text.find("--", at + 4, content_end + 1)) >= 0:
            self.dashes(Span(double, double + 2), Span(double, content_end))
        self.add(Comment(self.text[at + 4 : content_end], Span(at, end)))
        return end

    def dashes(self, first: Span, rest: Span) -> None:
        """Report the first `--` in a comment; `rest` is the comment from there to its end."""
        edits = [TextEdit(span_of(run.span()), "=" * len(run[0])) for run in _DASHES.finditer(self.text, *rest)]
        if self.text[rest.start : rest.end].endswith("-") and (not edits or edits[-1].span.end < rest.end):
            edits.append(TextEdit(Span(rest.end - 1, rest.end), "="))
        fix = Fix("Write `=` for each of these dashes", tuple(edits), safe=True)
        self.report(first, "`--` is not allowed inside a comment", fix, tolerated=True)

    def cdata(self, at: int) -> int:
        close = self.text.find("]]>", at)
        end = len(self.text) if close < 0 else close + 3
        if close < 0:
            self.report(Span(at, at + 9), "the CDATA section is never closed with `]]>`")
        self.add(CData(self.text[at + 9 : end if close < 0 else close], Span(at, end)))
        return end

    def instruction(self, at: int) -> int:
        close = self.text.find("?>", at) if self.instructions_end else -1
        if close < 0:
            self.instructions_end = False
            less = self.text.find("<", at + 1)
            end = self.trim(at + 2, len(self.text) if less < 0 else less)
            self.report(Span(at, end), "the processing instruction is never closed with `?>`")
        else:
            end = close + 2
            self.check_instruction(Span(at, end))
        self.add(Instruction(self.text[at + 2 : end if close < 0 else close], Span(at, end)))
        return end

    def document_type(self, at: int) -> int:
        text, end = self.text, document_type_end(self.text, at)
        span = Span(at, end)
        self.add(Instruction(text[at + 2 : end], span))
        has_entities = "<!ENTITY" in text[at:end]
        if has_entities:
            message = "entities are not expanded; write out their text"
        else:
            message = "a document type declaration has no effect and is not read"
        self.report(span, message, Fix("Remove it", (TextEdit(span, ""),), safe=not has_entities), code="document-type")
        return end

    def add_text(self, start: int, end: int) -> None:
        raw = self.text[start:end]
        if "&" in raw:
            self.check_references(Span(start, end))
        if (close := raw.find("]]>")) >= 0:
            place = Span(start + close, start + close + 3)
            escape = Fix("Write `]]&gt;`", (TextEdit(place, "]]&gt;"),))
            self.report(
                place, "`]]>` is only allowed at the end of a CDATA section; write `]]&gt;` for the text", escape
            )
        self.add(Text(unescape(raw), span_of((start, end))))

    def add(self, node: Node) -> None:
        if not self.stack:
            self.nodes.append(node)
        elif not self.skipped_depth:
            parent = self.stack[-1]
            parent.nodes.append(node)
            if isinstance(node, Element):
                parent.elements.append(node)

    # ---------------------------------------------------------------- checks

    def check_characters(self) -> None:
        if bad := FORBIDDEN.search(self.text):
            # BehaviorTree.CPP reads a text only up to U+0000.
            message = f"the character U+{ord(bad[0]):04X} is not allowed in XML"
            self.report(Span(*bad.span()), message, tolerated="\0" not in self.text)

    def check_references(self, span: Span) -> None:
        for match in _AMPERSAND.finditer(self.text, span.start, span.end):
            if self.hopeless:
                return
            reference = REFERENCE.match(self.text, match.start(), span.end)
            if reference is None:
                escape = Fix("Write `&amp;`", (TextEdit(Span(*match.span()), "&amp;"),), safe=True)
                self.report(Span(*match.span()), "a literal `&` must be written `&amp;`", escape, tolerated=True)
                continue
            decimal, hexadecimal, name = reference.groups()
            place = Span(*reference.span())
            if name and name not in PREDEFINED:
                escape = Fix("Write `&amp;`", (TextEdit(Span(*match.span()), "&amp;"),), preferred=False)
                message = f"the entity `&{name};` is not defined; entities are not expanded"
                self.report(place, message, escape, code="undefined-entity", tolerated=True)
            elif not name and not is_character(int(decimal) if decimal else int(hexadecimal, 16)):
                self.report(place, f"`{reference[0]}` is not a character that XML allows")

    def check_name(self, span: Span) -> None:
        name = self.text[span.start : span.end]
        if not is_name(name):
            self.report(span, f"`{shown(name)}` is not a valid XML name")

    def check_space(self, start: int, end: int) -> None:
        """Report characters that look like a space but are not white space in XML."""
        if odd := _ODD_SPACE.search(self.text, start, end):
            place = Span(*odd.span())
            message = f"the character U+{ord(odd[0][0]):04X} is not white space in XML; replace it with a space"
            self.report(place, message, Fix("Write a space", (TextEdit(place, " "),)))

    def check_prefixes(self, element: Element) -> None:
        for attribute in element.attributes:
            if attribute.name.startswith("xmlns:"):
                prefix = attribute.name[6:]
                self.declared.append((len(self.stack), prefix))
                self.prefixes.setdefault(prefix, []).append(attribute.value)
        for span in (element.name_span, *(attribute.name_span for attribute in element.attributes)):
            prefix, colon, _ = self.text[span.start : span.end].partition(":")
            if colon and not self.prefixes.get(prefix) and is_name(prefix):
                place = Span(span.start, span.start + len(prefix))
                self.report(place, f"the prefix `{shown(prefix)}` is not declared with `xmlns:{shown(prefix)}`")
        declared = self.prefixes.get(element.prefix)
        if element.prefix and declared:
            if not self.stack:
                self.namespaces.add(declared[-1])
            element.is_foreign = declared[-1] not in self.namespaces
        element.is_undeclared = bool(element.prefix) and not declared
        if element.self_closing:
            self.forget_prefixes()

    def check_instruction(self, span: Span) -> None:
        content = self.text[span.start + 2 : span.end - 2]
        name = leading_local_name(content)
        if not name:
            self.report(span, "a processing instruction must begin with a name")
        elif name == "xml" and span.start > 0:
            before = Span(0, span.start)
            is_blank = not self.text[: span.start].strip(SPACE)
            drop = (Fix("Remove the white space before it", (TextEdit(before, ""),), safe=True),) if is_blank else ()
            message = "the XML declaration must be at the very beginning of the file"
            self.report(span, message, *drop, tolerated=is_blank)
        elif name == "xml":
            self.check_declaration(content, span)

    def check_declaration(self, content: str, span: Span) -> None:
        declaration = _XML_DECLARATION.fullmatch(content)
        if declaration is None:
            self.report(span, 'an XML declaration must have the form `<?xml version="1.0" encoding="UTF-8"?>`')
        elif encoding := declaration["encoding"]:
            try:
                codecs.lookup(encoding)
            except LookupError:
                start = span.start + 2 + declaration.start("encoding")
                place = Span(start, start + len(encoding))
                write = Fix("Write `UTF-8`", (TextEdit(place, "UTF-8"),))
                self.report(place, f"unknown encoding `{shown(encoding)}`; the file was read as UTF-8", write)

    def check_roots(self) -> Element | None:
        roots = [node for node in self.nodes if isinstance(node, Element)]
        if not roots:
            self.report(Span(0, min(1, len(self.text))), "the file contains no element")
            return None
        for extra in roots[1:]:
            self.report(
                extra.name_span,
                f"a document must have one root; `<{shown(extra.name)}>` is outside of `<{shown(roots[0].name)}>`",
                related=(Related(roots[0].name_span, "the root"),),
            )
        for node in self.nodes:
            raw = self.text[node.span.start : node.span.end]
            is_data = isinstance(node, CData) or (isinstance(node, Text) and node.value)
            if is_data and (stripped := raw.strip(SPACE)):
                start = node.span.start + raw.index(stripped)
                self.report(Span(start, start + len(stripped)), "text outside of the root element")
        return roots[0]

    def duplicate(self, attribute: Attribute, first: Attribute) -> None:
        self.report(
            attribute.name_span,
            f"the attribute `{shown(attribute.name)}` is given twice",
            Fix("Remove this one", (TextEdit(attribute.span, ""),), preferred=False),
            code="duplicate-attribute",
            related=(Related(first.name_span, "given first here"),),
        )

    def too_deep(self, element: Element) -> None:
        message = f"elements are nested more than {MAX_DEPTH} levels deep; their content is not analysed"
        self.report(element.name_span, message, code="nesting-too-deep")

    def report(
        self,
        span: Span,
        message: str,
        *fixes: Fix,
        code: str = "xml-syntax",
        related: tuple[Related, ...] = (),
        tolerated: bool = False,
    ) -> None:
        self.reported[tolerated] += 1
        if self.reported[tolerated] <= (MAX_TOLERATED if tolerated else MAX_FINDINGS):
            finding = Finding(code, span, message, fixes=fixes, related=related, tolerated=tolerated)
            self.findings.append(finding)
        elif not tolerated and not self.hopeless:
            self.hopeless = True
            self.findings.append(Finding("xml-syntax", span, "too many errors: the file is not read from here on"))

    def trim(self, start: int, end: int) -> int:
        """The end of the text from `start` to `end` without white space at its end."""
        while end > start and self.text[end - 1] in SPACE:
            end -= 1
        return end


def document_type_end(text: str, at: int) -> int:
    """The end of the document type declaration that begins at `at`; the end of the text if it is never closed."""
    inside, position = False, at
    while match := _DOCTYPE_MARK.search(text, position):
        mark, position = match[0], match.end()
        if closer := _DOCTYPE_CLOSERS.get(mark):
            close = text.find(closer, position)
            if close < 0:
                break
            position = close + len(closer)
        elif mark == ">" and not inside:
            return position
        else:
            inside = mark == "[" or (inside and mark != "]")
    start = text.find("]", at) if inside else at
    end = text.find(">", start) if start >= 0 else -1
    return len(text) if end < 0 else end + 1


def resemble(name: str, open_name: str) -> bool:
    """Whether the end tag `name` is probably intended to close the element `open_name`."""
    if name.rpartition(":")[2] == open_name.rpartition(":")[2]:
        return True
    return are_similar(name, open_name)


def shown(name: str) -> str:
    """`name` for a message, shortened to at most 60 characters."""
    return name if len(name) <= 60 else f"{name[:59]}…"
