# SPDX-License-Identifier: Apache-2.0
"""An expanded system, and the places of names in the files of the user."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from roaml.diagnostics import Finding, Symbol
from roaml.expansion.declarations import Declared
from roaml.expansion.text import ExpandedText
from roaml.expansion.values import Scope
from roaml.record import Record, field
from roaml.text import Span

if TYPE_CHECKING:
    from roaml.expansion.draws import DrawnNumber


class NamedPlace(Record, frozen=True):
    """A place that defines or uses the name of a parameter or instance."""

    symbol: Symbol
    span: Span
    defines: bool


class SystemExpansion(Record, frozen=True, eq=False):
    """An expanded system.

    Attributes:
        texts: path -> expanded text, for each file that the expansion changes; several for a file with instances.
        variants: path of a file of the user -> the paths under which it is analysed; only for files in `texts`.
        parameters: the parameters of the system with their values.
        declared: the declarations of the parameters of the system.
        settable: the names that values can be given for: those of the parameters of the system, and
            `INSTANCE.PARAMETER` for those of instances.
        findings: path of a file of the user -> the problems of its parameters and instances.
        names: path of a file of the user -> the names of parameters and instances in it.
        renamed: path of a file of the user -> the names of interfaces and events in it, as written, that its instances
            call otherwise.
        of_instances: `INSTANCE.PARAMETER` -> the text of a value that was given from outside.
        drawn: the numbers that machines and channels draw from distributions.
        data: the paths and texts of the files with data for these; `None` for a file that cannot be read.
        channels: the paths of the texts that are machines of channels, which no file of the user contains, each with
            the name of the automaton and the place of the `<channel>` in the system file.
        delivered: the symbol of each name from which a machine receives through a channel -> the symbols of the topic
            or service and of the machine, whose names are its begin and its end.
        namespaces: path under which a machine is analysed -> its namespace, without `/` at its ends; only for those
            that are in one.
    """

    system: str
    texts: Mapping[str, ExpandedText]
    variants: Mapping[str, tuple[str, ...]]
    parameters: Scope
    declared: tuple[Declared, ...]
    settable: frozenset[str]
    findings: Mapping[str, tuple[Finding, ...]] = field(default_factory=dict)
    names: Mapping[str, tuple[NamedPlace, ...]] = field(default_factory=dict)
    renamed: Mapping[str, frozenset[str]] = field(default_factory=dict)
    of_instances: Mapping[str, str] = field(default_factory=dict)
    drawn: tuple[DrawnNumber, ...] = ()
    data: tuple[tuple[str, str | None], ...] = ()
    channels: Mapping[str, tuple[str, Span]] = field(default_factory=dict)
    delivered: Mapping[Symbol, tuple[Symbol, Symbol]] = field(default_factory=dict)
    namespaces: Mapping[str, str] = field(default_factory=dict)

    def source(self, path: str) -> str:
        """The path of the file of the user that is analysed under `path`."""
        return self.texts[path].source if path in self.texts else path

    def known_in(self, path: str) -> frozenset[str]:
        """The names of the parameters that a file can use."""
        return frozenset(self.parameters) | frozenset(
            place.symbol.name for place in self.names.get(path, ()) if place.defines and place.symbol.path == path
        )

    def paths(self, source: str) -> tuple[str, ...]:
        """The paths under which a file of the user is analysed."""
        return self.variants.get(source, (source,))
