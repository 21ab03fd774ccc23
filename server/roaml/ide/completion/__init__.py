# SPDX-License-Identifier: Apache-2.0
"""Completion at a caret.

- Works on incomplete files: the place of the caret is determined from the tree, or from the text if the tree does not
  contain it.
- The schemas are the source of elements, attributes and values, so a new element needs no change here.
- Documentation is created only when an item is selected (`roaml.ide.completion.document`).
"""

from __future__ import annotations

from collections.abc import Iterable

from roaml.ide.completion.attributes import attributes
from roaml.ide.completion.document import document
from roaml.ide.completion.documents import documents
from roaml.ide.completion.elements import elements
from roaml.ide.completion.item import CompletionItem, Completions, ItemKind, Rank, escaped, plain
from roaml.ide.completion.json_documents import in_json
from roaml.ide.completion.line_documents import in_lines
from roaml.ide.completion.place import AttributeName, AttributeValue, Content, EndTag, Place, StartTag, place_at
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.completion.values import in_attribute, in_text
from roaml.ide.syntax import Typed, xml_file
from roaml.project.workspace import Snapshot
from roaml.text import Span

__all__ = ["CompletionItem", "Completions", "ItemKind", "Rank", "complete", "document", "plain"]

TRIGGERS = ("<", " ", '"', "'", "/", "=", ".", "{", "@", "_")
"""Characters after which an editor requests completion automatically."""

MAX_ITEMS = 400
"""The maximum number of items in one list; if there are more, the editor requests the list again after more typing."""


def complete(snapshot: Snapshot, path: str, offset: int, trigger: str = "") -> Completions | None:
    """The completions at a caret; `None` if there are none.

    Args:
        trigger: the character after which the editor requests completion automatically; "" if the user requested it.
    """
    file = xml_file(snapshot.analysis, path)
    lines = in_lines(snapshot.analysis, path, offset) if trigger in ("", '"', "/", "_") else None
    if lines is not None and (source := snapshot.analysis.source(path)) is not None:
        return _shortened(source.text, offset, *lines)
    if file is None:
        json = in_json(snapshot.analysis, path, offset) if trigger != " " else None
        source = snapshot.analysis.source(path)
        if json is not None and source is not None:
            return _shortened(source.text, offset, *json)
        return _new_document(snapshot, path)
    place = place_at(file, offset)
    if place is None or (trigger == " " and not isinstance(place, AttributeName)):
        return None
    span_and_items = _at(Request(snapshot, path, offset, file), place)
    return None if span_and_items is None else _shortened(file.document.text, offset, *span_and_items)


def _at(request: Request, place: Place) -> tuple[Span, Iterable[CompletionItem]] | None:
    match place:
        case StartTag():
            items = list(elements(request, place.parents, bare=place.bare))
            if place.bare and place.parents and not place.parents[-1].element.complete:
                items.append(_end(place.parents[-1], "/"))
            return place.span, items
        case EndTag():
            name = place.name
            close = ">" if place.bare else ""
            return (place.span, [CompletionItem(name, ItemKind.ELEMENT, f"{escaped(name)}{close}")]) if name else None
        case AttributeName():
            bare = place.attribute is None or not place.attribute.has_value
            attribute_items = attributes(request, place.parents, place.typed, bare=bare)
            if place.attribute is None and request.file.document.text[request.offset : request.offset + 1].isalnum():
                return place.span, [_with(item, f"{item.snippet} ") for item in attribute_items]
            return place.span, attribute_items
        case AttributeValue():
            return _value(request, place)
        case Content():
            return _content(request, place)


def _end(parent: Typed, lead: str) -> CompletionItem:
    label = f"{lead}{parent.element.name}"
    return CompletionItem(label, ItemKind.ELEMENT, f"{escaped(label)}>", "end tag", rank=Rank.BEST)


def _value(request: Request, place: AttributeValue) -> tuple[Span, Iterable[CompletionItem]] | None:
    if place.typed.type is None and not any(typed.element.name == "BehaviorTree" for typed in place.parents):
        return None
    type_ = place.typed.type or request.file.grammar.elements["Action"]
    subject = CompletionSubject(place.typed.element, type_, place.parents)
    span_and_items = in_attribute(request, subject, place.attribute.name, place.span)
    if span_and_items is None:
        return None
    span, items = span_and_items
    if not place.quote:
        return span, [_with(item, f'"{item.snippet}"') for item in items]
    if place.quote == "'":
        return span, [_with(item, item.snippet.replace("'", '"')) for item in items]
    return span_and_items


def _with(item: CompletionItem, insert: str) -> CompletionItem:
    filter_ = item.filter or item.label
    return CompletionItem(item.label, item.kind, insert, item.detail, item.about, item.rank, filter_, item.deprecated)


def _content(request: Request, place: Content) -> tuple[Span, Iterable[CompletionItem]] | None:
    parent = place.parents[-1] if place.parents else None
    if parent is not None and parent.type is not None and (parent.type.value or parent.type.refers):
        text = request.file.document.text[place.text.start : place.text.end]
        lead = len(text) - len(text.lstrip())
        span = Span(place.text.start + lead, max(place.text.start + lead, place.text.start + len(text.rstrip())))
        if not span.contains(request.offset):
            span = Span(request.offset, request.offset)
        subject = CompletionSubject(parent.element, parent.type, place.parents[:-1])
        in_content = in_text(request, subject, span)
        if in_content is not None and (text.strip() or not parent.type.children):
            return in_content
        inner = [*(in_content[1] if in_content else ()), *_tags(request, place)]
        return Span(request.offset, request.offset), inner
    if parent is None and not request.file.document.text.strip():
        return place.span, [*documents(request.path), *_tags(request, place)]
    return place.span, _tags(request, place)


def _tags(request: Request, place: Content) -> list[CompletionItem]:
    """The completions at a place where no `<` has been typed: whole elements with their `<`."""
    items = [
        CompletionItem(i.label, i.kind, _tag(i), i.detail, i.about, i.rank, i.filter or i.label, i.deprecated)
        for i in elements(request, place.parents, bare=True)
    ]
    if place.parents and not place.parents[-1].element.complete:
        end = _end(place.parents[-1], "</")
        items.append(end)
    return items


def _tag(item: CompletionItem) -> str:
    """The text of an item with its `<`. The text of an item that inserts several elements already begins with `<`."""
    return item.snippet if item.snippet.startswith("<") else f"<{item.snippet}"


def _new_document(snapshot: Snapshot, path: str) -> Completions | None:
    source = snapshot.analysis.source(path)
    if source is None or source.text.strip(" \t\r\n\ufeff<"):
        return None
    items = tuple(documents(path))
    return Completions(Span(0, len(source.text)), items) if items else None


def _shortened(text: str, offset: int, span: Span, items: Iterable[CompletionItem]) -> Completions:
    """All items, the best first. If there are more than `MAX_ITEMS`, only the first `MAX_ITEMS` of those that match the
    typed text are returned."""
    before, after = text[span.start : offset], text[offset : span.end]
    span = Span(offset - len(before.rpartition("\n")[2]), offset + len(after.partition("\n")[0]))  # in one line
    unique = {(item.label, item.insert): item for item in items}.values()
    ordered = sorted(unique, key=lambda item: item.rank)
    if len(ordered) <= MAX_ITEMS:
        return Completions(span, tuple(ordered))
    typed = text[span.start : offset].lower()
    fitting = [item for item in ordered if _may_become(typed, (item.filter or item.label).lower())]
    return Completions(span, tuple(fitting[:MAX_ITEMS]), incomplete=True)


def _may_become(typed: str, label: str) -> bool:
    """Whether the label contains the typed characters in the same order, possibly with others in between."""
    rest = iter(label)
    return all(character in rest for character in typed)
