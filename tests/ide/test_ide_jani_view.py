# SPDX-License-Identifier: Apache-2.0
"""The readable form of JANI models, and their outline."""

from __future__ import annotations

import json

import pytest
from ide_case import analysis_of, path_of

from fuzz.corpus import ROOT
from roaml import api
from roaml.ide.jani_view import jani_view
from roaml.ide.navigation.document_symbol import DocumentSymbol
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.jani.writer import write

RANGE = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 9}
REACHED = {"op": "F", "exp": {"op": "=", "left": "a", "right": 1}}
GUARD = {"op": "∧", "left": {"op": "≤", "left": "a", "right": 3}, "right": True}
MODEL = {
    "jani-version": 1,
    "name": "m",
    "actions": [{"name": "go"}],
    "variables": [
        {
            "name": "a",
            "type": {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 9},
            "initial-value": 0,
        },
        {"name": "b", "type": {"kind": "array", "base": "bool"}},
    ],
    "automata": [
        {
            "name": "A",
            "locations": [{"name": "l"}, {"name": "k"}],
            "initial-locations": ["l"],
            "edges": [
                {"location": "l", "action": "go", "guard": {"exp": GUARD}, "destinations": [{"location": "k"}]},
                {"location": "k", "destinations": [{"location": "l"}, {"location": "k"}]},
            ],
        }
    ],
    "properties": [{"name": "p", "expression": {"op": "Pmax", "exp": REACHED}}],
    "system": {"elements": [{"automaton": "A"}]},
}
OUTLINE = """
actions 1
  go
variables 2
  a int[0..9]
  b bool[]
automata 1
  A
    l
    k
    go l → k [(a ≤ 3) ∧ true]
    τ k → l, k
properties 1
  p Pmax(F (a = 1))
""".strip()


def outline(symbols: tuple[DocumentSymbol, ...], depth: int = 0) -> list[str]:
    texts = []
    for symbol in symbols:
        texts += [f"{'  ' * depth}{symbol.name} {symbol.detail}".rstrip(), *outline(symbol.children, depth + 1)]
    return texts


def test_laid_out_with_an_outline() -> None:
    compact = json.dumps(MODEL, separators=(",", ":"), ensure_ascii=False)
    view = jani_view(compact)
    assert json.loads(view.text) == MODEL
    assert max(map(len, view.text.splitlines())) <= 100
    assert '      "initial-locations": ["l"],\n' in view.text
    assert '    { "name": "b", "type": { "kind": "array", "base": "bool" } }\n' in view.text
    assert outline(view.symbols) == OUTLINE.splitlines()
    for symbol in everything(view.symbols):
        assert symbol.span.start <= symbol.name_span.start < symbol.name_span.end <= symbol.span.end
    edge = next(
        document_symbol
        for document_symbol in everything(view.symbols)
        if document_symbol.name == "go" and document_symbol.children == () and document_symbol.detail
    )
    assert view.text[edge.name_span.start : edge.name_span.end] == "go"
    assert view.text[edge.span.start : edge.span.end].startswith('{\n          "location": "l"')


def test_the_file_itself_has_the_outline() -> None:
    compact = json.dumps(MODEL, ensure_ascii=False)
    analysis = analysis_of({"m.jani": compact})
    assert outline(document_symbols(analysis, path_of("m.jani"))) == OUTLINE.splitlines()


@pytest.mark.parametrize(
    "text", ["", "{", "[]", '{"automata": [{"edges": [{}, 1]}, 2], "variables": {}}', '{"automata": [']
)
def test_files_that_are_not_models(text: str) -> None:
    assert "".join(jani_view(text).text.split()) == "".join(text.split())


def test_translations() -> None:
    system = api.load(str(min((ROOT / "examples").glob("*/main.xml"))))
    compact = "".join(write(api.to_jani(system)))
    view = jani_view(compact)
    assert json.loads(view.text) == json.loads(compact)
    assert len(view.text.splitlines()) > 50
    assert {symbol.name for symbol in view.symbols} >= {"variables", "automata", "properties"}


def everything(symbols: tuple[DocumentSymbol, ...]) -> list[DocumentSymbol]:
    return [document_symbol for symbol in symbols for document_symbol in (symbol, *everything(symbol.children))]
