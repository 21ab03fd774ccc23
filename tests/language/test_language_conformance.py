# SPDX-License-Identifier: Apache-2.0
"""The schemas alone, in plain lxml, accept every document of the conformance models."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from lxml import etree

import conformance
from roaml.language import BEHAVIOR_TREE, HL_SCXML, STRUCTS, SYSTEM, XML_PROPERTIES
from roaml.language.resources import schema_path
from roaml.language.validate import validate
from roaml.text import decode
from roaml.xml_syntax import parse

SCXML = "http://www.w3.org/2005/07/scxml"
GRAMMARS = {
    root: grammar for grammar in (HL_SCXML, SYSTEM, BEHAVIOR_TREE, STRUCTS, XML_PROPERTIES) for root in grammar.roots
}


def reached(mains: tuple[Path, ...]) -> list[Path]:
    """The system files and all documents that they name, directly or not."""
    paths = list(dict.fromkeys(mains))
    for path in paths:
        for element in etree.parse(str(path)).iter(etree.Element):
            named = [path.parent / str(element.attrib[name]) for name in ("src", "path") if name in element.attrib]
            paths += [file for file in named if file.suffix in (".xml", ".ascxml", ".scxml") and file not in paths]
    return sorted(paths)


DOCUMENTS = reached(conformance.systems())
each_document = pytest.mark.parametrize("path", DOCUMENTS, ids=conformance.label)


@cache
def schema(name: str) -> etree.XMLSchema:
    return etree.XMLSchema(etree.parse(str(schema_path(name))))


@each_document
def test_valid_in_plain_lxml(path: Path) -> None:
    root = etree.parse(str(path)).getroot()
    name = etree.QName(root)
    used = schema(GRAMMARS[name.localname].schema)
    if name.namespace == SCXML:
        used = schema("ascxml-namespace.xsd")
    elif name.namespace:
        for element in root.iter(etree.Element):
            element.tag = etree.QName(element).localname
    assert used.validate(root), used.error_log


@each_document
def test_nothing_found_in_the_bottom_layers(path: Path) -> None:
    source = decode(str(path), path.read_bytes())
    assert source.undecodable is None
    document = parse(source.text)
    assert document.findings == ()
    assert document.root is not None
    assert validate(document, GRAMMARS[document.root.name]) == ()
