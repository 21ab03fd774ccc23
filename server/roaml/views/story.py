# SPDX-License-Identifier: Apache-2.0
"""The explanation of a trace (`Story`) for users: as text, as a Mermaid sequence diagram, or as a self-contained HTML
page."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from roaml.durations import moment
from roaml.jani.node import Origin
from roaml.regex import regex
from roaml.scxml.names import is_status
from roaml.smc.end import End
from roaml.smc.story import Story, outcome
from roaml.views.actors import names_of
from roaml.views.cause import cause
from roaml.views.folding import LeftOut, Repetition, Shown, folded, without_middle
from roaml.views.marked import marked
from roaml.views.observed import reads_observer
from roaml.views.parting import Parting
from roaml.views.shared_names import read_names
from roaml.views.trace_names import trace_name
from roaml.views.turn_words import chances, details, message_text, scheduling, what
from roaml.views.turns import Turn, turns
from roaml.views.waiting import Wait, help_line, waits

FIRST, LAST = 30, 50
"""The numbers of lines that are shown at the beginning and at the end. The lines between them are folded."""
MAX_COLUMNS = 5
"""The maximum number of automata that have a column each in a page. So many columns with a path fit 1200 pixels."""
_NUMBER = regex(r"-?\d+(\.\d+)?")

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
    shown_turns = _without_idle_halts(story, turns(story))
    return [
        turn_line(shown_turns[shown], place_of) if isinstance(shown, int) else _folded_line(shown, shown_turns)
        for shown in _folded(story, shown_turns)
    ]


def _folded_line(shown: Repetition | LeftOut, shown_turns: Sequence[Turn]) -> StoryLine:
    text, end = _folded_text(shown, shown_turns), shown_turns[shown.last].last
    return StoryLine(shown_turns[shown.first].number, "", "", text, "", (), last_step=end)


def _without_idle_halts(story: Story, all_turns: Sequence[Turn]) -> list[Turn]:
    """The turns without halts of library nodes that are not running, which have no effect."""
    if story.is_whole:
        return list(all_turns)
    return [turn for turn in all_turns if not (turn.is_halted and turn.is_library_node and not any(details(turn)))]


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


def turn_line(turn: Turn, place_of: PlaceOf) -> StoryLine:
    """The line of one turn."""
    return StoryLine(
        turn.number,
        "" if turn.time is None else moment(turn.time),
        turn.who,
        what(turn),
        "" if turn.origin is None else place_of(turn.origin),
        (*scheduling(turn), *details(turn)),
        turn.automaton,
        turn.origin,
        turn.destination,
        turn.last,
    )


def as_text(story: Story, place_of: PlaceOf, shown: str = "", near: tuple[Parting, Story] | None = None) -> str:
    """The explanation as text for a terminal.

    Args:
        shown: the place in the output where the waiting automata are already shown; "" if they are to be shown here.
        near: where the trace parts from one with the opposite verdict, and that trace.
    """
    waiting = waits_of(story)
    table = [*_turn_lines(story, place_of), *([] if shown else _waiting(story, place_of))]
    widths = [max((len(str(row[i])) for row in table), default=0) for i in range(4)]
    why = cause(story, place_of, near)
    text = f"{why}\n  {heading(story)}\n" if why else f"{heading(story)}\n"
    text += f"  {story.comment}\n" if story.comment else ""
    for row in table:
        cells = (f"{row.step:>{widths[0]}}", row.time.rjust(widths[1]), row.who.ljust(widths[2]))
        text += "  " + "  ".join((*cells, row.what.ljust(widths[3]), row.place)).rstrip() + "\n"
        margin = " " * (widths[0] + widths[1] + widths[2] + 8)
        text += "".join(f"{margin}{detail}\n" for detail in row.details)
    last = f"who waits for whom is shown {shown}" if waiting and shown else help_line(waiting)
    return f"{text}  {last}\n" if last else text


def summary(story: Story) -> str:
    """The verdict of a trace, its length, and how many of its turns matter, in one short sentence."""
    steps = f"{len(story.steps):,} {'step' if len(story.steps) == 1 else 'steps'}"
    trace = trace_name(story)
    text = f"{story.property} {outcome(story)} in {trace} after {steps}"
    if story.recording.end is End.STUCK:
        text = f"{story.property}: {trace} gets stuck after {steps}"
    elif story.recording.end not in (End.DECIDED, End.CUT):
        text += f" ({story.recording.end.text})"
    if story.is_whole:
        return text
    count = len(turns(story))
    return f"{text}; {count:,} {'turn matters' if count == 1 else 'turns matter'}"


def heading(story: Story) -> str:
    """A sentence that summarises the trace, with the variables that the property reads."""
    text = summary(story)
    if story.is_whole:
        return text
    automata = names_of(story.automata)
    read = [name for name in story.variables if not reads_observer(name, automata) and not is_status(name)]
    variables = read_names(read, automata)
    return text + (f" (it reads {', '.join(variables)})" if variables else "")


def as_mermaid(story: Story, place_of: PlaceOf, first: int = 0) -> str:
    """A sequence diagram in Mermaid. An event is an arrow from its sender to its receiver, at the time when it is
    received.

    Args:
        first: turns that end before this step are left out.
    """
    return "\n".join(_mermaid(story, place_of, first)) + "\n"


def _mermaid(story: Story, place_of: PlaceOf, first: int) -> Iterator[str]:
    shown_turns = _without_idle_halts(story, [turn for turn in turns(story) if turn.last >= first])
    lanes = {turn.instance for turn in shown_turns}
    names: dict[str, str] = {}
    body: list[str] = []
    last_time: float | None = None

    def actor(turn: Turn) -> str:
        return names.setdefault(turn.who, f"A{len(names)}")

    for shown in _folded(story, shown_turns):
        if not isinstance(shown, int):
            body.append(f"Note over {actor(shown_turns[shown.first])}: {_folded_text(shown, shown_turns)}")
            continue
        turn = shown_turns[shown]
        if turn.time is not None and turn.time != last_time:
            last_time = turn.time
            body.append(f"Note over {actor(turn)}: {moment(turn.time)}")
        place = "" if turn.origin is None else f" ({place_of(turn.origin)})"
        sender = turn.heard.sender if turn.heard else None
        if turn.heard and sender and sender.instance in lanes and not turn.is_answered:
            arrow = f"{actor(sender)}->>{actor(turn)}"
            event_phrase = f"tick, {turn.status}" if turn.is_ticked and turn.status else message_text(turn.heard)
            body.append(f"{arrow}: {_escaped(event_phrase + place)}")
        else:
            body.append(f"Note over {actor(turn)}: {_escaped(what(turn) + place)}")
        effects = "<br/>".join(_escaped(effect) for effect in (*scheduling(turn), *details(turn)))
        if effects:
            body.append(f"Note over {actor(turn)}: {effects}")
    for wait in waits_of(story):
        place = "" if wait.origin is None else f" ({place_of(wait.origin)})"
        body.append(f"Note over {names.setdefault(wait.who, f'A{len(names)}')}: {_escaped(wait.what + place)}")
    yield "sequenceDiagram"
    yield f"    %% {heading(story).translate(_COMMENT_CODES)}"
    for name, short in names.items():
        yield f"    participant {short} as {_escaped(name)}"
    yield from (f"    {line}" for line in body)


def as_html(
    stories: Sequence[Story],
    place_of: PlaceOf,
    title: str,
    near: Mapping[str, tuple[Parting, Story]] = MappingProxyType({}),
    file_of: PlaceOf | None = None,
) -> str:
    """A self-contained HTML page. Each line of an explanation contains the place of its turn in the sources.

    Args:
        near: name of a property -> where its trace parts from one with the opposite verdict, and that trace.
        file_of: the place that is shown while the mouse is over that of `place_of`, such as one with the whole path;
            `None` to show nothing.
    """
    parts = [_section(story, place_of, file_of, near.get(story.property)) for story in stories]
    return _PAGE.format(title=html.escape(title), body="\n".join(parts))


def _section(story: Story, place_of: PlaceOf, file_of: PlaceOf | None, near: tuple[Parting, Story] | None) -> str:
    return (
        f"<h2>{html.escape(story.property)}</h2><p>{marked(story.comment)}</p>"
        f"<p><strong>{marked(cause(story, place_of, near))}</strong></p><p>{marked(heading(story))}</p>"
        f"{_table(lines(story, place_of), file_of)}"
        f"<details><summary>Mermaid</summary><pre>{html.escape(as_mermaid(story, place_of))}</pre></details>"
    )


def _table(table: Sequence[StoryLine], file_of: PlaceOf | None) -> str:
    """The lines with a column for each automaton or, if these are too many for a page, with a column of names."""
    lanes = list(dict.fromkeys(row.who for row in table if row.who))
    has_lanes = len(lanes) <= MAX_COLUMNS
    columns = ["step", "time", *(lanes if has_lanes else ("who", "what"))]
    widths = "<col class='step'><col class='time'>" + ("" if has_lanes else "<col class='who'>")
    rows = []
    for row in table:
        cell = _cell(row, file_of)
        if not row.who:  # it is about several automata
            cells = f"<td colspan='{len(columns) - 2}'>{cell}</td>"
        elif has_lanes:
            cells = "".join(f"<td class='at'>{cell}</td>" if name == row.who else "<td></td>" for name in lanes)
        else:
            cells = f"<th scope='row' class='who'>{html.escape(row.who)}</th><td>{cell}</td>"
        numbers = f"<th scope='row'>{row.step}</th><th scope='row'>{html.escape(row.time)}</th>"
        rows.append(f"<tr>{numbers}{cells}</tr>")
    head = "".join(f"<th scope='col'>{html.escape(name)}</th>" for name in columns)
    return f"<table><colgroup>{widths}</colgroup><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def _cell(row: StoryLine, file_of: PlaceOf | None) -> str:
    whole = "" if row.origin is None or file_of is None else f" title='{html.escape(file_of(row.origin))}'"
    place = f"<small{whole}>{html.escape(row.place)}</small>" if row.place else ""
    details = "".join(f"<li>{marked(detail)}</li>" for detail in row.details)
    return marked(row.what) + place + (f"<ul>{details}</ul>" if details else "")


_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 14px/1.4 system-ui, sans-serif; margin: 2em; color: #1f2328; background: #fff; }}
table {{ border-collapse: collapse; table-layout: fixed; width: 100%; overflow-wrap: anywhere; }}
.step {{ width: 4.5em; }} .time {{ width: 7em; }} .who {{ width: 16em; }}
thead th {{ position: sticky; top: 0; background: #fff; }}
th, td {{ border-right: 1px dotted #bbb; padding: .25em .7em; text-align: left; vertical-align: top; }}
tbody th {{ font-weight: normal; color: #666; }} tbody .who {{ color: inherit; }}
.at {{ background: #eef4ff; border-left: 3px solid #1f6feb; }} small {{ display: block; color: #666; }}
ul {{ margin: .2em 0 0; padding-left: 1.2em; }} pre {{ background: #f6f8fa; padding: 1em; overflow: auto; }}
@media (prefers-color-scheme: dark) {{ body, thead th {{ background: #0d1117; color: #e6edf3; }}
tbody th, small {{ color: #9aa4af; }} .at {{ background: #10243f; }} pre {{ background: #161b22; }} }}
@media (prefers-contrast: more) {{ body, thead th, .at, pre {{ background: #fff; color: #000; }}
tbody th, small {{ color: inherit; }} th, td {{ border-color: currentColor; }} .at {{ border-left: 3px solid; }} }}
@media (prefers-contrast: more) and (prefers-color-scheme: dark) {{
body, thead th, .at, pre {{ background: #000; color: #fff; }} }}
</style></head><body><h1>{title}</h1>
{body}
</body></html>
"""


def _folded(story: Story, shown_turns: Sequence[Turn]) -> list[Shown]:
    """The indices of the turns that are shown, and what is folded between them: repetitions, and the middle of a long
    explanation."""
    if story.is_whole:
        return list(range(len(shown_turns)))
    return without_middle(folded([_key(turn) for turn in shown_turns]), FIRST, LAST)


def _key(turn: Turn) -> str | None:
    """A text that is equal for turns that are the same except for numbers; `None` for the end of a trace and for what
    observers observe, which are never folded."""
    if turn.ends or turn.observed:
        return None
    texts = (_NUMBER.sub("#", text) for text in (what(turn), *scheduling(turn), *details(turn)))
    return "\n".join((turn.who, *chances(turn), *texts))


def _folded_text(shown: Repetition | LeftOut, shown_turns: Sequence[Turn]) -> str:
    first, last = shown_turns[shown.first], shown_turns[shown.last]
    if isinstance(shown, LeftOut):
        return f"… {shown.last - shown.first + 1:,} more …"
    until = "" if last.time is None else f" until {moment(last.time)}"
    if shown.lines > 1:
        return f"… the previous {shown.lines} lines {shown.times:,} more times{until} …"
    if first.is_ticked and first.status:
        return f"… {shown.times:,} more ticks{until}: {first.status} …"
    return f"… {shown.times:,} more times{until} …"


def _escaped(text: str) -> str:
    """A text without characters that have a meaning in Mermaid or HTML: Mermaid ends a line at `;`, reads `#` as the
    start of a character's number, and interprets tags."""
    return text.translate(_CODES)


_CODES = {ord(character): f"#{ord(character)};" for character in "#;:%<>&"} | dict.fromkeys(range(32), " ")
_COMMENT_CODES = {ord(character): f"#{ord(character)};" for character in "<>&"} | dict.fromkeys(range(32), " ")
