# SPDX-License-Identifier: Apache-2.0
"""Names of messages, services and actions -> their definitions.

- Never fails: a type that is not found is a `NotFound` with the reason and similar names.
- The caller provides the function that reads files, so that the text in an editor takes precedence over the file. A
  definition is parsed again only if the digest of its file has changed.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterable, Iterator

from roaml.diagnostics import Finding
from roaml.interfaces.names import PACKAGE_NAME, TYPE_NAME
from roaml.interfaces.parse import parse
from roaml.interfaces.search import SearchPath
from roaml.interfaces.types import KIND_NAMES, KINDS, Definition, Kind, with_article
from roaml.record import Record, replace
from roaml.regex import regex
from roaml.suggest import are_similar, close_names, did_you_mean
from roaml.text import SourceFile

_MAX_CLOSE = 3
"""The maximum number of similar names that are suggested."""
_MAX_NAME_LENGTH = 100
"""The number of characters at the beginning of a malformed name for which similar names are searched."""
_KIND_SUFFIX = regex("_(?:msg|srv|interface|action)s?$")
_WORD_BREAKS = regex(r"[^A-Za-z0-9_]+")


class Reason(enum.Enum):
    """Why a type was not found."""

    MALFORMED_NAME = "malformed name"
    UNKNOWN_PACKAGE = "unknown package"
    UNKNOWN_TYPE = "the package does not contain the type"
    UNREADABLE = "the file cannot be read"
    TOO_LARGE = "the type is too large"
    SECTIONS = "the sections of the file cannot be distinguished"


class NotFound(Record, frozen=True):
    """A requested type that was not found.

    `type_name` is the requested name. `close` are similar names of the same kind, `package/Name`, the nearest first.
    `other_kind` is set if the type exists but is of another kind, such as a service instead of a message. `looked_in`
    are phrases for the places that were searched. `path` is the file that could not be read, or
    whose sections cannot be distinguished. `size` is a phrase for the
    size of a type that is too large.
    """

    reason: Reason
    kind: Kind
    type_name: str
    close: tuple[str, ...] = ()
    other_kind: Kind | None = None
    looked_in: tuple[str, ...] = ()
    path: str | None = None
    size: str = ""

    @property
    def meant(self) -> tuple[str, ...]:
        """The names in `close` that were probably meant. If the package is unknown, it is often in a folder that is not
        searched; then only a similar name of a package shows that it is misspelled."""
        if self.reason is not Reason.UNKNOWN_PACKAGE:
            return self.close
        stem = _stem(self.type_name.partition("/")[0])
        return tuple(name for name in self.close if are_similar(stem, _stem(name.partition("/")[0])))

    @property
    def message(self) -> str:
        """The error and the correction, as a sentence."""
        kind = KIND_NAMES[self.kind]
        hint = did_you_mean(self.close, _MAX_CLOSE)
        package, _, name = self.type_name.partition("/")
        match self.reason:
            case Reason.MALFORMED_NAME:
                return f"`{self.type_name}` is not the name of a {kind} type of the form `package/Name`{hint}"
            case Reason.UNKNOWN_PACKAGE:
                return f"there is no package `{package}`{hint or '; searched ' + ', '.join(self.looked_in)}"
            case Reason.UNKNOWN_TYPE if self.other_kind:
                return f"`{self.type_name}` is {with_article(self.other_kind)}, not {with_article(self.kind)}{hint}"
            case Reason.UNKNOWN_TYPE:
                return f"the package `{package}` has no {kind} `{name}`{hint}"
            case Reason.UNREADABLE:
                return f"the file `{self.path}`, which defines `{self.type_name}`, cannot be read"
            case Reason.TOO_LARGE:
                return f"`{self.type_name}` is too large: with all nested messages, it has {self.size}"
            case Reason.SECTIONS:
                return f"the file `{self.path}`, which defines `{self.type_name}`, has wrong lines `---`"


def _stem(package: str) -> str:
    """The name of a package without endings that many packages have, such as `_msgs`."""
    return _KIND_SUFFIX.sub("", package)


class Parsed(Record, frozen=True):
    """A definition and the errors in its file."""

    definition: Definition
    findings: tuple[Finding, ...]


class Registry:
    """All interface definitions that can be found.

    `read` returns the current content of the file at a path; `None` if the file cannot be read.
    """

    def __init__(self, search_path: SearchPath, read: Callable[[str], SourceFile | None]) -> None:
        self.search_path = search_path
        self._read = read
        self._parsed: dict[str, tuple[tuple[Kind, str, str, str], Parsed]] = {}

    def reading(self, read: Callable[[str], SourceFile | None]) -> Registry:
        """A registry that reads files with `read`. Both registries share the parsed definitions."""
        other = Registry(self.search_path, read)
        other._parsed = self._parsed
        return other

    def message(self, package: str, name: str) -> Definition | NotFound:
        return self.find("msg", package, name)

    def service(self, package: str, name: str) -> Definition | NotFound:
        return self.find("srv", package, name)

    def action(self, package: str, name: str) -> Definition | NotFound:
        return self.find("action", package, name)

    def resolve(self, kind: Kind, type_name: str) -> Definition | NotFound:
        """The definition of the type with a name such as `std_msgs/Int32`, or why there is none."""
        names = split_type_name(type_name, kind)
        if names is None:
            return self._malformed(kind, type_name)
        return self.find(kind, *names)

    def find(self, kind: Kind, package: str, name: str) -> Definition | NotFound:
        parsed = self.parsed(kind, package, name)
        return parsed.definition if isinstance(parsed, Parsed) else parsed

    def other_definition(self, kind: Kind, package: str, name: str) -> Definition | None:
        """A different definition of the same type that is not used, because another one precedes it in the search path;
        `None` if there is none."""
        first = self.find(kind, package, name)
        if isinstance(first, NotFound) or not _is_type_name(package, name):
            return None
        for path in self.search_path.repetitions(package, kind, name)[1:]:
            parsed = self._parse(path, kind, package, name)
            if parsed is not None and parsed.definition.sections != first.sections:
                return parsed.definition
        return None

    def parsed(self, kind: Kind, package: str, name: str) -> Parsed | NotFound:
        """The result of `find` together with the errors in the file of the definition."""
        if not _is_type_name(package, name):
            return self._malformed(kind, f"{package}/{name}")
        path = self.search_path.locate(package, kind, name)
        if path is None:
            return self._not_found(kind, package, name)
        return self._parse(path, kind, package, name) or NotFound(
            Reason.UNREADABLE, kind, f"{package}/{name}", path=path
        )

    def _parse(self, path: str, kind: Kind, package: str, name: str) -> Parsed | None:
        """The definition in a file; `None` if it cannot be read."""
        source = self._read(path)
        if source is None:
            return None
        known = self._parsed.get(path)
        if known and known[0] == (kind, package, name, source.text):
            return known[1]
        definition, findings = parse(source.text, package, name, kind)
        parsed = Parsed(replace(definition, path=path), findings)
        self._parsed[path] = ((kind, package, name, source.text), parsed)
        return parsed

    def _not_found(self, kind: Kind, package: str, name: str) -> NotFound:
        packages = self.search_path.packages()
        requested = f"{package}/{name}"
        looked_in = self.search_path.looked_in()
        if package not in packages:
            similar = close_names(package, packages)
            close = _first([f"{p}/{name}" for p in similar if name in packages[p][kind]], self._named(kind, name))
            if not close:
                close = tuple(f"{p}/{n}" for p in similar for n in close_names(name, packages[p][kind])[:1])
            return NotFound(Reason.UNKNOWN_PACKAGE, kind, requested, close, None, looked_in)
        other_kind = next((other for other in KINDS if name in packages[package][other]), None)
        similar_names = [f"{package}/{n}" for n in close_names(name, packages[package][kind])]
        close = _first(self._named(kind, name), similar_names)
        return NotFound(Reason.UNKNOWN_TYPE, kind, requested, close, other_kind, looked_in)

    def _malformed(self, kind: Kind, requested: str) -> NotFound:
        """The result for a malformed name such as `std_msgs.msg.Int32`, `std_msgs::msg::Int32` or a bare `Int32`, with
        the types that were probably intended."""
        words = [word for word in _WORD_BREAKS.split(requested[:_MAX_NAME_LENGTH]) if word and word not in KINDS]
        close: tuple[str, ...] = ()
        if words:
            packages = self.search_path.packages()
            package, name = words[0], words[-1]
            if package in packages:
                close = tuple(f"{package}/{n}" for n in close_names(name, packages[package][kind]))
            close = close or _first(self._named(kind, name))
        return NotFound(Reason.MALFORMED_NAME, kind, requested, close, None, self.search_path.looked_in())

    def _named(self, kind: Kind, name: str) -> Iterator[str]:
        """All types with this name, in any package."""
        return (f"{p}/{name}" for p, kinds in self.search_path.packages().items() if name in kinds[kind])


def split_type_name(text: str, kind: Kind) -> tuple[str, str] | None:
    """Package and name in `package/Name` or, with the kind in between, `package/msg/Name`; `None` for other texts."""
    package, _, name = text.partition("/")
    name = name.removeprefix(f"{kind}/")
    return (package, name) if _is_type_name(package, name) else None


def _is_type_name(package: str, name: str) -> bool:
    return bool(PACKAGE_NAME.fullmatch(package) and TYPE_NAME.fullmatch(name))


def _first(*groups: Iterable[str]) -> tuple[str, ...]:
    """The first `_MAX_CLOSE` names in the groups, without duplicates."""
    return tuple(dict.fromkeys(name for group in groups for name in group))[:_MAX_CLOSE]
