# SPDX-License-Identifier: Apache-2.0
"""Messages about variables that a property names and the model does not have, for properties that are written as
text."""

from __future__ import annotations

import re

from roaml.jani.model import Model
from roaml.suggest import alternatives

MAX_EXAMPLES = 3
"""The maximum number of variables that a message names as examples."""
_FLAG = ".valid"
_TOPIC = r"topic_(\w+?)_msg(?:\.valid|__\w+)?"
_SHORTEST_WORD = 3


def unknown_variable(name: str, model: Model, message: str) -> str:
    """The message about a variable that a property names and the model does not have.

    Args:
        message: the beginning, which may suggest a similar name.

    Returns:
        If the name is that of a message that nobody sends, the message says so. Otherwise, if it suggests no name, it
        says which names exist, and for a translated system how messages are written.
    """
    names = [variable.name for variable in model.variables]
    topic = re.fullmatch(_TOPIC, name)
    is_system = model.metadata is not None
    if is_system and topic is not None and not any(known.startswith(f"topic_{topic[1]}_msg") for known in names):
        said, semicolon, guess = message.partition(";")
        return f"{said}, because nothing in the system sends a message on the topic `{topic[1]}`{semicolon}{guess}"
    if ";" in message:
        return message
    if not is_system:
        return f"{message}{alternatives((), names, 'variable')}"
    return f"{message}; a property reads messages and events, not the variables of machines{_examples(name, names)}"


def _examples(name: str, names: list[str]) -> str:
    """Variables of messages with a word of `name`; otherwise the first ones."""
    words = [word for word in re.split(r"\W+|_+", name.lower()) if len(word) >= _SHORTEST_WORD and word != "valid"]
    events = [known.removesuffix(_FLAG) for known in names if known.endswith(_FLAG)]
    about = [event for event in events if any(word in event.lower() for word in words)] or events
    if not about:
        return ""
    event = about[0]
    field = next((known for known in names if known.startswith(f"{event}__")), "")
    read = f" and `{field}` (a value of the last one)" if field else ""
    others = [f"`{other}{_FLAG}`" for other in about[1:MAX_EXAMPLES]]
    further = f"; others are {' and '.join(others)}" if others else ""
    return f", such as `{event}{_FLAG}` (true after the first one){read}{further}"
