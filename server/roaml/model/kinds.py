# SPDX-License-Identifier: Apache-2.0
"""Determines the kind of a file from its name and its content (docs/spec/files.md)."""

from __future__ import annotations

import enum
import re
from collections.abc import Mapping

from roaml.language import BEHAVIOR_TREE, HL_SCXML, STRUCTS, SYSTEM, XML_PROPERTIES, Grammar
from roaml.model.config_files import CONFIG_FILE, PROJECT_FILE
from roaml.regex import regex


class FileKind(enum.Enum):
    MACHINE = "state machine"
    SYSTEM = "system file"
    TREE = "behavior tree"
    STRUCTS = "struct declarations"
    JSON_STRUCTS = "struct declarations in JSON"
    PROPERTIES = "property file"
    XML_PROPERTIES = "property file in XML"
    JANI_MODEL = "JANI model"
    INTERFACE = "ROS interface definition"
    MOCKS = "mocks of a tree"
    CONFIGURATION = "configuration of as2fm"
    EXPERIMENT = "arguments of an experiment"
    SPECIFICATION = "specification of another tool"
    UNKNOWN = "file of another kind"


GRAMMARS: Mapping[FileKind, Grammar] = {
    FileKind.MACHINE: HL_SCXML,
    FileKind.SYSTEM: SYSTEM,
    FileKind.TREE: BEHAVIOR_TREE,
    FileKind.STRUCTS: STRUCTS,
    FileKind.XML_PROPERTIES: XML_PROPERTIES,
}

MACHINE_EXTENSIONS = (".ascxml", ".scxml")
INTERFACE_EXTENSIONS = (".msg", ".srv", ".action")
MOCKS_EXTENSION = ".mocks"
"""The extension of the file with the mocks of a tree."""
PROJECT_EXTENSION = ".btproj"
"""The extension of Groot2 projects, which list files of trees. A project is read if a tree in its directory is read. It
is never changed."""
EXPERIMENT_SUFFIX = ".experiment.toml"
"""The end of the name of the files with the arguments of an experiment."""
EXTENSIONS = (
    *MACHINE_EXTENSIONS,
    ".xml",
    ".jani",
    ".json",
    *INTERFACE_EXTENSIONS,
    MOCKS_EXTENSION,
    EXPERIMENT_SUFFIX,
)
"""The extensions of files that are searched for. Files with other extensions are read only if a user or a file names
them."""


_ROOTS = {
    **dict.fromkeys(HL_SCXML.roots, FileKind.MACHINE),
    **dict.fromkeys(SYSTEM.roots, FileKind.SYSTEM),
    **dict.fromkeys(STRUCTS.roots, FileKind.STRUCTS),
    **dict.fromkeys(XML_PROPERTIES.roots, FileKind.XML_PROPERTIES),
    "specification": FileKind.SPECIFICATION,
}

_FIRST_TAG = regex(r"<(?:[^\s<>!?/:\"'=]+:)?([^\s<>!?/:\"'=]+)")
_SKIPPED = regex(r"<!--.*?(?:-->|\Z)|<\?.*?(?:\?>|\Z)|<!DOCTYPE[^>\[]*(?:\[.*?\]\s*>|>|\Z)", re.DOTALL)
_TREE_MARK = regex(r"<\s*(?:BehaviorTree|TreeNodesModel)\b|BTCPP_format|main_tree_to_execute")
_JANI_MODEL = regex(r'"(?:jani-version|automata)"\s*:')
_AUTOMATA = regex(r'"automata"\s*:')
_PROPERTIES = regex(r'"properties"\s*:')
_JSON_SCHEMA = regex(r'"type"\s*:\s*"object"')
_OUR_TABLE = regex(r"^\s*\[.*\bas2fm\b|^\s*tool\b.*\bas2fm\b", re.MULTILINE)
_EXTENSION = regex(r"(?<=[^/\\])\.[^./\\]+\Z")
_HEAD = 20_000


def mocks_path(tree: str) -> str:
    """The path of the file with the mocks of a tree, which need not exist: `fetch.mocks` beside `fetch.xml`."""
    return f"{_EXTENSION.sub('', tree)}{MOCKS_EXTENSION}"


def root_name(text: str) -> str:
    """The name of the first XML element; "" if there is none among the first 20,000 characters of the text."""
    at, head = 0, text[:_HEAD]
    while (less := head.find("<", at)) >= 0:
        if skipped := _SKIPPED.match(head, less):
            at = skipped.end()
        elif tag := _FIRST_TAG.match(head, less):
            return tag[1]
        else:
            at = less + 1
    return ""


def kind_of(path: str, text: str) -> FileKind:
    """The kind of a file, from its name and its content. A system that lists the file may determine its kind more
    precisely (`roaml.project.analysis`)."""
    name = path.replace("\\", "/").rpartition("/")[2]
    if name == CONFIG_FILE or (name == PROJECT_FILE and _OUR_TABLE.search(text)):
        return FileKind.CONFIGURATION
    if name.endswith(EXPERIMENT_SUFFIX):
        return FileKind.EXPERIMENT
    extension = f".{path.rpartition('.')[2].lower()}"
    if extension in INTERFACE_EXTENSIONS:
        return FileKind.INTERFACE
    if extension == MOCKS_EXTENSION:
        return FileKind.MOCKS
    if extension in (".jani", ".json"):
        # A version of JANI is no reason to miss automata in a file with properties.
        if _JANI_MODEL.search(text[:_HEAD]) and (_AUTOMATA.search(text) or not _PROPERTIES.search(text)):
            return FileKind.JANI_MODEL
        if extension == ".jani":
            return FileKind.PROPERTIES
        return FileKind.JSON_STRUCTS if _JSON_SCHEMA.search(text[:_HEAD]) else FileKind.UNKNOWN
    root = root_name(text)
    if root in _ROOTS:
        return _ROOTS[root]
    if root in BEHAVIOR_TREE.roots and _TREE_MARK.search(text):
        return FileKind.TREE
    if extension in MACHINE_EXTENSIONS:
        return FileKind.MACHINE
    return FileKind.UNKNOWN
