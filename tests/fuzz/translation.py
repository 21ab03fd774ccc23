# SPDX-License-Identifier: Apache-2.0
"""What must hold of a system without errors: it is translated, and to a sound model."""

from __future__ import annotations

from collections.abc import Iterator

from roaml import api
from roaml.jani.reader import read_model
from roaml.jani.typecheck import check_model
from roaml.jani.writer import write as jani_text
from roaml.json import parse
from roaml.project.workspace import Snapshot
from roaml.scxml.writer import write as scxml_texts


def problems(snapshot: Snapshot, path: str) -> Iterator[str]:
    """What does not hold of the system at `path`; nothing if it has errors.

    Raises:
        Exception: whatever the translation raises.
    """
    try:
        system = api.loaded(snapshot, path)
    except (api.ModelError, api.PathError):
        return
    model = api.to_jani(system)
    for finding in check_model(model):
        yield f"unsound: {finding.message}"
    api.source_map(system, model)
    if not all(text for _, text in scxml_texts(api.to_scxml(system))):
        yield "an empty document of plain SCXML"
    text = "".join(jani_text(model))
    again, findings = read_model(parse(text)[0])
    if findings or again is None or "".join(jani_text(again)) != text:
        yield "not read back as it was written"
