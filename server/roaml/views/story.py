# SPDX-License-Identifier: Apache-2.0
"""The explanation of a trace (`Story`) for users: as text, as a Mermaid sequence diagram, or as a self-contained HTML
page."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from roaml.jani.expressions import Integer, Real
from roaml.jani.model import Clause
from roaml.jani.node import Origin
from roaml.scxml.names import CLOCK, TREE_ROOT_PREFIX
from roaml.smc.end import End
from roaml.smc.record import SELECTED, SHORTEST, VERDICTS, TraceVerdict
from roaml.smc.story import Story
from roaml.views.arrays import DeclaredChange, DeclaredValue
from roaml.views.event_words import message_phrases
from roaml.views.observed import reads_observer
from roaml.views.turns import Message, Turn, turns
from roaml.views.values import shown_parameters, shown_value
from roaml.views.waiting import Wait, help_line, waits

MAX_CHARACTERS = 60
"""The maximum number of characters of the states or the parameters of an event in a line."""
FIRST, LAST = 30, 50
"""The numbers of turns that are shown at the beginning and at the end. The turns between them are folded."""

PlaceOf = Callable[[Origin], str]
"""File and line of an origin, as text for users."""


class StoryLine(NamedTuple):
    """The turn of one automaton: its steps from one event to the next. `details` are the effects of the turn.

    `place` and `origin` are the place of the turn, as a phrase and as a position in the text; `location` is the
    location after the turn. `automaton` is the name of the automaton in the model, and `who` its name for users. Both
    are "" for folded turns. `step` and `last_step` are the numbers of the first and last step of the turn.
    """

    step: int
    time: str
    who: str
    what: str
    place: str
    details: tuple[str, ...]
    automaton: str = ""
    origin: Origin | None = None
    location: str = ""
    last_step: int = 0


def lines(story: Story, place_of: PlaceOf) -> list[StoryLine]:
    """The lines of an explanation. If the trace gets stuck, the waiting automata are listed at the end."""
    return [*_turn_lines(story, place_of), *_waiting(story, place_of)]


def _turn_lines(story: Story, place_of: PlaceOf) -> list[StoryLine]:
    shown_turns = turns(story)
    folded = _folded(story, shown_turns)
    story_lines = [_line(turn, place_of) for number, turn in enumerate(shown_turns) if number not in folded]
    if folded:
        story_lines.insert(
            FIRST,
            StoryLine(shown_turns[FIRST].number, "", "", _more(folded), "", (), last_step=shown_turns[folded[-1]].last),
        )
    return story_lines


def _waiting(story: Story, place_of: PlaceOf) -> list[StoryLine]:
    story_lines = []
    end = len(story.steps)
    for wait in waits_of(story):
        place = "" if wait.origin is None else place_of(wait.origin)
        story_lines.append(
            StoryLine(end, "", wait.who, wait.what, place, (), wait.automaton, wait.origin, wait.location, end)
        )
    return story_lines


def waits_of(story: Story) -> tuple[Wait, ...]:
    """The waiting automata at the end of a trace; empty if the trace is not stuck."""
    return () if story.standstill is None else waits(story.standstill, story.clock[-1] if story.clock else None)


def _line(turn: Turn, place_of: PlaceOf) -> StoryLine:
    return StoryLine(
        turn.number,
        "" if turn.time is None else f"{turn.time:.3f} s",
        turn.who,
        _what(turn),
        "" if turn.origin is None else place_of(turn.origin),
        tuple(_details(turn)),
        turn.automaton,
        turn.origin,
        turn.destination,
        turn.last,
    )


def as_text(story: Story, place_of: PlaceOf, shown: str = "") -> str:
    """The explanation as text for a terminal.

    Args:
        shown: the place in the output where the waiting automata are already shown; "" if they are to be shown here.
    """
    waiting = waits_of(story)
    table = [*_turn_lines(story, place_of), *([] if shown else _waiting(story, place_of))]
    widths = [max((len(str(row[i])) for row in table), default=0) for i in range(4)]
    text = f"{heading(story)}\n" + (f"  {story.comment}\n" if story.comment else "")
    for row in table:
        cells = (f"{row.step:>{widths[0]}}", row.time.rjust(widths[1]), row.who.ljust(widths[2]))
        text += "  " + "  ".join((*cells, row.what.ljust(widths[3]), row.place)).rstrip() + "\n"
        margin = " " * (widths[0] + widths[1] + widths[2] + 8)
        text += "".join(f"{margin}{detail}\n" for detail in row.details)
    last = f"the waiting automata are shown {shown}" if waiting and shown else help_line(waiting)
    return f"{text}  {last}\n" if last else text


def heading(story: Story) -> str:
    """A sentence that summarises the trace."""
    verdict = VERDICTS[story.recording.verdict]
    outcome = "went wrong" if verdict is TraceVerdict.FAULT else verdict.value
    steps = f"{len(story.steps):,} {'step' if len(story.steps) == 1 else 'steps'}"
    number = story.recording.trace
    trace = {SHORTEST: "the shortest trace", SELECTED: "a trace"}.get(number, f"trace {number}")
    text = f"{story.property} {outcome} in {trace} after {steps}"
    if story.recording.end is End.STUCK:
        text = f"{story.property}: {trace} gets stuck after {steps}"
    elif story.recording.end not in (End.DECIDED, End.CUT):
        text += f" ({story.recording.end.text})"
    if story.is_whole:
        return text
    count = len(turns(story))
    text += f"; {count:,} {'turn matters' if count == 1 else 'turns matter'}"
    automata = {automaton.name for automaton in story.automata}
    read = [name for name in story.variables if not reads_observer(name, automata)]
    variables = message_phrases(read, automata)
    return text + (f" (it reads {', '.join(variables)})" if variables else "")


def as_mermaid(story: Story, place_of: PlaceOf, first: int = 0) -> str:
    """A sequence diagram in Mermaid. An event is an arrow from its sender to its receiver, at the time when it is
    received.

    Args:
        first: turns that end before this step are left out.
    """
    return "\n".join(_mermaid(story, place_of, first)) + "\n"


def _mermaid(story: Story, place_of: PlaceOf, first: int) -> Iterator[str]:
    shown_turns = [turn for turn in turns(story) if turn.last >= first]
    folded = _folded(story, shown_turns)
    lanes = {turn.instance for turn in shown_turns}
    names: dict[str, str] = {}
    body: list[str] = []
    moment: float | None = None

    def actor(turn: Turn) -> str:
        return names.setdefault(turn.who, f"A{len(names)}")

    for number, turn in enumerate(shown_turns):
        if number in folded:
            if number == FIRST:
                body.append(f"Note over {actor(turn)}: {_more(folded)}")
            continue
        if turn.time is not None and turn.time != moment:
            moment = turn.time
            body.append(f"Note over {actor(turn)}: {moment:.3f} s")
        place = "" if turn.origin is None else f" ({place_of(turn.origin)})"
        sender = turn.heard.sender if turn.heard else None
        if turn.heard and sender and sender.instance in lanes and not turn.is_answered:
            arrow = f"{actor(sender)}->>{actor(turn)}"
            event_phrase = f"tick, {turn.status}" if turn.is_ticked and turn.status else _message(turn.heard)
            body.append(f"{arrow}: {_escaped(event_phrase + place)}")
        else:
            body.append(f"Note over {actor(turn)}: {_escaped(_what(turn) + place)}")
        details = "<br/>".join(_escaped(detail) for detail in _details(turn))
        if details:
            body.append(f"Note over {actor(turn)}: {details}")
    for wait in waits_of(story):
        place = "" if wait.origin is None else f" ({place_of(wait.origin)})"
        body.append(f"Note over {names.setdefault(wait.who, f'A{len(names)}')}: {_escaped(wait.what + place)}")
    yield "sequenceDiagram"
    yield f"    %% {heading(story).translate(_COMMENT_CODES)}"
    for name, short in names.items():
        yield f"    participant {short} as {_escaped(name)}"
    yield from (f"    {line}" for line in body)


def as_html(stories: Sequence[Story], place_of: PlaceOf, title: str) -> str:
    """A self-contained HTML page. Each line of an explanation contains the place of its turn in the sources."""
    parts = [_section(story, place_of) for story in stories]
    return _PAGE.format(title=html.escape(title), body="\n".join(parts))


def _section(story: Story, place_of: PlaceOf) -> str:
    table = lines(story, place_of)
    lanes = list(dict.fromkeys(row.who for row in table if row.who))
    head = "".join(f"<th>{html.escape(name)}</th>" for name in lanes)
    rows = []
    for row in table:
        cells = []
        for name in lanes:
            if name == row.who:
                place = f"<small>{html.escape(row.place)}</small>"
                details = "".join(f"<li>{html.escape(detail)}</li>" for detail in row.details)
                cells.append(f"<td class='at'>{html.escape(row.what)}{place}<ul>{details}</ul></td>")
            else:
                cells.append("<td></td>")
        rows.append(f"<tr><th>{row.step}</th><th>{html.escape(row.time)}</th>{''.join(cells)}</tr>")
    return (
        f"<h2>{html.escape(story.property)}</h2><p>{html.escape(story.comment)}</p>"
        f"<p>{html.escape(heading(story))}</p>"
        f"<table><thead><tr><th>step</th><th>time</th>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"
        f"<details><summary>Mermaid</summary><pre>{html.escape(as_mermaid(story, place_of))}</pre></details>"
    )


_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 14px/1.4 system-ui, sans-serif; margin: 2em; color: #1f2328; background: #fff; }}
table {{ border-collapse: collapse; }} thead th {{ position: sticky; top: 0; background: #fff; }}
th, td {{ border-right: 1px dotted #bbb; padding: .25em .7em; text-align: left; vertical-align: top; }}
tbody th {{ font-weight: normal; color: #666; white-space: nowrap; }}
.at {{ background: #eef4ff; border-left: 3px solid #1f6feb; }} small {{ display: block; color: #666; }}
ul {{ margin: .2em 0 0; padding-left: 1.2em; }} pre {{ background: #f6f8fa; padding: 1em; overflow: auto; }}
@media (prefers-color-scheme: dark) {{ body, thead th {{ background: #0d1117; color: #e6edf3; }}
.at {{ background: #10243f; }} pre {{ background: #161b22; }} }}
</style></head><body><h1>{title}</h1>
{body}
</body></html>
"""


def _folded(story: Story, shown_turns: Sequence[Turn]) -> range:
    """The indexes of the turns for which one line with their number is shown."""
    return range(0) if story.is_whole else range(FIRST, len(shown_turns) - LAST)


def _more(folded: range) -> str:
    return f"… {len(folded):,} more …"


def _what(turn: Turn) -> str:
    if turn.observed:
        return turn.observation
    if turn.automaton == CLOCK and turn.heard is None:
        return "advances the time"
    if turn.automaton.startswith(TREE_ROOT_PREFIX) and turn.result:
        return f"ends with {turn.result}"
    source, destination = turn.source, turn.destination
    if turn.starts:
        return "starts" if turn.is_library_node else f"starts in {_short(destination)}"
    move = _short(source if source == destination else f"{source} → {destination}")
    place = "" if turn.is_library_node else f" in {move}"
    answer = f": {turn.status}" if turn.status else ""
    if turn.is_answered and turn.status:
        return f"returns {turn.status}"
    if turn.is_ticked:
        return f"is ticked{place}{answer}"
    if turn.is_halted:
        return f"is halted{place}"
    if turn.heard is not None:
        return f"receives {_message(turn.heard)}{place}{answer}"
    if turn.is_library_node:
        return f"goes on{answer}"
    return f"{turn.action}: {move}" if turn.action else move


def _details(turn: Turn) -> Iterator[str]:
    if turn.observed:
        yield from turn.effects
        return
    if turn.automaton == CLOCK:
        return
    for part in turn.parts:
        if len(part.edge.destinations) > 1:
            yield _chance(part.destination.probability)
    yield from (_change(change, turn) for change in turn.changes)
    yield from (f"sends {_message(message)}" for message in turn.sent)


def _chance(probability: Clause | None) -> str:
    known = probability.exp if probability is not None else None
    return f"by chance, {known.value:g}" if isinstance(known, (Integer, Real)) else "by chance"


def _message(message: Message) -> str:
    values = shown_parameters(message.values)
    return f"{message.name} ({_short(values)})" if values else message.name


def _change(change: DeclaredChange, turn: Turn) -> str:
    name = change.variable.name
    phrase = turn.phrases.get(name, name) if change.variable.instance == turn.instance else name
    return f"{phrase}: {_shown(change.before, change.after)}"


def _shown(before: DeclaredValue, after: DeclaredValue) -> str:
    return f"{_short(shown_value(before))} → {_short(shown_value(after))}"


def _short(text: str) -> str:
    return text if len(text) <= MAX_CHARACTERS else f"{text[: MAX_CHARACTERS - 1]}…"


def _escaped(text: str) -> str:
    """A text without characters that have a meaning in Mermaid or HTML: Mermaid ends a line at `;`, reads `#` as the
    start of a character's number, and interprets tags."""
    return text.translate(_CODES)


_CODES = {ord(character): f"#{ord(character)};" for character in "#;:%<>&"} | dict.fromkeys(range(32), " ")
_COMMENT_CODES = {ord(character): f"#{ord(character)};" for character in "<>&"} | dict.fromkeys(range(32), " ")
