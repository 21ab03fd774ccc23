# SPDX-License-Identifier: Apache-2.0
"""The search for definition files.

- Places are searched in this order: workspace folders, `--ros-path` folders, the prefixes of `AMENT_PREFIX_PATH`, and
  the standard packages of this tool. The first file of each type is used. So a place that contains only some types of a
  package does not hide the other types of the package in later places.
- A package is a folder with a definition file in its `msg/`, `srv/` or `action/`. Its name is that in its `package.xml`
  if there is one, otherwise that of the folder.
- Only folder listings and the head of `package.xml` are read, once: a place is listed at the first request and again
  only after `refresh`. Unreadable files and folders are treated as missing.
- Names are compared exactly, also on file systems that ignore case.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Protocol, TypeAlias

from roaml.disk import path_of_resource, read
from roaml.interfaces.names import PACKAGE_NAME, TYPE_NAME
from roaml.interfaces.types import KINDS, Kind
from roaml.record import Record
from roaml.regex import regex

MAX_DEPTH = 6
"""The maximum depth of packages below a workspace or `--ros-path` folder."""

MAX_FOLDERS = 10_000
"""The maximum number of folders that are searched below a workspace or `--ros-path` folder, which may be a home folder
or `/`. Folders at a smaller depth are searched first."""

SYSTEM_FOLDERS = frozenset({"/dev", "/proc", "/sys"})
"""Folders of the operating system without files of users; they are not searched."""

SKIPPED_FOLDERS = frozenset({"build", "install", "log", "node_modules", "__pycache__"})
"""Folders that are not searched; folders whose name begins with a dot are not searched either."""

_Files: TypeAlias = Mapping[Kind, Mapping[str, str]]

_NO_FILES: _Files = {kind: {} for kind in KINDS}
_PACKAGE_XML_HEAD = 8192
"""The number of bytes at the beginning of a `package.xml` that are searched for the name of the package."""
_XML_COMMENT = regex(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_XML_NAME = regex(r"<name>\s*([^<>\s]+)\s*</name>")


class SearchPath:
    """The places of definition files, in the order in which they are searched.

    `workspace` are the folders open in the editor or given on the command line. Each of `ros_paths` may be a package, a
    folder of packages at any depth up to `MAX_DEPTH`, or an ament prefix. `ament_prefixes` are the entries of
    `AMENT_PREFIX_PATH`. Relative paths start at the working directory.
    """

    def __init__(
        self, workspace: Iterable[str] = (), ros_paths: Iterable[str] = (), ament_prefixes: Iterable[str] = ()
    ) -> None:
        self._workspace = _absolute(workspace)
        self._ros_paths = _absolute(ros_paths)
        self._ament_prefixes = _absolute(ament_prefixes)
        self._known_places: tuple[_Place, ...] | None = None
        self._packages: Mapping[str, Mapping[Kind, tuple[str, ...]]] | None = None

    def locate(self, package: str, kind: Kind, name: str) -> str | None:
        """The absolute path of the file that defines `package/name`, or `None`."""
        for place in self._places():
            if path := place.files(package)[kind].get(name):
                return path
        return None

    def repetitions(self, package: str, kind: Kind, name: str) -> tuple[str, ...]:
        """All files that define `package/name`; the first one is used.

        The standard packages are left out, because every other definition replaces them intentionally. An ament prefix
        also replaces definitions of later prefixes intentionally, so only the first prefix that has the type is
        included.
        """
        folders: list[str] = []
        in_prefix = False
        for place in self._places()[:-1]:
            is_prefix = isinstance(place, _Share)
            if not (is_prefix and in_prefix):
                paths = place.all_files(package, kind, name)
                in_prefix = in_prefix or (is_prefix and bool(paths))
                folders += paths
        return tuple(dict.fromkeys(folders))

    def packages(self) -> Mapping[str, Mapping[Kind, tuple[str, ...]]]:
        """All types that can be located: package -> kind -> names, with an entry for every kind. Packages and names are
        sorted."""
        if self._packages is None:
            packages: dict[str, dict[Kind, set[str]]] = {}
            for place in self._places():
                for package in place.packages():
                    names = packages.setdefault(package, {kind: set() for kind in KINDS})
                    for kind, files in place.files(package).items():
                        names[kind].update(files)
            self._packages = {
                package: {kind: tuple(sorted(names)) for kind, names in packages[package].items()}
                for package in sorted(packages)
            }
        return self._packages

    def looked_in(self) -> tuple[str, ...]:
        """Phrases for the places that are searched, for the message that a type was not found."""
        places = (
            *(f"the workspace {self._described(path)}" for path in self._workspace),
            *(f"{self._described(path)} from `--ros-path`" for path in self._ros_paths),
            *(f"{self._described(path)} from `AMENT_PREFIX_PATH`" for path in self._ament_prefixes),
        )
        return (*places, "the standard packages included in this tool")

    def _described(self, path: str) -> str:
        if not os.path.isdir(path):
            return f"`{path}` (the folder does not exist)"
        is_cut = any(isinstance(place, _Tree) and place.folder == path and place.is_cut for place in self._places())
        return f"`{path}` (its first {MAX_FOLDERS:,} folders)" if is_cut else f"`{path}`"

    def refresh(self) -> None:
        """Discard all listings: files or folders were created or deleted."""
        self._known_places = None
        self._packages = None

    def _places(self) -> tuple[_Place, ...]:
        if self._known_places is None:
            self._known_places = (
                *(_Tree(path) for path in self._workspace),
                *(_Share(_share(path)) if _is_ament_prefix(path) else _Tree(path) for path in self._ros_paths),
                *(_Share(_share(path)) for path in self._ament_prefixes),
                _Share(_standard()),
            )
        return self._known_places


class _Place(Protocol):
    def files(self, package: str) -> _Files:
        """The definition files of a package in this place: kind -> name -> path, with an entry for every kind."""

    def all_files(self, package: str, kind: Kind, name: str) -> tuple[str, ...]:
        """All files in this place that define a type; the first one is used."""

    def packages(self) -> Iterable[str]: ...


class _Share:
    """A folder whose subfolders are packages. The name of a subfolder is the name of the package. Only requested
    packages are listed."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._known: dict[str, _Files] = {}

    def files(self, package: str) -> _Files:
        known = self._known.get(package)
        if known is None:
            known = self._known[package] = self._list(package)
        return known

    def all_files(self, package: str, kind: Kind, name: str) -> tuple[str, ...]:
        path = self.files(package)[kind].get(name)
        return () if path is None else (path,)

    def packages(self) -> Iterable[str]:
        return [name for name in _subfolders(self._folder) if any(self.files(name).values())]

    def _list(self, package: str) -> _Files:
        if not PACKAGE_NAME.fullmatch(package):  # a name from a model must not lead to another folder
            return _NO_FILES
        folder = os.path.join(self._folder, package)
        return _definitions(folder, _subfolders(folder))


class _Tree:
    """A folder that is a package or contains packages at a depth up to `MAX_DEPTH`; all of it is listed at the first
    request."""

    def __init__(self, folder: str) -> None:
        self.folder = folder
        self._known: _Listing | None = None

    @property
    def is_cut(self) -> bool:
        """Whether some folders were not searched because there are more than `MAX_FOLDERS`."""
        return self._listed().is_cut

    def files(self, package: str) -> _Files:
        return self._listed().files.get(package, _NO_FILES)

    def all_files(self, package: str, kind: Kind, name: str) -> tuple[str, ...]:
        listed = self._listed()
        path = listed.files.get(package, _NO_FILES)[kind].get(name)
        return () if path is None else (path, *listed.hidden.get((package, kind, name), ()))

    def packages(self) -> Iterable[str]:
        return self._listed().files

    def _listed(self) -> _Listing:
        if self._known is None:
            self._known = _scan(self.folder)
        return self._known


class _Listing(Record, frozen=True):
    """The packages of a place; the files that are not used because another file of the place defines the same type; and
    whether there are more folders than were searched."""

    files: Mapping[str, _Files]
    hidden: Mapping[tuple[str, Kind, str], tuple[str, ...]]
    is_cut: bool


def _scan(root: str) -> _Listing:
    """The packages in and below `root`. Folders are read level by level, so that the definition at the smallest depth
    is used if a type is defined several times."""
    packages: dict[str, dict[Kind, dict[str, str]]] = {}
    hidden: dict[tuple[str, Kind, str], tuple[str, ...]] = {}
    entered: set[tuple[int, int]] = set()
    level = [root]
    for _ in range(MAX_DEPTH + 1):
        below: list[str] = []
        for folder in level:
            identity = _identity(folder)
            if identity is None or identity in entered or folder in SYSTEM_FOLDERS:
                continue
            if len(entered) >= MAX_FOLDERS:
                return _Listing(packages, hidden, is_cut=True)
            entered.add(identity)
            subfolders = _subfolders(folder)
            files = _definitions(folder, subfolders)
            if any(files.values()):
                package_name = _package_name(folder)
                package = packages.setdefault(package_name, {kind: {} for kind in KINDS})
                for kind in KINDS:
                    for name in files[kind].keys() & package[kind].keys():
                        key = (package_name, kind, name)
                        hidden[key] = (*hidden.get(key, ()), files[kind][name])
                    package[kind] = {**files[kind], **package[kind]}
            below += (os.path.join(folder, name) for name in subfolders if _is_entered(name))
        level = below
    return _Listing(packages, hidden, is_cut=False)


def _is_entered(folder_name: str) -> bool:
    return not folder_name.startswith(".") and folder_name not in SKIPPED_FOLDERS and folder_name not in KINDS


def _definitions(folder: str, subfolders: Iterable[str]) -> _Files:
    return {kind: _named_files(os.path.join(folder, kind), kind) if kind in subfolders else {} for kind in KINDS}


def _named_files(folder: str, kind: Kind) -> Mapping[str, str]:
    """The definition files in `folder`: type name -> path."""
    files = {}
    for file_name in _entries(folder, folders=False):
        name, dot, extension = file_name.rpartition(".")
        if dot and extension == kind and TYPE_NAME.fullmatch(name):
            files[name] = os.path.join(folder, file_name)
    return files


def _package_name(folder: str) -> str:
    """The name in the folder's `package.xml`, otherwise that of the folder."""
    content = read(os.path.join(folder, "package.xml"), head=_PACKAGE_XML_HEAD)
    head = content.decode("utf-8", "replace") if isinstance(content, bytes) else ""
    name = _XML_NAME.search(_XML_COMMENT.sub("", head))
    return name[1] if name else os.path.basename(folder)


def _subfolders(folder: str) -> list[str]:
    return _entries(folder, folders=True)


def _entries(folder: str, *, folders: bool) -> list[str]:
    """The sorted names of the subfolders or files of `folder`, through links; none if it cannot be read."""
    try:
        with os.scandir(folder) as entries:
            return sorted(e.name for e in entries if (e.is_dir() if folders else e.is_file()))
    except OSError:
        return []


def _identity(folder: str) -> tuple[int, int] | None:
    """A value that is equal for all paths to the same folder; `None` if the folder does not exist."""
    try:
        status = os.stat(folder)
    except OSError:
        return None
    return status.st_dev, status.st_ino


def _share(prefix: str) -> str:
    return os.path.join(prefix, "share")


def _is_ament_prefix(folder: str) -> bool:
    return os.path.isdir(os.path.join(folder, "share", "ament_index"))


def is_standard(path: str) -> bool:
    """Whether a file is a definition of the standard packages that are part of this tool."""
    return path.startswith(os.path.join(_standard(), ""))


@cache
def _standard() -> str:
    return path_of_resource(__package__, "standard")


def _absolute(paths: Iterable[str]) -> tuple[str, ...]:
    """Absolute paths, without empty entries (`AMENT_PREFIX_PATH` may have some) and duplicates."""
    return tuple(dict.fromkeys(os.path.abspath(path) for path in paths if path))
