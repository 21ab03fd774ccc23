# SPDX-License-Identifier: Apache-2.0
"""The use of a name, and the symbol to which it refers.

A `Symbol` identifies a definition. Its `path` determines its scope:
- a state, variable, handle, port or machine is local to its file, whichever systems list it;
- a blackboard variable and a named tree node are local to the tree (`scope`) in the file that contains them;
- events, parameters, topics, services, actions, trees, structs and members are part of a system: `path` is the system
  file, or the file that contains the name if this file is analysed alone;
- definitions of ROS or BehaviorTree.CPP belong to no file of the user: `path` is "".

The same text may refer to different symbols in different systems, and even to two symbols in one system: the key of a
property in a JSON Schema names a member and a struct. `roaml.ide.names.lookup` follows all of them to find the names
that must change together.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from typing import NamedTuple

from roaml.diagnostics import Symbol
from roaml.expr.types import Struct, Type, member_type, unwrap
from roaml.language import HL_SCXML
from roaml.model.syntax import Name
from roaml.roles import SymbolKind
from roaml.text import Span

HANDLES = frozenset(
    attribute.defines
    for name in HL_SCXML.groups["Declaration"]
    for attribute in HL_SCXML.elements[name].attributes.values()
    if attribute.defines and attribute.defines is not SymbolKind.PORT
)
"""The kinds of symbols that declarations of ROS interfaces and timers define."""

DEFINED_BY_ROS = frozenset((SymbolKind.FIELD, SymbolKind.ROS_TYPE))
"""Kinds of symbols that are defined by ROS interfaces, not by models."""


class Access(enum.Enum):
    """The kind of a use: it only names the symbol, it reads or receives it, or it writes or sends it."""

    TEXT = "names it"
    READ = "reads it"
    WRITE = "writes it"


class Form(enum.Enum):
    """The spelling of a name at a place."""

    AS_IS = "as it is"
    SANITISED = "an interface name in an event name: `/` becomes `__`"
    SAFE = "an automaton name in an event name: characters that are not allowed become `_`"
    WORD = "a subtree in a variable name: characters other than letters and digits become `_`"
    FLAT = "a parameter in a variable name: `.` becomes `__`"


class Occurrence(NamedTuple):
    """A use of a name. `span` covers exactly the name; `form` is its spelling at this place."""

    span: Span
    symbol: Symbol
    defines: bool = False
    access: Access = Access.TEXT
    form: Form = Form.AS_IS


def variable(path: str, name: str, scope: str) -> Symbol:
    return Symbol(path, SymbolKind.VARIABLE, name, scope)


def parameter(owner: str, event: str, name: str) -> Symbol:
    return Symbol(owner, SymbolKind.PARAMETER, name, event)


def tree_node(path: str, tree: str, position: int, name: str) -> Symbol:
    """The symbol of a tree node with a name. `position` is its position in the tree, as in
    `roaml.model.expand.Source`."""
    return Symbol(path, SymbolKind.TREE_NODE, name, f"{tree}:{position}")


def fields(name: Name, part: Type, access: Access) -> Iterator[Occurrence]:
    """The occurrences of the fields on a dotted path into a message or a part of an interface."""
    if len(name.value) != name.span.end - name.span.start:
        return
    start, owner = name.span.start, part
    for field in name.value.split("."):
        inner, _ = unwrap(owner)
        member = member_type(owner, field)
        if not isinstance(inner, Struct) or member is None:
            return
        span = Span(start, start + len(field))
        yield Occurrence(span, Symbol("", SymbolKind.FIELD, field, inner.name), access=access)
        start, owner = span.end + 1, member


def base_span(span: Span, base: str) -> Span:
    """The span of the name of a type without its brackets."""
    return Span(span.start, span.start + len(base))


def without_slash(name: Name) -> Span:
    """The span of the name of a topic without the slash at its beginning, which has no meaning in a model."""
    return Span(name.span.start + 1, name.span.end) if name.value.startswith("/") else name.span
