# SPDX-License-Identifier: Apache-2.0
"""A story of a trace for people: text, a Mermaid sequence diagram, a page that needs nothing else."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from roaml.jani.node import Origin
from roaml.smc.record import VERDICTS, Change, Part, Plain, TraceStep
from roaml.smc.story import Story

SEND, RECEIVE = "_on_send", "_on_receive"
"""How translated systems call the two halves of an event; between them it waits in an automaton of its name."""
LONGEST = 60

PlaceOf = Callable[[Origin], str]
"""File and line of an origin, as people read it."""


class Line(NamedTuple):
    """What one automaton did in a step."""

    step: int
    time: str
    automaton: str
    what: str
    place: str
    changes: tuple[str, ...]


def lines(story: Story, place_of: PlaceOf) -> list[Line]:
    """The story as a table; an automaton that only holds an event is left out where others take part."""
    found = []
    for step, time in zip(story.steps, story.clock, strict=True):
        changes = tuple(_change(change) for change in step.changes)
        actors = _actors(step)
        for part in actors:
            origin = part.edge.origin
            place = "" if origin is None else place_of(origin)
            shown = changes if part is actors[-1] else ()
            moment = "" if time is None else f"{time:.3f} s"
            found.append(Line(step.number, moment, part.automaton, _what(step, part), place, shown))
        if not actors:
            found.append(Line(step.number, "" if time is None else f"{time:.3f} s", "", _name(step), "", changes))
    return found


def as_text(story: Story, place_of: PlaceOf) -> str:
    """For a terminal."""
    table = lines(story, place_of)
    widths = [max((len(str(row[i])) for row in table), default=0) for i in range(4)]
    text = f"{heading(story)}\n"
    for row in table:
        cells = (f"{row.step:>{widths[0]}}", row.time.rjust(widths[1]), row.automaton.ljust(widths[2]))
        text += "  " + "  ".join((*cells, row.what.ljust(widths[3]), row.place)).rstrip() + "\n"
        margin = " " * (widths[0] + widths[1] + widths[2] + 8)
        text += "".join(f"{margin}{change}\n" for change in row.changes)
    return text


def heading(story: Story) -> str:
    """What happens in one sentence."""
    verdict = VERDICTS.get(story.recording.verdict, "went wrong")
    steps = f"{story.length:,} {'step' if story.length == 1 else 'steps'}"
    text = f"{story.property} {verdict} in trace {story.recording.trace} after {steps}"
    text += f", of which {len(story.steps) + story.folded:,} matter"
    if story.folded:
        text += f"; the last {len(story.steps)} of these"
    return text + (f" (it reads {', '.join(story.variables)})" if story.variables else "")


def as_mermaid(story: Story, place_of: PlaceOf) -> str:
    """A sequence diagram. An event is an arrow from who sent it to who received it, drawn when it arrives."""
    return "\n".join(_mermaid(story, place_of)) + "\n"


def _mermaid(story: Story, place_of: PlaceOf) -> Iterator[str]:
    names: dict[str, str] = {}
    body: list[str] = []
    senders: dict[str, str] = {}
    moment: float | None = None

    def actor(name: str) -> str:
        return names.setdefault(name, f"A{len(names)}")

    for step, time in zip(story.steps, story.clock, strict=True):
        actors, event = _actors(step), _event(step)
        if time is not None and time != moment and actors:
            moment = time
            body.append(f"Note over {actor(actors[0].automaton)}: {time:.3f} s")
        changes = "<br/>".join(_escaped(_change(change)) for change in step.changes)
        if event and (step.action or "").endswith(SEND) and actors:
            senders[event] = actors[0].automaton
            if changes:
                body.append(f"Note over {actor(actors[0].automaton)}: sends {_escaped(event)}<br/>{changes}")
            continue
        for part in actors:
            place = "" if part.edge.origin is None else f" ({_escaped(place_of(part.edge.origin))})"
            if event in senders and part.automaton != senders[event]:
                text = f"{_escaped(event)}{place}"
                body.append(f"{actor(senders[event])}->>{actor(part.automaton)}: {text}")
            else:
                text = f"{_escaped(_what(step, part))}{place}"
                body.append(f"Note over {actor(part.automaton)}: {text}")
        if changes and actors:
            body.append(f"Note over {actor(actors[-1].automaton)}: {changes}")
    yield "sequenceDiagram"
    yield f"    %% {heading(story)}"
    for name, short in names.items():
        yield f"    participant {short} as {_escaped(name)}"
    yield from (f"    {line}" for line in body)


def as_html(stories: Sequence[Story], place_of: PlaceOf, title: str) -> str:
    """A page that needs no network; each line tells its place."""
    parts = [_section(story, place_of) for story in stories]
    return _PAGE.format(title=html.escape(title), body="\n".join(parts))


def _section(story: Story, place_of: PlaceOf) -> str:
    table = lines(story, place_of)
    lanes = list(dict.fromkeys(row.automaton for row in table if row.automaton))
    head = "".join(f"<th>{html.escape(name)}</th>" for name in lanes)
    rows = []
    for row in table:
        cells = []
        for name in lanes:
            if name == row.automaton:
                place = f"<small>{html.escape(row.place)}</small>"
                changes = "".join(f"<li>{html.escape(change)}</li>" for change in row.changes)
                cells.append(f"<td class='at'>{html.escape(row.what)}{place}<ul>{changes}</ul></td>")
            else:
                cells.append("<td></td>")
        rows.append(f"<tr><th>{row.step}</th><th>{html.escape(row.time)}</th>{''.join(cells)}</tr>")
    return (
        f"<h2>{html.escape(story.property)}</h2><p>{html.escape(heading(story))}</p>"
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


def _actors(step: TraceStep) -> list[Part]:
    """Who does something: not the automaton that only holds the event."""
    event = _event(step)
    others = [part for part in step.parts if part.automaton != event]
    return others or list(step.parts)


def _event(step: TraceStep) -> str:
    """The event that a step sends or delivers; "" if none."""
    for ending in (SEND, RECEIVE):
        if step.action is not None and step.action.endswith(ending):
            return step.action[: -len(ending)]
    return ""


def _name(step: TraceStep) -> str:
    return "silently" if step.action is None else step.action


def _what(step: TraceStep, part: Part) -> str:
    move = part.source if part.source == part.destination.location else f"{part.source} → {part.destination.location}"
    event, action = _event(step), step.action or ""
    if event:
        return f"{'sends' if action.endswith(SEND) else 'receives'} {_short(event)} in {_short(move)}"
    return _short(move)


def _change(change: Change) -> str:
    return f"{change.variable.name}: {_shown(change.before, change.after)}"


def _shown(before: Plain, after: Plain) -> str:
    if isinstance(before, list) and isinstance(after, list):
        return f"→ {_short(_plain(after))}"
    return f"{_plain(before)} → {_plain(after)}"


def _plain(value: Plain) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case list():
            return f"[{', '.join(map(_plain, value))}]"
        case float():
            return f"{value:g}"
        case _:
            return str(value)


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _escaped(text: str) -> str:
    """Mermaid ends a line at `;` and takes `#` for the start of a character's number."""
    return text.replace("#", "#35;").replace(";", "#59;").replace("%%", "%").replace(":", "#58;")
