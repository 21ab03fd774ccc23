# SPDX-License-Identifier: Apache-2.0
"""The results of a verification as diagnostics, for reports that show findings at lines of files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from as2fm_lsp.verification import exact_report
from as2fm_lsp.verification.report import warning
from roaml.diagnostics import Diagnostic, RelatedPlace, Severity
from roaml.smc.story import Story
from roaml.text import Location, Span
from roaml.verification.counterexample import unwanted_trace, unwanted_verdict
from roaml.verification.headline import headline
from roaml.verification.results import Computed, CutShort, Refused, Result, Undecided
from roaml.verification.target import VerificationTarget

NOT_MET, NOT_ANSWERED, DOUBTFUL = "expectation-not-met", "property-not-answered", "doubtful-value"
SUMMARIES: Mapping[str, str] = MappingProxyType(
    {
        NOT_MET: "The probability of a property is not as expected.",
        NOT_ANSWERED: "The value of a property could not be computed.",
        DOUBTFUL: "The value of a property holds only under an assumption.",
    }
)
"""The codes of these diagnostics, each with what it means."""
MAX_RELATED = 5
"""The maximum number of places before the end of a counterexample that are named."""


def diagnostics(results: Sequence[Result], target: VerificationTarget, main: str) -> Iterator[Diagnostic]:
    """A diagnostic for each property whose expectation is not met, that has no answer, or whose value has a warning.
    Refusals with a position are left out, because the caller reports them as errors in the model.

    An expectation that is not met is reported where its shortest counterexample ends; everything else, and
    expectations without a counterexample, at the beginning of `main`, the absolute path of the model.
    """
    beginning = Location(main, Span(0, 0))
    for result in results:
        match result.outcome:
            case Refused(reason=reason):
                if reason.place is None:
                    yield _diagnostic(beginning, NOT_ANSWERED, Severity.ERROR, f"`{result.name}`: {reason.message}")
                continue
            case Undecided(reason=reason):
                yield _diagnostic(beginning, NOT_ANSWERED, Severity.ERROR, f"`{result.name}`: undecided: {reason}")
                continue
            case CutShort():
                yield _diagnostic(beginning, NOT_ANSWERED, Severity.ERROR, f"`{result.name}`: interrupted")
                continue
            case _:
                pass
        missed = [verdict for verdict in result.verdicts if not verdict.is_met]
        if missed:
            story = _counterexample(result, target)
            places = [] if story is None else _places(story)
            words = "; ".join(f"expected {v.expectation.text}: {v.explained(result.epsilon)}" for v in missed)
            message = f"`{result.name}`: {value_text(result)}; {words}"
            if places:
                message += "; the shortest trace that shows it ends here"
            related = tuple(RelatedPlace(place, text) for place, text in places[-MAX_RELATED - 1 : -1])
            yield _diagnostic(places[-1][0] if places else beginning, NOT_MET, Severity.ERROR, message, related)
        if about := warning(result):
            yield _diagnostic(beginning, DOUBTFUL, Severity.WARNING, f"`{result.name}`: {about}")


def value_text(result: Result) -> str:
    """The value of a property in one line, or why there is none."""
    match result.outcome:
        case Refused():
            return "not answered"
        case Undecided():
            return "undecided"
        case CutShort():
            return "interrupted"
        case Computed(question=question, exact=exact):
            return exact_report.short(exact, question)
        case _:
            return headline(result).text


def _diagnostic(
    place: Location, code: str, severity: Severity, message: str, related: tuple[RelatedPlace, ...] = ()
) -> Diagnostic:
    return Diagnostic(place.path, code, severity, place.span, message, related=related)


def _counterexample(result: Result, target: VerificationTarget) -> Story | None:
    """The shortest trace that contradicts an expectation; `None` if none is known."""
    if isinstance(result.outcome, Computed):
        trace = result.outcome.exact.shortest(unwanted_verdict(result))
        return None if trace is None else trace.story(target.clock)
    seen, traces = unwanted_trace(result), result.traces
    return None if seen is None or traces is None else traces.story(seen.trace)


def _places(story: Story) -> list[tuple[Location, str]]:
    """The places of the turns of a trace, in their order, each with what happens there."""
    from roaml.views.story import lines  # noqa: PLC0415 - most verifications do not need a story

    return [
        (line.origin, f"{line.time}  {line.who}: {line.what}".strip())
        for line in lines(story, lambda _: "")
        if line.origin is not None
    ]
