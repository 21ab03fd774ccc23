# SPDX-License-Identifier: Apache-2.0
"""The syntax of field types: `int32`, `string<=10[<=5]`, `geometry_msgs/Pose[3]`.

Any text gives a type: errors are reported, and the readable part is kept.
"""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.interfaces.names import PACKAGE_NAME, TYPE_NAME
from roaml.interfaces.report import FileFindings, shorten
from roaml.interfaces.types import FOREIGN_TYPES, PRIMITIVES, STRINGS, ArrayKind, FieldType
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean
from roaml.text import Span

_TOKEN = regex(r"[^ \t#<\[]*(?:[ \t]*<=?[ \t]*[^ \t#\[]*)?(?:[ \t]*\[(?:[^\]#]{0,30}\]|[^ \t\]#]*))*[^ \t#]*")
_LIMIT = regex(r"[0-9]{1,10}")
_GREATEST_LIMIT = 2**32 - 1  # lengths are sent as uint32

_FOREIGN_TYPES = {**FOREIGN_TYPES, "octet": "byte"}
_ROS_1_TYPES = {"time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}
_HEADER = "std_msgs/Header"


def find_type(text: str, start: int, end: int) -> Span:
    """The span of the type that begins at `start` and ends before a name. It includes bounds and sizes with spaces,
    such as `<= 5` and `[ 5 ]`."""
    token = _TOKEN.match(text, start, end)
    return Span(start, token.end() if token else start)


def parse_type(text: str, span: Span, package: str, report: FileFindings) -> FieldType:
    """The type in `text[span]`, of a field in a definition of `package`."""
    written = text[span.start : span.end]
    compact = written.replace(" ", "").replace("\t", "")
    if compact != written:
        report.add(span, f"a type cannot contain spaces; write `{shorten(compact)}`", instead=compact)
    element, bracket, tail = compact.partition("[")
    size_written, closing, rest = tail.partition("]")
    base, less, limit = element.partition("<")
    name = _type_name(base, Span(span.start, span.start + len(base)) if base else span, package, report)
    string_bound = None
    if less and name in STRINGS:
        string_bound = _limit(less + limit, span, f"the bound of a string is written `{base}<=N`", report)
    elif less:
        report.add(span, "only strings can have a bound `<=N`; an array of at most N elements is written `T[<=N]`")
    if not bracket:
        return FieldType(name, string_bound)
    if not closing:
        right = f"{compact}]"
        report.add(span, f"the array has no closing `]`; write `{shorten(right)}`", instead=right)
    elif rest:
        report.add(
            span, "an array has only one dimension; for more, use an array of messages that contain the inner array"
        )
    return FieldType(name, string_bound, *_array(size_written, span, report))


def _array(size: str, span: Span, report: FileFindings) -> tuple[ArrayKind, int | None]:
    """The kind of an array and its number of elements, read from `size`, the text between the brackets."""
    if not size:
        return ArrayKind.UNBOUNDED, None
    is_bounded = size.startswith("<")
    limit = _limit(size if is_bounded else f"<={size}", span, "an array is written `T[N]`, `T[<=N]` or `T[]`", report)
    if limit is None:
        return ArrayKind.UNBOUNDED, None
    return (ArrayKind.BOUNDED if is_bounded else ArrayKind.FIXED), limit


def _limit(written: str, span: Span, forms: str, report: FileFindings) -> int | None:
    """The N of `<=N`; `None` if it is invalid. The message about an invalid N begins with `forms`, a clause about the
    valid forms."""
    number = written.removeprefix("<=")
    if number != written and _LIMIT.fullmatch(number) and 1 <= int(number) <= _GREATEST_LIMIT:
        return int(number)
    report.add(span, f"{forms}, with N from 1 to {_GREATEST_LIMIT}")
    return None


def _type_name(written: str, span: Span, package: str, report: FileFindings) -> str:
    if written in PRIMITIVES:
        return written
    if right := _ROS_1_TYPES.get(written):
        report.add(span, f"`{written}` is a type of ROS 1; in ROS 2 write `{right}`", instead=right)
        return right
    if written == "Header" and package != "std_msgs":
        message = f"a bare `Header` is read as `{_HEADER}`, as in ROS 1; in ROS 2, write the package as well"
        report.add(span, message, instead=_HEADER, severity=Severity.WARNING)
        return _HEADER
    if "/" in written:
        return _name_with_package(written, span, report)
    if TYPE_NAME.fullmatch(written):
        return f"{package}/{written}"
    _unknown(written, span, report)
    return f"{package}/{written}"


def _name_with_package(written: str, span: Span, report: FileFindings) -> str:
    package, *middle, name = written.split("/")
    if middle in (["srv"], ["action"]):
        report.add(
            span,
            f"the type of a field must be a message; `{shorten(written)}` is "
            f"{'a service' if middle == ['srv'] else 'an action'}",
        )
    elif middle not in ([], ["msg"]):
        report.add(span, f"`{shorten(written)}` is not the name of a message type; write `package/Name`")
    elif not PACKAGE_NAME.fullmatch(package):
        report.add(span, f"`{shorten(package)}` is not a valid package name; package names are lower_snake_case")
    elif not TYPE_NAME.fullmatch(name):
        report.add(span, f"`{shorten(name)}` is not a valid message name; message names are CamelCase, `package/Name`")
    return f"{package}/{name}"


def _unknown(written: str, span: Span, report: FileFindings) -> None:
    if not written:
        report.add(span, "a type is missing; a field is written `type name`")
        return
    foreign = _FOREIGN_TYPES.get(written.lower())
    close = (foreign,) if foreign else close_names(written, sorted(PRIMITIVES), 1)
    if close:
        report.add(span, f"there is no type `{written}`{did_you_mean(close)}", instead=close[0])
    else:
        report.add(span, f"there is no type `{shorten(written)}`; a message type is written `Name` or `package/Name`")
