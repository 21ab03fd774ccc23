# SPDX-License-Identifier: Apache-2.0
"""Writes the elements of `schemas/behaviortree.xsd` that are nodes, from the library `roaml.libraries` has of them."""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import escape, quoteattr

from roaml.libraries import BEHAVIORTREE_CPP, Absent, Library, Node, Port, library
from roaml.record import replace
from roaml.roles import UNBOUNDED, Direction

BEGIN = "  <!-- Nodes: written by docs/build.py from server/roaml/libraries/behaviortree_cpp.xml -->\n"
END = "  <!-- End of the nodes -->\n"

_TYPES = {"int": "int32", "unsigned": "uint32", "double": "float64", "script": "string", "NodeStatus": "string"}
"""The type of a port in HL-SCXML, if it differs from the type of BehaviorTree.CPP."""

_REGISTERED_BY_PROGRAMS = ("EntryUpdatedAction",)
"""Names that a plugin of a system may have."""


def with_nodes(schema: str) -> str:
    """The text of the schema with the elements of the nodes as they are to be."""
    before, _, rest = schema.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{''.join(_elements(library(BEHAVIORTREE_CPP)))}{END}{after}"


def _elements(known: Library) -> Iterator[str]:
    for node in known.nodes.values():
        yield _element(node)
    for renamed in known.renamed.values():
        text = f"The name of `{renamed.now}` in version 3."
        yield _element(replace(known.nodes[renamed.now], name=renamed.name, text=text), use=renamed.now)
    for absent in known.absent.values():
        if absent.name not in _REGISTERED_BY_PROGRAMS:
            yield _element(_as_node(absent), is_translated=False)


def _as_node(absent: Absent) -> Node:
    text = f"{absent.reason[0].upper()}{absent.reason[1:]}."
    text += f" It cannot be translated{absent.not_translated}."
    return Node(absent.name, absent.kind, (), absent.kind.children, text)


def _element(node: Node, use: str = "", *, is_translated: bool = True) -> str:
    text = f"{node.text} {node.in_systems}".strip()
    translated = ' program-only="true"' if node.program_only else "" if is_translated else ' translated="false"'
    deprecated = f'<r:deprecated use="{use}"/>' if use else ""
    lines = [
        f'  <xs:element name="{node.name}">',
        "    <xs:annotation>",
        f"      <xs:documentation>{escape(text)}</xs:documentation>",
        f'      <xs:appinfo><r:node kind="{node.kind.value}"{translated}/>{deprecated}</xs:appinfo>',
        "    </xs:annotation>",
        "    <xs:complexType>",
        *_children(node),
        *(line for port in node.ports for line in _attribute(port)),
        '      <xs:attributeGroup ref="Node"/>',
        "    </xs:complexType>",
        "  </xs:element>",
        "",
    ]
    return "\n".join(lines) + "\n"


def _children(node: Node) -> Iterator[str]:
    least, most = node.children
    if most > 0:
        at_least = f' minOccurs="{least}"' if least != 1 else ""
        at_most = "" if most == 1 else f' maxOccurs="{"unbounded" if most >= UNBOUNDED else most}"'
        yield f'      <xs:sequence><xs:any processContents="lax"{at_least}{at_most}/></xs:sequence>'


def _attribute(port: Port) -> Iterator[str]:
    role = {
        "required": "true" if port.required else "",
        "constant": "true" if port.system_constant else "",
        "direction": str(port.system_direction or (Direction.IN if port.direction.reads else Direction.OUT)),
        "type": port.system_type or _TYPES.get(port.type, "any" if port.type.startswith("queue") else port.type),
        "default": port.default or "",
        "alias-of": port.alias_of,
    }
    attributes = " ".join(f"{name}={quoteattr(value)}" for name, value in role.items() if value)
    yield f'      <xs:attribute name="{port.name}" type="xs:string">'
    yield "        <xs:annotation>"
    yield f"          <xs:documentation>{escape(port.text)}</xs:documentation>"
    yield f"          <xs:appinfo><r:port {attributes}/></xs:appinfo>"
    yield "        </xs:annotation>"
    yield "      </xs:attribute>"
