# SPDX-License-Identifier: Apache-2.0
"""`as2fm/propertySentences`, the sentences and events from which a property can be built; `as2fm/newProperty`, an edit
that adds a property."""

from __future__ import annotations

from typing import Any, TypedDict

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri, string
from as2fm_lsp.handlers.workspace_edit import workspace_edit
from roaml.comparison import read_comparison
from roaml.ide.new_property import new_property, observable_events, sentences

SENTENCES = "as2fm/propertySentences"
NEW_PROPERTY = "as2fm/newProperty"


class Sentence(TypedDict):
    """A property as a sentence. `letters` are the names of its conditions in `text`. The client sends `id` back, with
    one event for each letter, in their order. `needsTime` is whether the sentence contains a duration."""

    id: str
    text: str
    letters: list[str]
    needsTime: bool


class Sentences(TypedDict):
    """`events` are the events that the system sends, in words; `hasClock` is whether properties of the system can have
    bounds on time."""

    sentences: list[Sentence]
    events: list[str]
    hasClock: bool


class NewPropertyEdit(TypedDict):
    """`uri` is the property file, `name` the name of the property."""

    edit: types.WorkspaceEdit
    uri: str
    name: str


def register(context: Context) -> None:
    session = context.session

    @context.feature(SENTENCES)
    def property_sentences(params: Any) -> Sentences:
        path = session.convert.path(document_uri(params))
        analysis = session.moment().snapshot(path).analysis
        known = [*sentences(analysis, path)]
        return {
            "sentences": [
                {
                    "id": _id(s.pattern.value, s.scope.value),
                    "text": s.text,
                    "letters": [*s.letters],
                    "needsTime": s.needs_time,
                }
                for s in known
            ],
            "events": [event.clause for event in observable_events(analysis, path)],
            "hasClock": any(sentence.needs_time for sentence in known),
        }

    @context.feature(NEW_PROPERTY)
    def create_property(params: Any) -> NewPropertyEdit:
        context.trust.require(NEW_PROPERTY)
        path, within = session.convert.path(document_uri(params)), string(params, "within")
        snapshot = session.moment().snapshot(path)
        analysis = snapshot.analysis
        by_id = {_id(s.pattern.value, s.scope.value): s for s in sentences(analysis, path)}
        sentence = by_id.get(string(params, "sentence"))
        known = {event.clause: event for event in observable_events(analysis, path)}
        clauses = getattr(params, "events", None)
        if sentence is None:
            raise JsonRpcInvalidParams(f"`sentence` must be an `id` that `{SENTENCES}` returns")
        if not isinstance(clauses, list) or len(clauses) != len(sentence.conditions) or not known.keys() >= {*clauses}:
            text = f"`events` must be {len(sentence.conditions)} of the events that `{SENTENCES}` returns"
            raise JsonRpcInvalidParams(text)
        number = read_comparison(f"<= {within}") if within else None
        if within and (number is None or number.number <= 0):
            raise JsonRpcInvalidParams("`within` must be a number of seconds greater than 0, or empty")
        events = {name: known[clause] for name, clause in zip(sentence.conditions, clauses, strict=True)}
        made = new_property(analysis, path, sentence.pattern, sentence.scope, events, within)
        edit = workspace_edit(context, snapshot, made.change)
        return {"edit": edit, "uri": session.convert.uri(made.path), "name": made.name}


def _id(pattern: str, scope: str) -> str:
    return f"{pattern} {scope}"
