# SPDX-License-Identifier: Apache-2.0
"""The ROS types that files use, with HL-SCXML types."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.interfaces.registry import NotFound, Reason, Registry
from roaml.interfaces.types import Definition, Kind
from roaml.model.machine import Machine
from roaml.model.nesting import MAX_DEPTH, MAX_FIELDS
from roaml.model.ros import InterfaceType, RepeatedType, extent_of, interface_type
from roaml.model.value_types import INTERFACE_KINDS
from roaml.project.memo import Memo


class Interfaces:
    """Resolves ROS types. The results are cached by the definitions.

    Args:
        registry: finds the definitions.
        memo: the results of earlier analyses.
    """

    def __init__(self, registry: Registry, memo: Memo) -> None:
        self.registry = registry
        self._memo = memo
        self._interfaces: dict[tuple[str, str], InterfaceType | NotFound] = {}

    def interface(self, kind: str, name: str) -> InterfaceType | NotFound:
        """The ROS type `name`, as written, of the kind msg, srv or action, with HL-SCXML types; `NotFound` with the
        reason if it cannot be used."""
        key = (kind, name)
        if key not in self._interfaces:
            self._interfaces[key] = self._find_interface(kind, name)
        return self._interfaces[key]

    def _find_interface(self, kind: str, name: str) -> InterfaceType | NotFound:
        assert kind in ("msg", "srv", "action")
        key: tuple[Kind, str] = (kind, name)  # type: ignore[assignment]
        definition = self.registry.resolve(*key)
        if isinstance(definition, NotFound):
            return definition
        if not definition.is_complete:
            return NotFound(Reason.SECTIONS, key[0], name, path=definition.path)
        parts = tuple(self.closure(definition))
        extent = self._memo.get("interface extent", key, parts, lambda: extent_of(parts))
        if extent.is_too_large:
            fields = f"{extent.fields:,} fields (at most {MAX_FIELDS:,} are read)"
            deep = f"{extent.depth} levels of nested messages (at most {MAX_DEPTH} are read)"
            size = fields if extent.fields > MAX_FIELDS else deep
            return NotFound(Reason.TOO_LARGE, key[0], name, size=size)
        return self._memo.get(
            "interface",
            key,
            parts,
            lambda: interface_type(definition, lambda n: self.registry.resolve("msg", n)),
        )

    def repeated_types(self, machine: Machine) -> tuple[RepeatedType, ...]:
        """The ROS types that a machine uses, directly or in fields, and that another file defines differently."""
        repeated_types: dict[tuple[str, str], RepeatedType] = {}
        for declaration in machine.declarations:
            if declaration.type is None or declaration.kind not in INTERFACE_KINDS:
                continue
            written = declaration.type.value
            definition = self.registry.resolve(INTERFACE_KINDS[declaration.kind], written)
            for part in () if isinstance(definition, NotFound) else self.closure(definition):
                other = self.registry.other_definition(part.kind, part.package, part.name)
                if other is not None:
                    repeated = RepeatedType(written, part.package, part.name, part.path, other.path)
                    repeated_types.setdefault((written, part.full_name), repeated)
        return tuple(repeated_types.values())

    def interfaces_of(self, machine: Machine) -> tuple[InterfaceType | NotFound, ...]:
        """The ROS types in the declarations of a machine, in order."""
        return tuple(
            self.interface(INTERFACE_KINDS[d.kind], d.type.value)
            for d in machine.declarations
            if d.type and d.kind in INTERFACE_KINDS
        )

    def messages(self, names: Iterable[str]) -> tuple[InterfaceType, ...]:
        """The message types with these names, without those that are not found."""
        definitions = (self.interface("msg", name) for name in names)
        return tuple(type_ for type_ in definitions if isinstance(type_, InterfaceType))

    def has_type(self, kind: str, name: str) -> bool:
        return isinstance(self.interface(kind, name), InterfaceType)

    def closure(self, definition: Definition) -> list[Definition]:
        """A definition and the definitions of all messages nested in it."""
        definitions = [definition]
        names = {definition.full_name}
        for outer in definitions:
            for section in outer.sections:
                for field in section.fields:
                    if not field.type.is_primitive and field.type.name not in names:
                        names.add(field.type.name)
                        nested = self.registry.resolve("msg", field.type.name)
                        if not isinstance(nested, NotFound):
                            definitions.append(nested)
        return definitions
