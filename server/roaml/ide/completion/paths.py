# SPDX-License-Identifier: Apache-2.0
"""Completion of paths: files in the workspace, relative to the folder of a file."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.completion.item import CompletionItem, ItemKind, Rank
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.model.kinds import MACHINE_EXTENSIONS, FileKind
from roaml.model.machine import Machine
from roaml.model.system_file import NODE_TYPES, PLUGIN_TYPES, TREE_TYPES, SystemSection, section_named
from roaml.project.paths import seen_from
from roaml.roles import ProtocolPart

_BY_SECTION = {
    SystemSection.DATA_DECLARATIONS: (FileKind.STRUCTS, FileKind.JSON_STRUCTS),
    SystemSection.BEHAVIOR_TREE: (FileKind.TREE, FileKind.MACHINE),
    SystemSection.NODE_MODELS: (FileKind.MACHINE,),
    SystemSection.PROPERTIES: (FileKind.PROPERTIES, FileKind.XML_PROPERTIES),
}

_BY_TYPE = {
    **dict.fromkeys(TREE_TYPES, (FileKind.TREE,)),
    **dict.fromkeys((*PLUGIN_TYPES, *NODE_TYPES), (FileKind.MACHINE,)),
    "xml": (FileKind.STRUCTS, FileKind.XML_PROPERTIES),
    "json": (FileKind.JSON_STRUCTS,),
    "jani": (FileKind.PROPERTIES,),
}


def paths(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The files that the attribute may name. Files to which the file of the attribute does not refer yet come first;
    machines of the wrong kind, node or plugin, come last."""
    analysis = request.analysis
    kinds, plugin = _expected_kinds(subject)
    named = set(analysis.includes(request.path)) | {listed.path for listed in analysis.listed(request.path)}
    for path in request.snapshot.candidates():
        if path == request.path or analysis.kind(path) not in kinds:
            continue
        rank = Rank.LATE if path in named else Rank.USUAL
        if FileKind.MACHINE in kinds and path.endswith(MACHINE_EXTENSIONS):
            machine = analysis.machine(path)
            fitting = plugin is None or machine is None or _is_plugin(machine) == plugin
            rank = Rank.LAST if not fitting else Rank.LIKELY if rank is Rank.USUAL else rank
        yield CompletionItem(seen_from(path, request.path), ItemKind.FILE, detail=analysis.kind(path).value, rank=rank)


_MUST_BE_PLUGIN = {SystemSection.BEHAVIOR_TREE: True, SystemSection.NODE_MODELS: False}
"""Section of a system file -> whether the machines that it lists are plugins."""


def _expected_kinds(subject: CompletionSubject) -> tuple[tuple[FileKind, ...], bool | None]:
    """The expected kinds of the file, and whether a machine must be a plugin (true), must not be one (false), or may be
    one (`None`)."""
    if subject.type.name == "include":
        return (FileKind.TREE,), None
    section = section_named(subject.parents[-1].element.name) if subject.parents else None
    written = subject.element.get("type") if subject.element else None
    type_ = written.value if written else ""
    kinds = _BY_TYPE.get(type_) or (_BY_SECTION[section] if section else ())
    return kinds, _MUST_BE_PLUGIN.get(section) if section else None


def _is_plugin(machine: Machine) -> bool:
    handlers = (handler for chart in machine.charts for state in chart.states for handler in state.handlers)
    return bool(machine.ports) or any(handler.trigger is ProtocolPart.BT_TICK for handler in handlers)
