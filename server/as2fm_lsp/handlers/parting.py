# SPDX-License-Identifier: Apache-2.0
"""`as2fm/parting`: where a counterexample or a witness parts from the nearest trace with the opposite verdict."""

from __future__ import annotations

from functools import partial
from typing import Any

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri, string
from as2fm_lsp.handlers.results import CurrentResults, line_row, place_in_words
from as2fm_lsp.verification import background
from as2fm_lsp.verification.known_results import KnownResult
from roaml.smc.tally import StoredTrace
from roaml.verification.counterexample import unwanted_trace, witness_trace
from roaml.verification.nearest import Nearest, nearest
from roaml.verification.results import Traces
from roaml.views.parting import alignment, parting_heading
from roaml.views.story import turn_line
from roaml.views.turns import Turn

PARTING = "as2fm/parting"

Json = dict[str, Any]


def register(context: Context) -> None:
    session = context.session

    @context.feature(PARTING)
    async def parting(params: Any) -> Json | None:
        """The first difference between the trace that `as2fm/counterexample` shows for the same parameters and the
        nearest one with the opposite verdict: `heading` is what both have in common. `here` and `there` are the turns
        of the automaton that differ, like the steps of `as2fm/counterexample`; `there` is `null` if the automaton takes
        no further turn. `trace` is the number of the other trace, `null` if it has none, and `seed` that of both.
        `alignment` says which steps of both belong together, and after how many steps each one ends. `null` if there
        is no other trace, or no difference."""
        path = session.convert.path(document_uri(params))
        known = CurrentResults(context, session.moment().snapshot(path), path).get(string(params, "property"))
        if known is None or known.result.traces is None:
            return None
        traces = known.result.traces
        is_witness = getattr(params, "witness", False) is True
        seen = witness_trace(known.result) if is_witness else unwanted_trace(known.result)
        if seen is None:
            return None
        found = await background.in_thread(partial(_nearest, known, traces, seen), context.requests.checkpoint)
        if found is None:
            return None
        near, aligned = found

        def row(turn: Turn) -> Json:
            return line_row(context, known, path, turn_line(turn, partial(place_in_words, traces.target)))

        here, there = near.parting.here, near.parting.there
        trace = near.story.recording.trace
        return {
            "heading": parting_heading(near.parting, near.story),
            "here": row(here),
            "there": None if there is None else row(there),
            "seed": traces.options.seed,
            "trace": trace if trace >= 0 else None,
            "alignment": aligned,
        }


def _nearest(known: KnownResult, traces: Traces, seen: StoredTrace, _: object) -> tuple[Nearest, Json] | None:
    story = traces.story(seen.trace)
    near = nearest(known.result, story, traces.target.clock)
    if near is None:
        return None
    aligned = alignment(story, near.story, near.parting)
    return near, {
        "pairs": aligned.pairs,
        "here": {"step": aligned.here, "time": aligned.here_time, "end": len(story.steps)},
        "there": {"step": aligned.there, "time": aligned.there_time, "end": len(near.story.steps)},
    }
