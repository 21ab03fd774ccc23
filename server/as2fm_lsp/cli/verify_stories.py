# SPDX-License-Identifier: Apache-2.0
"""The traces of a verification: written to files, and explained."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from as2fm_lsp.cli.formats import Format
from as2fm_lsp.cli.output import complain, print_text
from as2fm_lsp.cli.story_page import story_page
from as2fm_lsp.cli.verify_report import Answered
from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, OutputFiles
from as2fm_lsp.verification.node_names import explained
from as2fm_lsp.verification.trace_files import write_traces
from roaml.smc.program import FALSE
from roaml.verification import stuck
from roaml.verification.counterexample import MAX_SEARCHED_TRACES, random_trace, unwanted_trace, unwanted_verdict
from roaml.verification.nearest import Nearest, nearest
from roaml.verification.results import Computed, Exact, Result, Sampled, Traces
from roaml.views.parting import parting_text
from roaml.views.story import as_mermaid, waits_of
from roaml.views.story import as_text as story_text

if TYPE_CHECKING:
    from roaml.smc.story import Story


class Explanations:
    """The traces that the options ask for."""

    def __init__(self, answered: Answered, outputs: OutputFiles) -> None:
        self.options = answered.options
        self.verifier = answered.verifier
        self.target = answered.target
        self.results = answered.results
        self.place = answered.place
        self.outputs = outputs
        self.partings: dict[str, Nearest] = {}

    def write(self) -> None:
        """Write the traces to files, and the explanations of traces to their outputs."""
        stories: list[Story] = []
        for result in self.results:
            if isinstance(result.outcome, Computed):
                for story in self._shortest(result, result.outcome.exact):
                    self._compare(result, story)
                    stories.append(story)
                continue
            traces = result.traces
            if result.answer is None or traces is None:
                if isinstance(result.outcome, Sampled) and (self.options.explain or self.options.traces is not None):
                    complain(f"{result.name}: traces of sampled schedulers can be neither explained nor written")
                continue
            if self.options.traces is not None:
                recorder = traces.recorder()
                folder, limit = self.options.traces, self.options.traces_limit
                write_traces(self.outputs, folder, self.target, recorder, result.answer, limit)
            if self.options.explain:
                seen = unwanted_trace(result)
                if seen is None:
                    print_text(f"{result.name}: {self._no_trace(result)}\n", stream=sys.stderr)
                else:
                    stories.append(traces.story(seen.trace))
                    self._compare(result, stories[-1])
        for file in self.options.explain:
            self._write_stories(stories, file)

    def _no_trace(self, result: Result) -> str:
        """Why no random trace is explained, and what to do if a sampled scheduler has other traces, in one sentence."""
        fails = unwanted_verdict(result) == FALSE
        traces = 0 if result.answer is None else result.answer.tally.traces
        text = f"none of the {traces:,} random traces {'failed' if fails else 'held'}"
        choices = result.choices
        other = None if choices is None else choices.minimum if fails else choices.maximum
        if choices is None or not choices.differ or other is None or not other.scheduler:
            return text
        metadata = self.target.model.metadata
        has_any_time = metadata is not None and metadata.clock is not None and metadata.reaction_time.is_any
        instead = ", or state a reaction time, as with --reaction-time instant" if has_any_time else ""
        which = "fail" if fails else "hold"
        shown = f"some of those of {other.scheduler}, {which}, but cannot be shown"
        return f"{text}; {shown}: use --exhaustive --explain{instead}"

    def _compare(self, result: Result, story: Story) -> None:
        """Keep where a trace parts from the nearest one with the opposite verdict."""
        near = nearest(result, story, self.target.clock)
        if near is not None:
            self.partings[story.property] = near

    def _shortest(self, result: Result, exact: Exact) -> Iterator[Story]:
        """The explanation of the shortest trace that contradicts an expectation. For a property about a number of
        steps, which states do not contain, it is a random one."""
        if self.options.traces is not None:
            complain(f"{result.name}: --traces writes random traces only, not those of --exhaustive")

        verdict = unwanted_verdict(result)
        trace = exact.shortest(verdict)
        if trace is not None:
            yield trace.story(self.target.clock)
        elif self.options.explain:
            verb = "fails" if verdict == FALSE else "holds"
            is_possible = exact.least < 1 if verdict == FALSE else exact.greatest > 0
            property_ = self.verifier.question(result.name)
            is_reward = property_.question.is_reward
            text = f"there is no trace in which it {verb}"
            if is_possible and property_.goal.is_bounded == 1 and not is_reward:
                traces = Traces(self.target, self.verifier.checker, property_, self.verifier.options)
                number = random_trace(traces, verdict)
                if number is not None:
                    yield traces.story(number)
                    return
                text = f"it {verb} in none of {MAX_SEARCHED_TRACES:,} random traces, and states do not count steps"
            elif is_possible and not is_reward:
                text = f"every trace in which it {verb} repeats some states for ever, so none can be shown to its end"
                if isinstance(result.outcome, Computed) and result.outcome.reason:
                    text += f"; {result.outcome.reason}"
            print_text(f"{result.name}: {text}\n", stream=sys.stderr)

    def _story_texts(self, stories: Sequence[Story]) -> str:
        """The text of all explanations. Parts that several of them share are written once."""
        texts: list[str] = []
        shown_at: dict[object, str] = {}
        for story in stories:
            chain = stuck.chain_of(waits_of(story))
            where, near = shown_at.get(chain, "") if chain else "", self.partings.get(story.property)
            if near is None:
                texts.append(story_text(story, self.place, where))
            else:
                text = story_text(story, self.place, where, (near.parting, near.story))
                texts.append(text + parting_text(near.parting, near.story, self.place))
            shown_at.setdefault(chain, f"above, at the end of the trace of `{story.property}`")
        text = "\n".join(texts)
        return text + explained(text, self.target.model, self.place)

    def _write_stories(self, stories: Sequence[Story], file: str) -> None:

        if file.endswith(".html"):
            near = {name: (near.parting, near.story) for name, near in self.partings.items()}
            text = story_page(stories, self.target, self.options.main, near)
        elif file.endswith(".mmd"):
            text = "\n".join(as_mermaid(story, self.place) for story in stories)
        else:
            text = self._story_texts(stories)
        if file == STANDARD_OUTPUT_PATH:
            # With a format for programs, standard output contains only the results.
            print_text(text, stream=sys.stdout if self.options.format is Format.TEXT else sys.stderr)
        else:
            self.outputs.write(file, text)
