# SPDX-License-Identifier: Apache-2.0
"""The enumerations of `roaml.roles` are those of the schemas."""

from __future__ import annotations

from lxml import etree

from roaml.language import SYSTEM
from roaml.language.resources import schema_path
from roaml.model.system_file import SystemSection
from roaml.roles import ELSEWHERE, Direction, NodeKind, ProtocolPart, RoleValue, SymbolKind, ValuePart, ValueRole

SCHEMAS = ("ascxml.xsd", "scxml.xsd", "roaml.xsd", "structs.xsd", "behaviortree.xsd", "properties.xsd")
ROLES = "{urn:roaml:roles}"


def written(*places: str) -> set[str]:
    """The words in `ROLE@ATTRIBUTE` of all schemas."""
    words: set[str] = set()
    for schema in SCHEMAS:
        root = etree.parse(str(schema_path(schema))).getroot()
        for place in places:
            role, attribute = place.split("@")
            for node in root.iter(f"{ROLES}{role}"):
                words.update(node.get(attribute, "").split())
    return words


def values(*kinds: RoleValue) -> set[str]:
    return {kind.value for kind in kinds}


def test_parts() -> None:
    assert written("sends@part", "receives@part") == values(*ProtocolPart) - values(ProtocolPart.START)


def test_symbols() -> None:
    assert written("defines@symbol", "refers@symbol") == values(*SymbolKind) - values(*ELSEWHERE)


def test_ports_nodes_and_values() -> None:
    assert written("port@direction") == values(*Direction) - values(Direction.INOUT)
    assert written("node@kind") == values(*NodeKind)
    assert written("value@is") == values(*ValueRole)
    assert written("binds@only") == values(ValuePart.COND, ValuePart.BODY)


def test_sections_of_system_files() -> None:
    sections = {element.name for element in SYSTEM.elements.values() if "input" in element.children}
    assert sections == {section.value for section in SystemSection}
