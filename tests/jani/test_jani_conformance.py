# SPDX-License-Identifier: Apache-2.0
"""The JANI files of the conformance set."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest
from test_jani_schema import VALIDATOR, reader_complains
from test_jani_writer import read, written

import conformance
from roaml.jani.reader import read_model, read_properties
from roaml.jani.writer import write_properties
from roaml.json_syntax import parse


@pytest.mark.parametrize("path", [*conformance.REFERENCES, *conformance.WHOLE_MODELS], ids=lambda path: path.name)
def test_reference_models(path: Path) -> None:
    data = path.read_bytes()
    text = (gzip.decompress(data) if path.suffix == ".gz" else data).decode()
    value, findings = parse(text)
    assert findings == ()
    model, findings = read_model(value, str(path))
    # The one hand-written model has a guard in an assignment, where JANI knows none.
    assert [f.message for f in findings] == ["an assignment has no member `guard`"] * (path.name == "demo_manual.jani")
    assert model is not None
    ours = written(model)
    assert written(read(ours)) == ours
    expected = json.loads(text)
    result = json.loads(ours)
    assert set(result.pop("features")) - {"derived-operators"} <= set(expected.pop("features", []))
    if path in conformance.REFERENCES:
        assert list(json.loads(ours)) == list(json.loads(text))
        assert json.dumps(result) == json.dumps(expected)


@pytest.mark.parametrize("path", conformance.PROPERTY_FILES, ids=conformance.label)
def test_property_lists_are_copied(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    properties, findings = read_properties(parse(text)[0], str(path))
    assert findings == ()
    ours = json.loads(write_properties(properties))
    assert json.dumps(ours, sort_keys=True) == json.dumps(json.loads(text)["properties"], sort_keys=True)


@pytest.mark.parametrize("path", conformance.PROPERTY_FILES + conformance.WHOLE_MODELS, ids=conformance.label)
def test_property_files(path: Path) -> None:
    document = json.loads(path.read_text(encoding="utf-8"))
    assert [error.message for error in VALIDATOR.iter_errors(document)] == []
    assert not reader_complains(document)
