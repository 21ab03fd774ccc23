# SPDX-License-Identifier: Apache-2.0
"""ROS 2 interface definitions, `.msg`, `.srv` and `.action`, read from their files without any ROS installation.

Nothing in a workspace is imported or executed. `standard/` contains definition files of the standard packages of ROS 2:
the types of Jazzy. Their comments are written for this project; they say what Humble lacks and what later distributions
changed.
"""

from roaml.interfaces.names import CONSTANT_NAME, FIELD_NAME, PACKAGE_NAME, TYPE_NAME
from roaml.interfaces.parse import parse
from roaml.interfaces.registry import NotFound, Parsed, Reason, Registry, split_type_name
from roaml.interfaces.search import SearchPath
from roaml.interfaces.types import (
    KIND_NAMES,
    KINDS,
    PRIMITIVES,
    SECTION_NAMES,
    ArrayKind,
    Constant,
    Definition,
    Field,
    FieldType,
    Kind,
    Scalar,
    Section,
    Value,
)

__all__ = [
    "CONSTANT_NAME",
    "FIELD_NAME",
    "KINDS",
    "KIND_NAMES",
    "PACKAGE_NAME",
    "PRIMITIVES",
    "SECTION_NAMES",
    "TYPE_NAME",
    "ArrayKind",
    "Constant",
    "Definition",
    "Field",
    "FieldType",
    "Kind",
    "NotFound",
    "Parsed",
    "Reason",
    "Registry",
    "Scalar",
    "SearchPath",
    "Section",
    "Value",
    "parse",
    "split_type_name",
]
