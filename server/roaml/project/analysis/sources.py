# SPDX-License-Identifier: Apache-2.0
"""The files at one moment, and what is read from the content of one file.

The results are cached by the text of the file.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from roaml.diagnostics import Finding
from roaml.jani.properties import Property
from roaml.jani.reader import read_properties
from roaml.json_syntax import JsonValue
from roaml.json_syntax import parse as parse_json
from roaml.language import Grammar
from roaml.language.validate import Misfit, Violation, misfits, validate
from roaml.model.build_machine import build_machine
from roaml.model.json_schema import structs_in_json
from roaml.model.kinds import FileKind, kind_of
from roaml.model.machine import Machine
from roaml.model.parameters import Overrides
from roaml.model.property_file import PropertyFile, build_property_file
from roaml.model.structs import StructDeclaration, structs_in_xml
from roaml.model.system_file import SystemFile, build_system_file
from roaml.model.tree import TreeFile, build_tree_file
from roaml.project.configuration import Configuration, read_configuration
from roaml.project.files import MAX_CHARACTERS, Files
from roaml.project.memo import Memo
from roaml.text import SourceFile, Span
from roaml.xml_syntax import Document
from roaml.xml_syntax import parse as parse_xml

T = TypeVar("T")

BROKEN = ("xml-syntax", "json-syntax", "nesting-too-deep")
"""The codes of findings that mean that a parsed tree may not contain the whole text."""


class SourceFiles:
    """The files at one moment, parsed, and the models of single files.

    Args:
        files: the files at this moment.
        memo: the results of earlier analyses.
        overrides: parameters that replace those in system files.
    """

    def __init__(self, files: Files, memo: Memo, overrides: Overrides) -> None:
        self.files = files
        self.memo = memo
        self._overrides = overrides

    def source(self, path: str) -> SourceFile | None:
        return self.files.text(path)

    def kind(self, path: str) -> FileKind:
        """The kind of the file, from its name and its content."""
        source = self.source(path)
        if source is None:
            return FileKind.UNKNOWN
        return self.memo.get("kind", path, source.text, lambda: kind_of(path, source.text))

    def document(self, path: str) -> Document | None:
        return self._of("document", path, lambda source: parse_xml(source.text))

    def json(self, path: str) -> tuple[JsonValue, tuple[Finding, ...]] | None:
        return self._of("json", path, lambda source: parse_json(source.text))

    def configuration(self, path: str) -> Configuration | None:
        return self._of("configuration", path, read_configuration)

    def properties(self, path: str) -> tuple[tuple[Property, ...], tuple[Finding, ...]]:
        """The properties in a JANI property file, and their syntax errors."""
        value = self.json(path)
        if value is None:
            return (), ()
        return self._of("properties", path, lambda _: read_properties(value[0], path)) or ((), ())

    def violations(self, path: str, grammar: Grammar) -> tuple[Violation, ...]:
        """The places where a file violates a grammar."""
        violations = self._of_document(
            f"violations {grammar.schema}", path, lambda document: validate(document, grammar)
        )
        return violations or ()

    def misfits(self, path: str, grammar: Grammar) -> tuple[Misfit, ...]:
        """The elements of a file that the grammar does not define, or does not allow in their place."""

        def find(document: Document) -> tuple[Misfit, ...]:
            return tuple(misfits(document.root, grammar))

        return self._of_document(f"misfits {grammar.schema}", path, find) or ()

    def machine(self, path: str) -> Machine | None:
        return self._of_document("machine", path, build_machine)

    def tree(self, path: str) -> TreeFile | None:
        return self._of_document("tree", path, build_tree_file)

    def property_file(self, path: str) -> PropertyFile | None:
        return self._of_document("property file", path, build_property_file)

    def system_file(self, path: str) -> SystemFile | None:
        return self._of_document("system file", path, lambda document: build_system_file(document, self._overrides))

    def struct_declarations(self, path: str) -> tuple[StructDeclaration, ...]:
        """The structs that a file declares, in XML or in JSON."""
        if self.kind(path) is FileKind.STRUCTS:
            return self._of_document("structs", path, structs_in_xml) or ()
        value = self.json(path)
        if value is None:
            return ()
        return self._of("structs", path, lambda _: structs_in_json(value[0])[0]) or ()

    def broken_at(self, path: str) -> Span | None:
        """The position of the first error because of which a file is not well-formed; `None` if there is none."""
        document = self.document(path)
        findings = document.findings if document else ()
        return next((finding.span for finding in findings if finding.code in BROKEN), None)

    def is_well_formed(self, path: str) -> bool:
        """Whether a file can be parsed completely."""
        if self.kind(path) is FileKind.JSON_STRUCTS:
            _, findings = self.json(path) or (None, None)
        else:
            document = self.document(path)
            findings = document.findings if document else None
        return findings is not None and not any(f.code in BROKEN for f in findings)

    def _of(self, computation: str, path: str, compute: Callable[[SourceFile], T]) -> T | None:
        """The cached result of `compute` for a file; `None` if the file cannot be read or is too large."""
        source = self.source(path)
        if source is None or len(source.text) > MAX_CHARACTERS:
            return None
        return self.memo.get(computation, path, source.text, lambda: compute(source))

    def _of_document(self, computation: str, path: str, compute: Callable[[Document], T]) -> T | None:
        document = self.document(path)
        if document is None:
            return None
        return self._of(computation, path, lambda _: compute(document))
