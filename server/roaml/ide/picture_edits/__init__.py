# SPDX-License-Identifier: Apache-2.0
"""Edits of the files that a picture shows, by actions on its parts.

A part is identified by its place: the span of its element. An action asks for what it needs: it returns questions until
the answers suffice for an edit. So a client can offer all actions without knowing the languages.
"""

from __future__ import annotations

import enum
from collections.abc import Sequence

from roaml.exhaustive import assert_never
from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.ide.picture_edits import machine, tree
from roaml.ide.picture_edits.answers import ActionRefusal, Answer, EditAnswer, Option, UserQuestion
from roaml.ide.picture_edits.palette import Palette
from roaml.ide.picture_edits.parts import ChartPart, HandlerPart, Part, StatePart, TreeNodePart, name_offset, parts_of
from roaml.ide.rename import RenameRefusal, prepare, rename
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout
from roaml.text import Location, Span
from roaml.xml_syntax import Document

__all__ = ["ActionRefusal", "Answer", "Option", "PictureAction", "PictureParts", "UserQuestion", "answer"]


class PictureAction(enum.Enum):
    """An action on a part of a picture. The values are part of the protocol between server and client."""

    ADD_STATE = "addState"
    ADD_TRANSITION = "addTransition"
    ADD_CHILD = "addChild"
    ADD_AFTER = "addAfter"
    RENAME = "rename"
    SET_NAME = "setName"
    SET_INITIAL = "setInitial"
    CHANGE_NODE = "changeNode"
    WRAP = "wrap"
    UNWRAP = "unwrap"
    MOVE_EARLIER = "moveEarlier"
    MOVE_LATER = "moveLater"
    DELETE_TRANSITION = "deleteTransition"
    DELETE = "delete"


class PictureParts:
    """The actions that parts of pictures allow. The parts of each file are read once."""

    def __init__(self, analysis: Analysis) -> None:
        self._analysis = analysis
        self._parts: dict[str, dict[Span, Part]] = {}

    def actions(self, place: Location | None) -> tuple[PictureAction, ...]:
        """The actions that the part at a place allows, in the order of a menu. `answer` may still refuse one of
        them."""
        if place is None:
            return ()
        if place.path not in self._parts:
            self._parts[place.path] = dict(parts_of(self._analysis, place.path))
        part = self._parts[place.path].get(place.span)
        return tuple(action for action in PictureAction if part is not None and _allows(part, action))


def _allows(part: Part, action: PictureAction) -> bool:
    match action:
        case PictureAction.ADD_STATE:
            return isinstance(part, (ChartPart, StatePart))
        case PictureAction.ADD_TRANSITION:
            return isinstance(part, StatePart)
        case PictureAction.SET_INITIAL:
            is_initial = (
                isinstance(part, StatePart)
                and part.state.id is not None
                and part.chart.initial is not None
                and part.state.id.value == part.chart.initial.value
            )
            return isinstance(part, StatePart) and not is_initial
        case PictureAction.DELETE_TRANSITION:
            return isinstance(part, StatePart) and bool(part.state.handlers)
        case PictureAction.DELETE:
            return isinstance(part, (StatePart, HandlerPart)) or (
                isinstance(part, TreeNodePart) and part.parent is not None
            )
        case PictureAction.RENAME:
            return name_offset(part) is not None
        case PictureAction.ADD_CHILD:
            return isinstance(part, TreeNodePart) and len(part.node.children) < part.children[1]
        case PictureAction.ADD_AFTER:
            return isinstance(part, TreeNodePart) and len(part.siblings) < part.parent_children[1]
        case PictureAction.SET_NAME:
            return isinstance(part, TreeNodePart) and part.node.name is None
        case PictureAction.CHANGE_NODE | PictureAction.WRAP:
            return isinstance(part, TreeNodePart)
        case PictureAction.UNWRAP:
            return isinstance(part, TreeNodePart) and tree.can_unwrap(part)
        case PictureAction.MOVE_EARLIER:
            return isinstance(part, TreeNodePart) and part.node is not part.siblings[0]
        case PictureAction.MOVE_LATER:
            return isinstance(part, TreeNodePart) and part.node is not part.siblings[-1]
        case _:
            return assert_never(action)


def answer(
    analysis: Analysis, path: str, span: Span | None, action: PictureAction, answers: Sequence[str] = ()
) -> Answer:
    """The edit of an action, or what it still needs, or why it is not possible.

    Args:
        span: the place of the part; `None` for the whole file.
        answers: the answers to the questions that were asked before, in their order.
    """
    document, source = analysis.document(path), analysis.source(path)
    if span is None and document is not None and document.root is not None:
        span = document.root.span
    part = parts_of(analysis, path).get(span) if span is not None else None
    if document is None or source is None or part is None:
        return ActionRefusal("the file has changed; try again on the new picture")
    if not _allows(part, action):
        return ActionRefusal("this part of the picture does not allow this action")
    if action is PictureAction.RENAME:
        return _rename(analysis, path, part, answers)
    edits = _edits(analysis, path, document, part, action, answers)
    if isinstance(edits, (UserQuestion, ActionRefusal)):
        return edits
    return WorkspaceEdit({path: tuple(in_layout(source, edits))})


def _edits(
    analysis: Analysis, path: str, document: Document, part: Part, action: PictureAction, answers: Sequence[str]
) -> EditAnswer:
    match action, part:
        case PictureAction.ADD_STATE, ChartPart():
            return machine.add_state(document, part.chart, None, answers)
        case PictureAction.ADD_STATE, StatePart():
            return machine.add_state(document, part.chart, part.state, answers)
        case PictureAction.ADD_TRANSITION, StatePart():
            return machine.add_transition(analysis, path, document, part, answers)
        case PictureAction.SET_INITIAL, StatePart():
            return machine.set_initial(part.chart, part.state)
        case PictureAction.DELETE_TRANSITION, StatePart():
            chosen = machine.choose_transition(part.machine, part.state, answers)
            return machine.delete_transition(document, chosen) if isinstance(chosen, HandlerPart) else chosen
        case PictureAction.DELETE, StatePart():
            return machine.delete_state(document, part)
        case PictureAction.DELETE, HandlerPart():
            return machine.delete_transition(document, part)
        case PictureAction.DELETE, TreeNodePart():
            return tree.delete(document, part)
        case PictureAction.ADD_CHILD, TreeNodePart():
            return tree.add_child(document, part, Palette(analysis, path), answers)
        case PictureAction.ADD_AFTER, TreeNodePart():
            return tree.add_after(document, part, Palette(analysis, path), answers)
        case PictureAction.SET_NAME, TreeNodePart():
            return tree.set_name(analysis, path, part, answers)
        case PictureAction.CHANGE_NODE, TreeNodePart():
            return tree.change(document, part, Palette(analysis, path), answers)
        case PictureAction.WRAP, TreeNodePart():
            return tree.wrap(document, part, Palette(analysis, path), answers)
        case PictureAction.UNWRAP, TreeNodePart():
            return tree.unwrap(document, part)
        case PictureAction.MOVE_EARLIER, TreeNodePart():
            return tree.move(document, part, -1)
        case PictureAction.MOVE_LATER, TreeNodePart():
            return tree.move(document, part, 1)
    raise AssertionError((action, part))


def _rename(analysis: Analysis, path: str, part: Part, answers: Sequence[str]) -> Answer:
    offset = name_offset(part)
    assert offset is not None
    prepared = prepare(analysis, path, offset)
    if isinstance(prepared, RenameRefusal):
        return ActionRefusal(prepared.reason)
    if not answers:
        return UserQuestion(f"The new name of `{prepared.name}`", proposal=prepared.name)
    renaming = rename(analysis, path, offset, answers[0])
    return ActionRefusal(renaming.reason) if isinstance(renaming, RenameRefusal) else WorkspaceEdit(renaming.edits)
