# SPDX-License-Identifier: Apache-2.0
"""Edits of behavior trees: nodes are added, wrapped, replaced, named, moved and deleted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from xml.sax.saxutils import quoteattr

from roaml.edit.elements import after, indent_of, last_in, level_of, removals, with_comments, without_attribute
from roaml.ide.picture_edits.answers import ActionRefusal, EditAnswer, Option, UserQuestion
from roaml.ide.picture_edits.palette import Palette, PaletteNode
from roaml.ide.picture_edits.parts import TreeNodePart
from roaml.ide.rename.new_name import tree_node_problem
from roaml.model.tree import EXPLICIT, TreeNode
from roaml.project.analysis import Analysis
from roaml.roles import NodeKind
from roaml.text import Edit, Span, TextEdit
from roaml.xml_syntax import Document, Element


def can_unwrap(part: TreeNodePart) -> bool:
    """Whether the parent of a node may have the children of the node instead of the node."""
    own = len(part.node.children)
    return own > 0 and len(part.siblings) - 1 + own <= part.parent_children[1]


def delete(document: Document, part: TreeNodePart) -> EditAnswer:
    return tuple(removals(document, [part.node.element]))


def add_child(document: Document, part: TreeNodePart, palette: Palette, answers: Sequence[str]) -> EditAnswer:
    """Add a node as the last child of a node."""
    written = _written("The node to add", palette.nodes(part.tree), answers)
    return (last_in(document, part.node.element, f"<{written} />"),) if isinstance(written, str) else written


def add_after(document: Document, part: TreeNodePart, palette: Palette, answers: Sequence[str]) -> EditAnswer:
    """Add a node as the next sibling of a node."""
    written = _written("The node to add", palette.nodes(part.tree), answers)
    return (after(document, part.node.element, f"<{written} />"),) if isinstance(written, str) else written


def wrap(document: Document, part: TreeNodePart, palette: Palette, answers: Sequence[str]) -> EditAnswer:
    """Put a node into a new node, as its only child."""
    nodes = [node for node in palette.nodes(part.tree) if node.children[0] <= 1 <= node.children[1]]
    written = _written("The node around it", nodes, answers)
    if not isinstance(written, str):
        return written
    element, text = part.node.element, document.text
    name = written.split(" ", 1)[0]
    start, end = element.span
    if not _has_own_line(text, element):
        return (TextEdit(Span(start, start), f"<{written}>"), TextEdit(Span(end, end), f"</{name}>"))
    indent, level = indent_of(text, element), level_of(document)
    return (
        TextEdit(Span(start, start), f"<{written}>\n{indent}{level}"),
        *(TextEdit(Span(line, line), level) for line in _lines(text, element)),
        TextEdit(Span(end, end), f"\n{indent}</{name}>"),
    )


def unwrap(document: Document, part: TreeNodePart) -> EditAnswer:
    """Replace a node by its children."""
    element, text = part.node.element, document.text
    if element.close_span is None:
        return ActionRefusal("the element has no end tag")
    level = level_of(document) if _has_own_line(text, element) else ""
    dedents = (
        TextEdit(Span(line, line + len(level)), "")
        for line in _lines(text, element)
        if level and text.startswith(level, line) and text[line : element.close_span.start].strip()
    )
    return (TextEdit(element.open_span, ""), *dedents, TextEdit(element.close_span, ""))


def change(document: Document, part: TreeNodePart, palette: Palette, answers: Sequence[str]) -> EditAnswer:
    """Replace the type of a node. Attributes that the new type does not have are removed."""
    node, count = part.node, len(part.node.children)
    own = node.plugin.value if node.plugin is not None else ""
    nodes = [
        new
        for new in palette.nodes(part.tree)
        if (new.name, new.kind is NodeKind.SUBTREE) != (own, node.is_subtree)
        and new.children[0] <= max(count, part.children[0]) <= new.children[1]
        and (new.children[1] > 0) == (part.children[1] > 0)
    ]
    chosen = _chosen(f"The node instead of `{own}`", nodes, answers)
    if not isinstance(chosen, PaletteNode):
        return chosen
    given = {setting.key.value for setting in node.ports}
    values = _values(chosen, answers[1:], given)
    return tuple(_retagged(document, node, chosen, values)) if isinstance(values, Mapping) else values


def set_name(analysis: Analysis, path: str, part: TreeNodePart, answers: Sequence[str]) -> EditAnswer:
    """Set the attribute `name` of a node that has none."""
    if not answers:
        return UserQuestion("The name of the node")
    name = answers[0].strip()
    reason = tree_node_problem(name, in_system=analysis.systems_of(path)[0] is not None)
    if reason:
        return ActionRefusal(reason)
    id_ = part.node.element.get("ID") if not part.node.compact else None
    at = id_.span.end if id_ is not None else part.node.element.name_span.end
    return (TextEdit(Span(at, at), f" name={quoteattr(name)}"),)


def move(document: Document, part: TreeNodePart, by: int) -> EditAnswer:
    """Exchange a node with the sibling at a distance of `by`, 1 or -1. The comments above both move with them."""
    siblings = part.siblings
    index = next(index for index, node in enumerate(siblings) if node is part.node)
    around = part.tree.element if part.parent is None else part.parent.element
    one, other = (with_comments(around, node.element) for node in (part.node, siblings[index + by]))
    text = document.text
    return (TextEdit(one, text[other.start : other.end]), TextEdit(other, text[one.start : one.end]))


def _written(text: str, nodes: Sequence[PaletteNode], answers: Sequence[str]) -> str | UserQuestion | ActionRefusal:
    """The start tag of the node that the user chooses, without its brackets."""
    chosen = _chosen(text, nodes, answers)
    if not isinstance(chosen, PaletteNode):
        return chosen
    values = _values(chosen, answers[1:])
    return chosen.tag(values) if isinstance(values, Mapping) else values


def _chosen(
    text: str, nodes: Sequence[PaletteNode], answers: Sequence[str]
) -> PaletteNode | UserQuestion | ActionRefusal:
    if not nodes:
        return ActionRefusal("no other node has a suitable number of children")
    if not answers:
        return UserQuestion(text, tuple(Option(node.name, node.answer, node.kind.value) for node in nodes))
    chosen = next((node for node in nodes if node.answer == answers[0]), None)
    return chosen or ActionRefusal(f"there is no node `{answers[0]}` that fits here")


def _values(
    node: PaletteNode, answers: Sequence[str], given: frozenset[str] | set[str] = frozenset()
) -> Mapping[str, str] | UserQuestion | ActionRefusal:
    """The values of the ports that a node needs and that are not `given`, which the user writes one after the other."""
    needed = [port for port in node.ports if port.key not in given]
    values: dict[str, str] = {}
    for port, value in zip(needed, answers, strict=False):
        if not value.strip():
            return ActionRefusal(f"the port `{port.key}` needs a value")
        values[port.key] = value.strip()
    if len(values) == len(needed):
        return values
    port = needed[len(values)]
    type_ = f" ({port.type})" if port.type else ""
    return UserQuestion(f"The value of the port `{port.key}`{type_} of `{node.name}`", proposal=port.proposal)


def _retagged(document: Document, node: TreeNode, new: PaletteNode, values: Mapping[str, str]) -> Iterator[Edit]:
    """Edits that change the type of a node. An explicit node stays explicit."""
    element, id_ = node.element, None if node.compact else node.element.get("ID")
    is_subtree = new.kind is NodeKind.SUBTREE
    has_id = is_subtree or element.name in EXPLICIT
    tag = "SubTree" if is_subtree else new.kind.value.capitalize() if has_id else new.name
    added = "".join(f" {key}={quoteattr(value)}" for key, value in values.items())
    if has_id and id_ is None:
        added = f" ID={quoteattr(new.name)}{added}"
    yield TextEdit(element.name_span, tag + ("" if has_id and id_ is not None else added))
    if id_ is not None:
        if has_id:
            yield TextEdit(id_.span, f"ID={quoteattr(new.name)}{added}")
        else:
            yield without_attribute(document.text, id_)
    for setting in node.ports:
        # A subtree accepts any name; only its parameters of the library begin with `_`.
        is_kept = setting.key.value in new.keys if new.keys is not None else not setting.key.value.startswith("_")
        if not is_kept:
            yield without_attribute(document.text, setting.attribute)
    if element.close_name_span is not None:
        yield TextEdit(element.close_name_span, tag)


def _has_own_line(text: str, element: Element) -> bool:
    """Whether only white space is before an element on its line."""
    line = text[: element.span.start].rpartition("\n")[2]
    return not line.strip()


def _lines(text: str, element: Element) -> list[int]:
    """The offsets of the lines that begin inside an element, without empty lines and without those that begin inside
    the value of an attribute."""
    values = [attribute.value_span for inner in element.walk() for attribute in inner.attributes if attribute.has_value]
    broken = [span for span in values if "\n" in text[span.start : span.end]]
    starts: list[int] = []
    at = text.find("\n", element.span.start, element.span.end)
    while at >= 0:
        start = at + 1
        at = text.find("\n", start, element.span.end)
        line = text[start : at if at >= 0 else element.span.end]
        if line.strip() and not any(span.start < start <= span.end for span in broken):
            starts.append(start)
    return starts
