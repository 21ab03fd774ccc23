# SPDX-License-Identifier: Apache-2.0
"""The context of a completion: a caret in an XML file, and the systems of the file."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

from roaml.forest.forest import Forest
from roaml.ide.names.frames import Trees
from roaml.ide.names.occurrences import trees_of
from roaml.ide.syntax import Typed, XmlFile
from roaml.language import ElementType
from roaml.model.machine import Chart, Handler, Machine, RosSend
from roaml.model.property_file import PropertyFile
from roaml.model.system import System
from roaml.model.system_file import SystemSection
from roaml.model.value_types import Environment
from roaml.project.analysis import Analysis
from roaml.project.workspace import Snapshot
from roaml.record import Record
from roaml.xml_syntax import Element


class CompletionSubject(NamedTuple):
    """The element whose attribute or content is completed. `element` is `None` if it does not exist yet, because the
    completion inserts it."""

    element: Element | None
    type: ElementType
    parents: tuple[Typed, ...]

    @property
    def key(self) -> str:
        """The name of the parent, `/`, and the name of the element: the `path` of symbols of attributes, which
        `roaml.ide.completion.document` reads."""
        return f"{self.parents[-1].element.name if self.parents else ''}/{self.type.name}"


class Request(Record, frozen=True, eq=False, dict=True):
    snapshot: Snapshot
    path: str
    offset: int
    file: XmlFile

    @property
    def analysis(self) -> Analysis:
        return self.snapshot.analysis

    @cached_property
    def system_path(self) -> str | None:
        """The path of the system in which types are resolved: the first of the systems of the file; `None` if the file
        belongs to no system."""
        return self.analysis.systems_of(self.path)[0]

    @cached_property
    def systems(self) -> tuple[System, ...]:
        """The systems to which the file belongs; for a system file, its own system."""
        paths = (self.path, *self.analysis.systems_of(self.path))
        owners = (self.analysis.system(path) for path in dict.fromkeys(paths) if path in self.analysis.system_paths)
        return tuple(system for system in owners if system is not None)

    @cached_property
    def sections(self) -> frozenset[SystemSection]:
        """The sections of system files that list the file."""
        listed = (listed_file for system in self.systems for listed_file in self.analysis.listed(system.path))
        return frozenset(listed_file.input.section for listed_file in listed if listed_file.path == self.path)

    @cached_property
    def all_systems(self) -> tuple[System, ...]:
        """All systems of the workspace, the file's own first."""
        others = (self.analysis.system(path) for path in self.analysis.system_paths)
        return tuple(dict.fromkeys((*self.systems, *(system for system in others if system is not None))))

    @cached_property
    def machine(self) -> Machine | None:
        return self.analysis.machine(self.path)

    @cached_property
    def property_file(self) -> PropertyFile | None:
        return self.analysis.property_file(self.path)

    @cached_property
    def environment(self) -> Environment:
        return self.analysis.environment(self.system_path)

    @cached_property
    def trees(self) -> Trees:
        return trees_of(self.analysis, self.path, self.system_path)

    @cached_property
    def forest(self) -> Forest | None:
        """The trees and the definitions of their nodes; `None` if the file is not one of trees. A system that does not
        execute the file defines no nodes of it."""
        return self.analysis.forest(self.path, self.system_path) or self.analysis.forest(self.path)

    @cached_property
    def chart(self) -> Chart | None:
        """The innermost chart around the caret: that of a thread, or that of the machine; `None` outside of
        machines."""
        charts = self.machine.charts if self.machine else ()
        around = [chart for chart in charts if chart.element.span.start <= self.offset <= chart.element.span.end]
        return around[-1] if around else None

    @cached_property
    def handler(self) -> Handler | None:
        """The handler around the caret; `None` if there is none."""
        states = self.chart.states if self.chart else ()
        handlers = (handler for state in states for handler in state.handlers)
        return next((handler for handler in handlers if _is_around(handler.element, self.offset)), None)

    def ros_send_of(self, element: Element) -> RosSend | None:
        """The sending statement of an element; `None` if the element does not send."""
        statements = self.chart.statements if self.chart else ()
        return next(
            (statement for statement in statements if isinstance(statement, RosSend) and statement.element is element),
            None,
        )


def _is_around(element: Element, offset: int) -> bool:
    return element.span.start < offset < element.span.end or (offset == element.span.end and not element.complete)
