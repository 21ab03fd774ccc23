# SPDX-License-Identifier: Apache-2.0
"""Text of a `.msg`, `.srv` or `.action` file -> definition.

- Never fails and takes time linear in the text: every error becomes a finding with its span, and parsing continues.
- Readable parts are kept: a field with an invalid name or type is still a field, so that uses of the field cause no
  further errors. If two fields or constants have the same name, only the second is left out.
- Comments are attached as in `rosidl`. The comment at the beginning of a section belongs to the section. A comment
  directly above a field or constant, after it on the same line, or indented below it belongs to this field or constant.
  An empty line ends a comment.

Source of the syntax: the ROS 2 documentation, "About ROS 2 interfaces", and `rosidl_adapter`.
"""

from __future__ import annotations

from roaml.diagnostics import Finding, Related, Severity
from roaml.interfaces.names import CONSTANT_NAME, FIELD_NAME, keyword_of, lower_snake, upper_snake
from roaml.interfaces.report import FileFindings, shorten
from roaml.interfaces.type_syntax import find_type, parse_type
from roaml.interfaces.types import (
    SECTION_NAMES,
    Constant,
    Definition,
    Field,
    FieldType,
    Kind,
    Section,
    with_article,
)
from roaml.interfaces.values import parse_scalar, parse_value, skip_blanks, value_end
from roaml.record import Record, field, replace
from roaml.regex import regex
from roaml.text import Span

MAX_LENGTH = 1_000_000
"""The maximum number of characters of a definition that are read. The line that crosses this limit and all lines after
it are not read. Real definitions are a hundred times shorter."""

_LINE = regex(r"([^\r\n]*)(?:\r\n|\r|\n|\Z)")
_NAME = regex(r"[^ \t#=]+")
_DASHES = regex(r"--+")
_NAME_AND_SIZE = regex(r"([^\[]+)(\[[^\]]*\])")
_PLACEHOLDER = "structure_needs_at_least_one_member"


def parse(text: str, package: str, name: str, kind: Kind) -> tuple[Definition, tuple[Finding, ...]]:
    """The definition `package/name` in `text`, and the errors in the text.

    The definition always has all sections of its kind; those missing in the text are empty.
    """
    report = FileFindings()
    parser = _Parser(text, package, kind, report)
    sections = parser.run()
    is_complete = len(parser.sections) == len(SECTION_NAMES[kind])
    return Definition(package, name, kind, sections, is_complete=is_complete), report.findings()


class _Head(Record, frozen=True):
    """The part before the value of a field or constant. `type_is_known` is true if the type is primitive or was read
    without errors."""

    type: FieldType
    type_span: Span
    type_is_known: bool
    name: str
    name_span: Span


class _Element(Record):
    """A field or constant whose comment has not been read completely yet."""

    item: Field | Constant
    comment: list[str]

    def finish(self) -> Field | Constant:
        return replace(self.item, comment="\n".join(self.comment)) if self.comment else self.item


class _OpenSection(Record):
    elements: dict[str, _Element] = field(default_factory=dict)
    comment: list[str] = field(default_factory=list)

    def finish(self) -> Section:
        items = [element.finish() for element in self.elements.values()]
        return Section(
            tuple(item for item in items if isinstance(item, Field)),
            tuple(item for item in items if isinstance(item, Constant)),
            "\n".join(self.comment),
        )


class _Parser:
    def __init__(self, text: str, package: str, kind: Kind, report: FileFindings) -> None:
        self.text = text
        self.package = package
        self.kind = kind
        self.report = report
        self.sections = [_OpenSection()]
        self.opening = True  # whether only comment lines have been read in this section
        self.above: list[str] = []  # comment lines above the next element
        self.content = Span(len(text), len(text))  # the last line that is neither empty nor a comment
        self.last: _Element | None = None  # the element that an indented comment line continues

    def run(self) -> tuple[Section, ...]:
        text, names = self.text, SECTION_NAMES[self.kind]
        length = len(text) if len(text) <= MAX_LENGTH else text.rfind("\n", 0, MAX_LENGTH) + 1
        for line in _LINE.finditer(text, 0, length):
            start = line.start()
            self.line(start, start + len(line[1].rstrip()))
            if self.report.is_full:
                break
        else:
            if length < len(text):
                message = f"too long for an interface definition; only the first {MAX_LENGTH:,} characters are read"
                self.report.add(Span(length, len(text)), message)
            elif missing := names[len(self.sections) :]:
                self.report_missing(missing)
        sections = [section.finish() for section in self.sections[: len(names)]]
        return (*sections, *(Section() for _ in names[len(sections) :]))

    def line(self, start: int, end: int) -> None:
        first = skip_blanks(self.text, start, end)
        if first >= end:
            self.opening, self.last = False, None
            self.above.clear()
        elif self.text[first] == "#":
            self.comment_line(_comment(self.text[first:end]), indented=first > start)
        else:
            self.opening, self.content = False, Span(first, end)
            if dashes := _DASHES.match(self.text, first, end):
                self.separator(Span(first, end), dashes.end())
            else:
                self.element(first, end)

    def comment_line(self, comment: str, *, indented: bool) -> None:
        if indented and self.last and not self.above:
            self.last.comment.append(comment)
        elif self.opening and not indented:
            self.sections[-1].comment.append(comment)
        else:
            self.opening = False
            self.above.append(comment)

    # -------------------------------------------------------------- sections

    def separator(self, span: Span, dashes_end: int) -> None:
        names = SECTION_NAMES[self.kind]
        if len(self.sections) >= len(names):
            if self.kind == "msg":
                message = "only services (.srv) and actions (.action) have sections; remove this `---`"
            else:
                message = (
                    f"{with_article(self.kind)} has {len(names)} sections, {_and(names)}; this `---` begins an "
                    "additional one"
                )
            self.report.add(span, message)
        elif self.text[span.start : span.end] != "---":
            instead = "---" if dashes_end == span.end else None
            self.report.add(span, "the line between two sections must be exactly `---`", instead=instead)
        self.sections.append(_OpenSection())
        self.opening, self.last = True, None
        self.above.clear()

    def report_missing(self, names: tuple[str, ...]) -> None:
        end = len(self.text)
        new_line = "" if self.text.endswith(("\n", "\r")) or not self.text else "\n"
        self.report.add(
            self.content,
            f"{with_article(self.kind)} has the sections {_and(SECTION_NAMES[self.kind])}, separated by lines `---`; "
            f"missing here: {_and(names)}",
            instead=new_line + "---\n" * len(names),
            at_end=end,
            before=self.content.start if self.may_be_response() else None,
        )

    def may_be_response(self) -> bool:
        """Whether the only content of a service is one field. It is more often the answer of a service without
        arguments than the argument of one without an answer."""
        elements = list(self.sections[0].elements.values())
        is_alone = len(elements) == 1 and isinstance(elements[0].item, Field)
        return self.kind == "srv" and len(self.sections) == 1 and is_alone

    # -------------------------------------------------------------- elements

    def element(self, start: int, end: int) -> None:
        """Read a field or constant (`type name`, `type name default` or `type NAME=value`) and its comment."""
        text = self.text
        comment, self.above, self.last = self.above, [], None
        type_span = find_type(text, start, end)
        if "=" in text[type_span.start : type_span.end].replace("<=", ""):
            self.report.add(type_span, "the type of the constant is missing; write `type NAME=value`")
            return
        head = self.head(type_span, end)
        after = skip_blanks(text, head.name_span.end, end)
        is_constant = after < end and text[after] == "="
        if not head.name:
            self.report_no_name(head, is_constant)
            return
        item: Field | Constant
        if is_constant:
            value_start = skip_blanks(text, after + 1, end)
            after = value_end(text, value_start, end)
            item = self.constant(head, Span(value_start, after))
        elif after < end and text[after] != "#":
            value_start, after = after, value_end(text, after, end)
            item = self.field(head, Span(value_start, after))
        else:
            item = self.field(head, None)
        comment_start = skip_blanks(text, after, end)
        if comment_start < end:
            comment.append(_comment(text[comment_start:end]))
        self.add(item, comment)

    def head(self, type_span: Span, end: int) -> _Head:
        errors_before = len(self.report)
        type_ = parse_type(self.text, type_span, self.package, self.report)
        is_known = type_.is_primitive or len(self.report) == errors_before
        name_start = skip_blanks(self.text, type_span.end, end)
        name = _NAME.match(self.text, name_start, end)
        name_span = Span(*name.span()) if name else Span(name_start, name_start)
        return _Head(type_, type_span, is_known, self.text[name_span.start : name_span.end], name_span)

    def field(self, head: _Head, value_span: Span | None) -> Field:
        name = self.check_field_name(head)
        if value_span is None:
            return Field(name, head.type, name_span=head.name_span, type_span=head.type_span)
        value = parse_value(self.text, value_span, head.type, self.report) if head.type_is_known else None
        written = self.text[value_span.start : value_span.end]
        return Field(name, head.type, value, written, "", head.name_span, head.type_span, value_span)

    def constant(self, head: _Head, value_span: Span) -> Constant:
        self.check_constant_name(head)
        value = None
        if head.type.is_array:
            self.report.add(head.type_span, "a constant must be a single value; ROS 2 does not support array constants")
        elif head.type.is_primitive:
            if head.type.string_bound is not None:
                message = f"the string of a constant cannot have a bound; write `{head.type.name}`"
                self.report.add(head.type_span, message, instead=head.type.name)
            value = parse_scalar(self.text, value_span, head.type, self.report)
        elif head.type_is_known:
            message = f"a constant must have a primitive type; `{shorten(head.type.name)}` is a message type"
            self.report.add(head.type_span, message)
        written = self.text[value_span.start : value_span.end]
        return Constant(head.name, head.type, value, written, "", head.name_span, head.type_span, value_span)

    def add(self, item: Field | Constant, comment: list[str]) -> None:
        self.last = _Element(item, comment)
        first = self.sections[-1].elements.setdefault(item.name, self.last)
        if first is not self.last:
            related = Related(first.item.name_span, "first defined here")
            self.report.add(
                item.name_span,
                f"`{shorten(item.name)}` is defined twice; rename or remove one definition",
                related=(related,),
            )

    # ----------------------------------------------------------------- names

    def report_no_name(self, head: _Head, is_constant: bool) -> None:
        if is_constant:
            self.report.add(head.name_span, "a name is missing; a constant is written `type NAME=value`")
        elif head.type_is_known:
            written = self.text[head.type_span.start : head.type_span.end]
            message = f"the field of type `{shorten(written)}` has no name; a field is written `type name`"
            self.report.add(head.type_span, message)

    def check_field_name(self, head: _Head) -> str:
        """Report errors in the name of a field; return the name to use for the field."""
        name, span = head.name, head.name_span
        if FIELD_NAME.fullmatch(name):
            if language := keyword_of(name):
                message = f"`{name}` is a keyword of {language}, so ROS 2 generates invalid code; rename this field"
                self.report.add(span, message, severity=Severity.WARNING)
            elif name == _PLACEHOLDER:
                message = f"`{name}` is reserved for the member that ROS 2 adds to an empty message; rename this field"
                self.report.add(span, message)
            return name
        if sized := _NAME_AND_SIZE.fullmatch(name):
            right = f"{self.text[head.type_span.start : head.type_span.end]}{sized[2]} {sized[1]}"
            message = f"the size of an array is part of its type; write `{shorten(right)}`"
            self.report.add(head.type_span.cover(span), message, instead=right)
            return sized[1]
        message = f"`{shorten(name)}` is not a valid field name; field names are lower_snake_case"
        if CONSTANT_NAME.fullmatch(name):
            message += ", and a constant is written `NAME=value`"
        self.report.add(span, message, instead=lower_snake(name) or None)
        return name

    def check_constant_name(self, head: _Head) -> None:
        name, span = head.name, head.name_span
        if CONSTANT_NAME.fullmatch(name):
            return
        message = f"`{shorten(name)}` is not a valid constant name; constants are UPPER_SNAKE_CASE"
        if FIELD_NAME.fullmatch(name):
            message += f", and a default is written without `=`: `{head.type} {shorten(name)} value`"
        self.report.add(span, message, instead=upper_snake(name) or None)


def _comment(written: str) -> str:
    """The text of a comment that begins with `#`; additional indentation is kept."""
    return written.lstrip("#").removeprefix(" ").rstrip()


def _and(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
