# SPDX-License-Identifier: Apache-2.0
"""The names that a translation gives to the nodes of the behavior tree, such as `bt_1005`, and the nodes that they
denote.

Properties use these names. Messages use them if several nodes have the same name. Each text that contains these names,
or the status of a node, states once where each of these nodes is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from roaml.jani.model import Model
from roaml.regex import regex
from roaml.scxml.names import NODE_AUTOMATON, TreeEventKind, tree_event_name
from roaml.views.actors import names_of

if TYPE_CHECKING:
    from roaml.views.story import PlaceOf

_STATUS = ".status"
_MENTIONED = regex(r"\bbt_(\d+)(?=_|\b)")


def explained(text: str, model: Model, place_of: PlaceOf) -> str:
    """A line that explains the node names in a text; "" if there are none.

    Args:
        place_of: file and line of an origin. The origin of a node's tick is the place of the node in the tree.
    """
    mentioned = {int(number) for number in _MENTIONED.findall(text)}
    alone = _with_status(text, model)
    if not mentioned and not alone:
        return ""
    origins = {automaton.name: automaton.origin for automaton in model.automata}
    explanations = []
    for automaton in model.automata:
        node = NODE_AUTOMATON.fullmatch(automaton.name)
        if node and (int(node[1]) in mentioned or automaton.name in alone):
            origin = origins.get(tree_event_name(node[1], TreeEventKind.TICK))
            if origin is not None and automaton.origin is not None and automaton.origin.path == origin.path:
                origin = automaton.origin  # a node of a library, whose own place is in the tree
            place = f" ({place_of(origin)})" if origin is not None else ""
            number = f"bt_{node[1]} is " if int(node[1]) in mentioned else ""
            explanations.append(f"{number}{node[2]}{place}")
    return f"nodes of the behavior tree: {', '.join(explanations)}\n" if explanations else ""


def _with_status(text: str, model: Model) -> frozenset[str]:
    """The automata of the nodes whose status a text mentions by a name of their own, such as `Wait.status`."""
    if _STATUS not in text:
        return frozenset()
    words = {word.lstrip("`(¬") for word in text.split()}
    return frozenset(own for own, name in names_of(model.automata).items() if name + _STATUS in words)
