# SPDX-License-Identifier: Apache-2.0
"""The models and systems in the user's files at one moment.

- An `Analysis` never changes: all its results are functions of the content of the files at one moment.
- Results are cached by content (`Memo`), so a later analysis recomputes only what differs. Parsed files and models are
  cached by the text of the file, types and outlines by the text and the declarations, a system by the outlines of
  its files.
- An analysis knows no rules: `roaml.project.checking` passes them to it, and it keeps what they find.
- The work is divided by subject. A module uses only those before it: `sources`, `tree_files`, `systems`,
  `families`, `expanding`, `machines`, `gaps`, `linking`, `values`, `symbols`, `subjects`. Other packages use only
  `Analysis`.
- A system with parameters or instances is expanded to other texts, which have an analysis of their own (`expanded`).
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

from roaml.expansion.declarations import bounds_of
from roaml.forest.settings import NEWEST, TreeSettings
from roaml.interfaces.registry import Registry
from roaml.model.parameters import NO_OVERRIDES, Overrides
from roaml.project.analysis.expanding import ExpandedFiles, Expanding, Expansions
from roaml.project.analysis.families import Families
from roaml.project.analysis.gaps import Gaps
from roaml.project.analysis.linking import Linking
from roaml.project.analysis.machines import NO_STRUCTS, Machines, Structs
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.subjects import Rooms, Subjects
from roaml.project.analysis.systems import Systems
from roaml.project.analysis.tree_files import TreeFiles
from roaml.project.analysis.values import ReachedValues
from roaml.project.expanded import Expanded
from roaml.project.files import Files
from roaml.project.memo import Memo
from roaml.project.ros_types import Interfaces

__all__ = ["NO_STRUCTS", "Analysis", "Expanded", "Structs"]

if TYPE_CHECKING:
    from roaml.project.experiment_file import AskedModel


class Analysis:
    """The models and systems in the files of one moment.

    Args:
        files: the files at this moment.
        registry: resolves ROS types.
        memo: the results of earlier analyses.
        systems: the paths of the system files that are analysed.
        overrides: parameters that replace those in system files.
        trees: the settings for trees that are not in a system.
        listed: the paths of the files in the workspace.
        expands: whether parameters and instances are expanded; false for files that are expanded already.
    """

    def __init__(
        self,
        files: Files,
        registry: Registry,
        memo: Memo,
        systems: Iterable[str],
        overrides: Overrides = NO_OVERRIDES,
        trees: TreeSettings = NEWEST,
        listed: Iterable[str] = (),
        *,
        expands: bool = True,
    ) -> None:
        self.files = files
        self.registry = registry
        self.memo = memo
        self.overrides = overrides
        self.tree_settings = trees

        sources = SourceFiles(files, memo, overrides)
        interfaces = Interfaces(registry, memo)
        tree_files = TreeFiles(sources)
        self._systems = Systems(sources, tree_files, systems)
        families = Families(sources, tree_files, self._systems, trees, listed)
        expanding = Expanding(sources, interfaces, self._systems, overrides.values) if expands else None
        expansions = Expansions(expanding, functools.partial(_analysed, registry, overrides, trees))
        self.expanded = expansions.system
        self.expanded_file = expansions.file
        machines = Machines(sources, interfaces, self._systems)
        gaps = Gaps(sources, tree_files, self._systems, machines)
        linking = Linking(sources, interfaces, self._systems, expansions.system, machines, gaps, families)
        self._open_files(sources, interfaces)
        self._open_trees(tree_files, families)
        self._open_systems(self._systems, machines, gaps, linking)
        values = ReachedValues(sources, interfaces, self._systems, linking)
        self.arriving_at = values.arriving_at
        self.values_in = values.values_in
        self.asked = functools.partial(_asked, self._systems, expansions.system)
        rooms = Rooms(
            sources, interfaces, tree_files, self._systems, families, machines, gaps, linking, values, self.asked
        )
        subjects = Subjects(rooms, expansions.system, expansions.file)
        self.present = subjects.present
        self.checked_file = subjects.checked_file
        self.subject = subjects.subject
        self.contexts = subjects.contexts
        self.file_context = subjects.file_context
        self.places = subjects.places

    def _open_files(self, sources: SourceFiles, interfaces: Interfaces) -> None:
        self.source = sources.source
        self.kind = sources.kind
        self.document = sources.document
        self.json = sources.json
        self.configuration = sources.configuration
        self.properties = sources.properties
        self.machine = sources.machine
        self.tree = sources.tree
        self.property_file = sources.property_file
        self.system_file = sources.system_file
        self.struct_declarations = sources.struct_declarations
        self.interface = interfaces.interface

    def _open_trees(self, tree_files: TreeFiles, families: Families) -> None:
        self.trees_from = tree_files.trees_from
        self.outlines_from = tree_files.outlines_from
        self.includes = tree_files.includes
        self.include_path = tree_files.include_path
        self.family = families.family
        self.family_outlines = families.family_outlines

    def _open_systems(self, systems: Systems, machines: Machines, gaps: Gaps, linking: Linking) -> None:
        self.system_paths = systems.paths
        self.property_names = systems.property_names
        self.probabilities = systems.probabilities
        self.listed = systems.listed
        self.kind_in = systems.kind_in
        self.tree_paths = systems.tree_paths
        self.tree_outlines = systems.tree_outlines
        self.executed_trees = systems.executed_trees
        self.files_of = systems.files_of
        self.systems_of = systems.systems_of
        self.property_names_below = systems.property_names_below
        self.structs = machines.structs
        self.interface_files_of = machines.interface_files_of
        self.gaps = gaps.gaps
        self.system = linking.system
        self.forest = linking.forest
        self.library_tree = linking.library_tree
        self.machines_in = linking.machines_in
        self.size_of_translation = linking.size_of_translation
        self.linked_properties = linking.linked_properties
        self.typed_in = linking.typed_in
        self.environment = linking.environment
        self.globals = linking.globals
        self.event_parameters = linking.event_parameters

    @property
    def memberships(self) -> Mapping[str, tuple[str, ...]]:
        """File -> its systems."""
        return self._systems.memberships


def _asked(systems: Systems, expanded: Callable[[str], Expanded[Analysis] | None], model: str) -> AskedModel | None:
    """The names that an experiment with a system can use; `None` if the file is not a known system."""
    from roaml.project.experiment_file import AskedModel  # noqa: PLC0415 - few projects have experiments

    if model not in systems.paths:
        return None
    made = expanded(model)
    if made is None:
        return AskedModel((), systems.property_names(model), {}, systems.probabilities(model))
    bounds = {parameter.name.value: bounds_of(parameter) for parameter in made.expansion.declared}
    parameters, analysis = tuple(sorted(made.expansion.settable)), made.analysis
    return AskedModel(parameters, analysis.property_names(model), bounds, analysis.probabilities(model))


def _analysed(registry: Registry, overrides: Overrides, trees: TreeSettings, made: ExpandedFiles) -> Expanded[Analysis]:
    reading = registry.reading(made.files.text)
    inner = Analysis(made.files, reading, made.memo, made.systems, overrides, trees, expands=False)
    return Expanded(inner, made.expansion)
