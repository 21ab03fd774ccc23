# SPDX-License-Identifier: Apache-2.0
"""The invariant of systems without errors: they are translated to valid models."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator

from fuzz.limits import restart
from roaml import api
from roaml.jani.model import Model
from roaml.jani.reader import read_model
from roaml.jani.typecheck import check_model
from roaml.jani.writer import write as jani_text
from roaml.json_syntax import parse
from roaml.project.workspace import Snapshot
from roaml.scxml.writer import write as scxml_texts
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker


def problems(snapshot: Snapshot, path: str) -> Iterator[str]:
    """The invariants that do not hold for the system at `path`; empty if it has errors.

    Each step corresponds to a command, and may take the whole time of a case.

    Raises:
        Exception: any exception that the translation raises.
    """
    try:
        system = api.loaded(snapshot, path)
    except (api.ModelError, api.PathError):
        return
    for file, placed in system.analysis.gaps(path):
        yield f"a part of the system is unknown, but there is no error: {placed.gap} in {file}"
    restart()
    model = api.to_jani(system)
    restart()
    for finding in check_model(model):
        yield f"unsound: {finding.message}"
    # The variables of an observer begin with the name of its property, in characters that names of variables may have.
    observers = tuple(re.sub(r"[^A-Za-z0-9_.-]", "_", property_.name) for property_ in model.properties)
    translated, known = {variable.name for variable in model.variables}, set(system.analysis.globals(path))
    # The translation names the events between a plugin and the automaton of its conditions `bt_1003_inner_response`.
    internal = re.compile(r"bt_\d+_inner")
    table = (known - translated) | {
        name for name in translated - known if not name.startswith(observers) and not internal.match(name)
    }
    if table:
        yield f"the checker's table of global variables differs in {sorted(table)}"
    api.source_map(system, model)
    if not all(text for _, text in scxml_texts(api.to_scxml(system))):
        yield "an empty document of plain SCXML"
    restart()
    text = "".join(jani_text(model))
    restart()
    again, findings = read_model(parse(text)[0])
    if findings or again is None or "".join(jani_text(again)) != text:
        yield f"not read back as it was written: {findings[0].message if findings else 'another text'}"
        return
    yield from names_of(again)
    restart()
    try:
        ModelChecker(again, ())
    except FaultError as error:
        yield f"verify cannot run it: {error.message}"
        return
    for property_ in again.properties:
        with contextlib.suppress(FaultError):  # the form of a property may be one that is not answered
            ModelChecker(again, (property_,))


def names_of(model: Model) -> Iterator[str]:
    """Names that are not unique in a model."""
    groups = {"automata": [a.name for a in model.automata], "variables": [v.name for v in model.variables]}
    groups |= {f"locations of {a.name}": [location.name for location in a.locations] for a in model.automata}
    groups |= {f"variables of {a.name}": [variable.name for variable in a.variables] for a in model.automata}
    groups["actions"] = [action.name for action in model.actions]
    groups["properties"] = [property_.name for property_ in model.properties]
    for what, names in groups.items():
        if len(names) != len(set(names)):
            yield f"{what.partition(' of ')[0]} of the same name"
