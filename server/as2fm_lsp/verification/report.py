# SPDX-License-Identifier: Apache-2.0
"""Reports of the results, for users, programs and continuous integration."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from as2fm_lsp.verification import activity_report, ends, exact_report, scheduler_report, stuck_report
from as2fm_lsp.verification.doubts import CAN_GET_STUCK, can_get_stuck, doubts
from as2fm_lsp.verification.stuck_report import PROBABILITY
from roaml.comparison import UniformPolicy
from roaml.exhaustive import assert_never
from roaml.smc.end import End
from roaml.smc.goal import UNIFORMLY, Question
from roaml.smc.lss import Side
from roaml.smc.run import Answer, ratio_of
from roaml.verification.expectations import NO_EXPECTATION
from roaml.verification.headline import NO_TRACES, UNDECIDED, estimate_text, found_text, headline, too_wide
from roaml.verification.number_text import json_number, number
from roaml.verification.refusal import Refusal
from roaml.verification.results import (
    Computed,
    CutShort,
    Estimated,
    Outcome,
    Refused,
    Result,
    RewardQuantile,
    Sampled,
    SampledResult,
    Undecided,
    UnderAssumption,
)
from roaml.verification.schedulers import is_extreme_known, may_differ
from roaml.verification.stuck import Stuck, StuckLevel

if TYPE_CHECKING:
    from roaml.verification.growth import GrowingVariable
    from roaml.views.story import PlaceOf


def as_text(
    results: Sequence[Result],
    place_of: PlaceOf,
    level: StuckLevel = StuckLevel.WARNING,
    shown: str = "",
    *,
    is_whole: bool = False,
) -> str:
    """All results of one call, as text for users.

    Args:
        place_of: file and line of an origin.
        level: the severity with which stuck traces are reported.
        shown: where the waiting automata are shown; "" to show them below the first result that they make doubtful.
        is_whole: whether lines are shown that say nothing unusual: why traces have ended, the lengths of the shortest
            traces, proofs, and that nothing is expected.
    """
    blocks = []
    shown_at: dict[object, str] = {}
    for result in results:
        where = "" if result.stuck is None else shown or shown_at.get(result.stuck.chain, "")
        blocks.append(_block(result, place_of, level, where, is_alone=False, is_whole=is_whole))
        if result.stuck is not None and not result.includes_stuck:
            shown_at.setdefault(result.stuck.chain, f"above, below `{result.name}`")
    unknown = [
        (estimated.answer.question, estimated.choices)
        for estimated in (result.outcome for result in results)
        if isinstance(estimated, Estimated)
        and estimated.choices is not None
        and (estimated.answer.tally.traces or not estimated.is_interrupted)
        and not is_extreme_known(estimated.answer.question, estimated.choices)
        and not estimated.answer.question.asks_for_extreme_state
    ]
    unexpected = _without_expectation(results) if is_whole or any(result.verdicts for result in results) else []
    opened = {r.name for r in results if r.answer is not None and activity_report.open_at_end(r.answer.tally)}
    knows_reactions = any(result.conditional for result in results)
    note = scheduler_report.note(unknown, opened=opened, knows_reactions=knows_reactions)
    return "".join(f"{line}\n" for line in (*blocks, *unexpected, *remarks_on_expectations(results), *note))


def as_brief_text(results: Sequence[Result], place_of: PlaceOf, level: StuckLevel = StuckLevel.WARNING) -> str:
    """The value, the verdicts and the warnings of each result, without remarks."""
    lines = []
    for result in results:
        first, *more = one_as_text(result, place_of, level).splitlines()
        lines += [first, *(line for line in more if line.lstrip().startswith(_ESSENTIAL))]
    return "".join(f"{line}\n" for line in lines)


_ESSENTIAL = ("expected ", "warning: ")
"""How the lines begin that `as_brief_text` keeps."""


def _without_expectation(results: Sequence[Result]) -> list[str]:
    """A line with the names of the properties for which nothing is expected; empty if there are none."""
    names = [result.name for result in results if result.has_no_expectation]
    return [f"{NO_EXPECTATION}: {', '.join(names)}"] if names else []


_FOR_ALL = {UNIFORMLY: "under all schedulers"}


def remarks_on_expectations(results: Sequence[Result]) -> list[str]:
    """A line with the number of expectations that are met only under uniform choices, unless these are accepted, and
    one with the number of those that an interval leaves undecided; empty if there are none."""
    verdicts = [(result.name, verdict) for result in results for verdict in result.verdicts]
    average: dict[str, list[str]] = {}
    for name, v in verdicts:
        if v.is_uniform and not v.is_undecided and v.policy is not UniformPolicy.ACCEPT:
            average.setdefault(v.average, []).append(name)
    lines = []
    undecided: dict[str, list[str]] = {}
    for result in results:
        names = [result.name for verdict in result.verdicts if verdict.is_undecided and not verdict.is_open]
        if names:
            undecided.setdefault(_remedy(result.answer), []).extend(names)
    for names, what in (
        *(
            (names, f"met only {of}, not known to be met {_FOR_ALL.get(of, 'in each of them')}")
            for of, names in average.items()
        ),
        *(
            (names, f"undecided, because the interval is too wide; {way} makes it narrower")
            for way, names in undecided.items()
        ),
    ):
        if names:
            of = f"{len(verdicts):,} expectation{'' if len(verdicts) == 1 else 's'}"
            verb = "is" if len(names) == 1 else "are"
            lines.append(f"{len(names):,} of {of} {verb} {what}: {', '.join(dict.fromkeys(names))}")
    return lines


def _remedy(answer: Answer | None) -> str:
    """What makes the interval of an estimate narrower, as a phrase for users. `None` for that of a sampled
    scheduler."""
    return "a higher --max-traces" if answer is not None and answer.is_ended_by_limit else "a smaller --epsilon"


def one_as_text(result: Result, place_of: PlaceOf, level: StuckLevel = StuckLevel.WARNING, shown: str = "") -> str:
    """A single result, as text for users. See `as_text`."""
    return _block(result, place_of, level, shown, is_alone=True)


def _block(
    result: Result, place_of: PlaceOf, level: StuckLevel, shown: str, *, is_alone: bool, is_whole: bool = False
) -> str:
    match result.outcome:
        case Refused(reason=refusal):
            lines = [f"{result.name}: not answered: {_refusal_text(refusal)}"]
        case Undecided(reason=reason, growing=growing):
            lines = [f"{result.name}: undecided: {reason}, {result.seconds:.1f} s", *_growing_lines(growing)]
        case CutShort(states=states, growing=growing):
            after = f" after {states:,} states, {result.seconds:.1f} s" if states else ""
            lines = [
                f"{result.name}: interrupted{after}; {_NEEDS_ALL if states else _NOTHING_SO_FAR}",
                *_growing_lines(growing),
            ]
        case Computed() as computed:
            lines = _computed_lines(result, computed, is_whole=is_whole)
        case Estimated() as estimated:
            lines = _estimated_lines(result, estimated, place_of, level, shown, is_alone=is_alone, is_whole=is_whole)
        case Sampled() as sampled:
            lines = _sampled_lines(result, sampled, place_of, level, shown, is_whole=is_whole)
        case never:
            assert_never(never)
    lines += _doubt_lines(result, level)
    lines += _conditional_lines(result)
    lines += [f"  {_quantile_text(quantile)}" for quantile in result.quantiles]
    for verdict in result.verdicts:
        if isinstance(result.outcome, Undecided):
            lines.append(f"  expected {verdict.expectation.text}: undecided")
            continue
        text = f"  expected {verdict.expectation.text}: {verdict.explained(result.epsilon)}"
        if verdict.is_met and result.answer is not None and activity_report.is_untested(result.answer):
            text += ", but nothing has tested the property"
        lines.append(text)
    if is_alone and result.has_no_expectation:
        lines.append(f"  {NO_EXPECTATION}")
    if not is_alone and result.comment and lines:
        lines.insert(1, f"  {' '.join(result.comment.split())}")
    return "\n".join(lines)


def _quantile_text(quantile: RewardQuantile) -> str:
    low, high, limit = (number(value, is_probability=False) for value in (quantile.low, quantile.high, quantile.value))
    if math.isinf(quantile.value):
        text = "no limit is known, because "
        if quantile.cut:
            those = "all" if quantile.cut == quantile.traces else f"{quantile.cut:,}"
            text += f"{those} were cut after {quantile.max_steps:,} steps"
        else:
            text += "too few reach the condition"
        if not math.isinf(quantile.low):
            text += f"; it is at least {low}"
    elif low == limit == high:
        text = f"at most {limit}"
    elif math.isinf(quantile.high):
        text = f"at most about {limit} (an estimate; the true limit is {low} or more)"
    else:
        text = f"at most about {limit} (an estimate; the true limit is from {low} to {high})"
    remark = f" ({quantile.remark})" if quantile.remark else ""
    basis = f"from {quantile.traces:,} traces with uniform choices{remark}"
    return f"{100 * quantile.share:g} % of the traces: {text}; {basis}"


def _conditional_lines(result: Result) -> list[str]:
    """The results under assumptions, each in one line, and what the assumptions exclude."""
    lines = []
    for under, text in zip(result.conditional, conditional_texts(result), strict=True):
        lines += [f"  {line}" for line in (text, under.remark) if line]
    return lines


def conditional_texts(result: Result) -> list[str]:
    """The results under assumptions, each as a phrase."""
    texts = []
    for under in result.conditional:
        match under.outcome:
            case Computed(question=question, exact=exact):
                texts.append(f"{under.assumption}: {exact_report.short(exact, question)}")
            case Estimated(answer=answer):
                texts.append(f"{under.assumption}: {_estimate(answer)}")
            case Undecided(reason=reason):
                texts.append(f"{under.assumption}: undecided: {reason}")
            case never:
                assert_never(never)
    return texts


def _heading(name: str, question: Question) -> str:
    """The name of a property, with what its value is if that is not the probability that it holds."""
    what = PROBABILITY if question.is_stuck else "expected value" if question.is_reward else ""
    return f"{name} ({what})" if what else name


_SO_FAR, _NOTHING_SO_FAR = "this is the result so far", "there is no result so far"
_NEEDS_ALL = "there is no result before all states are known"
_INFINITE = "infinite: some traces never reach the condition; `|| F …` with this condition leaves them out"


def _computed_lines(result: Result, computed: Computed, *, is_whole: bool) -> list[str]:
    sample = computed.sample
    name = _heading(result.name, computed.question)
    has_estimate = sample is not None and computed.has_uniform_estimate
    estimate = _estimate(sample.answer) if sample is not None and has_estimate else ""
    lines = exact_report.lines(
        name,
        computed.exact,
        result.seconds,
        computed.question,
        only_uniform=computed.is_uniform,
        uniform_estimate=estimate,
        is_whole=is_whole,
    )
    if computed.question.is_reward and computed.asked_value()[0].lower == math.inf:
        lines.append(f"  {_INFINITE}")
    if computed.reason:
        lines.append(f"  {computed.reason}")
    if sample is not None:
        remarks = _remarks if has_estimate else _example_remarks
        lines += remarks(sample.answer, is_whole=is_whole)
        if has_estimate and sample.answer.is_too_wide:
            lines.append(f"  {too_wide(sample.answer)}")
    return lines


def _estimated_lines(
    result: Result,
    estimated: Estimated,
    place_of: PlaceOf,
    level: StuckLevel,
    shown: str,
    *,
    is_alone: bool,
    is_whole: bool,
) -> list[str]:
    answer, choices = estimated.answer, estimated.choices
    is_stuck = answer.question.is_stuck
    name = _heading(result.name, answer.question)
    words = headline(result).text if answer.tally.traces else _estimate(answer)
    if words == NO_TRACES and estimated.is_interrupted:
        return [f"{name}: interrupted; {_NOTHING_SO_FAR}"]
    lines = [f"{name}: {words}, {result.seconds:.1f} s"]
    if estimated.stuck is not None and not is_stuck:
        lines += _stuck_lines(estimated.stuck, place_of, level, shown)
    lines += _remarks(answer, is_whole=is_whole)
    if is_alone or not may_differ(choices) or answer.question.asks_for_extreme_state:
        about = scheduler_report.below_headline(answer.question, choices)
        lines += [f"  {about}"] if about else []
    if estimated.is_interrupted:
        lines.append(f"  interrupted; {_SO_FAR if answer.tally.traces else _NOTHING_SO_FAR}")
    elif answer.is_too_wide and answer.tally.undecided < answer.tally.traces:
        lines.append(f"  {too_wide(answer)}")
    return lines


def _sampled_lines(
    result: Result, sampled: Sampled, place_of: PlaceOf, level: StuckLevel, shown: str, *, is_whole: bool
) -> list[str]:
    lines = []
    for extreme in sorted(sampled.extremes, key=_is_other_side):
        lines.append(f"{result.name}: {found_text(extreme)}")
        lines.append(f"  by {extreme.words}")
        if extreme.stuck is not None and not extreme.answer.question.is_stuck:
            lines += _stuck_lines(extreme.stuck, place_of, level, shown)
        lines += _remarks(extreme.answer, is_whole=is_whole)
    if sampled.is_interrupted:
        lines.append(f"  interrupted; {_SO_FAR}" if lines else f"{result.name}: interrupted; {_NOTHING_SO_FAR}")
    if sampled.tried:
        lines.append(f"  {sampled.tried:,} schedulers were tried, {result.seconds:.1f} s; {scheduler_report.OTHERS}")
    return lines


def _is_other_side(extreme: SampledResult) -> bool:
    """Whether the property does not ask for this extreme. Results are sorted by it, so that the asked one is first."""
    return (extreme.side is Side.LEAST) is not extreme.answer.question.is_minimised


def _refusal_text(refusal: Refusal) -> str:
    place = refusal.place
    where = "" if place is None else f"{place.path}:{place.line}:{place.column}: "
    return f"{where}{refusal.message} [{refusal.code}]"


def _refusal_row(refusal: Refusal) -> dict[str, Any]:
    place = refusal.place
    where = {} if place is None else {"file": place.path, "line": place.line, "column": place.column}
    return {**where, "code": refusal.code, "message": refusal.message}


def _stuck_lines(stuck: Stuck, place_of: PlaceOf, level: StuckLevel, shown: str) -> list[str]:
    return [f"  {line}" for line in stuck_report.stuck_lines(stuck, place_of, level, shown)]


def _growing_lines(growing: Sequence[GrowingVariable]) -> list[str]:
    if not growing:
        return []
    from roaml.verification.growth import advice  # noqa: PLC0415 - most searches end before their limits

    text = ", ".join(variable.text for variable in growing)
    return [f"  most different values so far: {text}; for fewer states, {advice(growing)}"]


def _doubt_lines(result: Result, level: StuckLevel) -> list[str]:
    lines = [f"  warning: {doubt}" for doubt in doubts(result)]
    return [*lines, f"  {level}: {CAN_GET_STUCK}"] if can_get_stuck(result) else lines


def _estimate(answer: Answer) -> str:
    return estimate_text(answer) if answer.tally.traces else activity_report.warning(answer) or NO_TRACES


def _remarks(answer: Answer, *, is_whole: bool) -> list[str]:
    are_shown = answer.tally.traces and (is_whole or not ends.are_ordinary(answer.tally))
    lines = [f"  ends: {ends.as_line(answer.tally)}"] if are_shown else []
    if answer.question.is_reward and answer.failures:
        lines.append(f"  {_INFINITE}")
    if answer.question.is_reward and answer.tally.successes and not answer.failures:
        lines.append(_reward_remark(answer))
    ratio = ratio_of(answer.question, answer.options)
    if answer.tally.accepted is not None and ratio is not None:
        low, high = max(0.0, ratio.threshold - ratio.epsilon), min(1.0, ratio.threshold + ratio.epsilon)
        lines.append(
            f"  decided by Wald's sequential test: wrong with a probability of at most {ratio.error:.6g}, unless the "
            f"value is between {low:.6g} and {high:.6g}"
        )
    if answer.is_anytime and answer.tally.traces:
        lines.append("  the interval is valid whenever the traces are stopped (a confidence sequence)")
    lines += [f"  {remark}" for remark in activity_report.remarks(answer)]
    return lines


def _reward_remark(answer: Answer) -> str:
    """What the interval of a reward assumes: the greatest possible reward is not known."""
    mean, error = answer.tally.mean, 1 - answer.options.confidence
    if mean.is_constant:
        rare = -math.expm1(math.log(error) / mean.number)
        return (
            f"  no interval: all {mean.number:,} values were {number(mean.mean, is_probability=False)}, but "
            f"another value may have a probability of up to {rare:.2g}"
        )
    least, greatest = (number(value, is_probability=False) for value in (mean.least, mean.greatest))
    return (
        f"  no guarantee: the interval is valid if all possible values are from {least} to {greatest}, as they were in "
        "these traces"
    )


def _example_remarks(answer: Answer, *, is_whole: bool) -> list[str]:
    """Remarks on the traces that were generated as examples for an exact value. Why they ended is not part of the
    answer; that some got stuck is a warning."""
    are_shown = is_whole or answer.tally.ended(End.STUCK)
    lines = [f"ends of {answer.tally.traces:,} random traces: {ends.as_line(answer.tally)}"] if are_shown else []
    return [f"  {line}" for line in (*lines, *activity_report.remarks(answer, are_examples=True))]


def as_json(
    results: Sequence[Result],
    errors: Sequence[dict[str, Any]] = (),
    stuck: dict[str, Any] | None = None,
    tree: dict[str, Any] | None = None,
    parameters: Mapping[str, str] | None = None,
    drawn: Sequence[dict[str, Any]] = (),
) -> str:
    """All results for programs, as JSON.

    Args:
        errors: the errors of the model because of which properties have no result.
        stuck: the result of the check whether the system gets stuck.
        tree: the measurements of a tree without a system.
        parameters: name of a parameter of the system -> the text of its value.
        drawn: the numbers that machines draw from distributions, as `drawn_rows` returns them.
    """
    value: dict[str, Any] = {"results": [row(result) for result in results]}
    if stuck is not None:
        value["stuck"] = stuck
    if tree is not None:
        value["tree"] = tree
    if parameters:
        value["parameters"] = dict(parameters)
    if drawn:
        value["drawn"] = list(drawn)
    if errors:
        value["errors"] = list(errors)
    import json  # noqa: PLC0415

    return json.dumps(value, indent=1, ensure_ascii=False) + "\n"


def _outcome_row(outcome: Outcome) -> dict[str, Any]:
    match outcome:
        case Refused(reason=refusal):
            return {"error": _refusal_row(refusal)}
        case Undecided(reason=reason, growing=growing):
            return {"undecided": reason, "growing": _growing_rows(growing)}
        case CutShort(states=states, growing=growing):
            return {"explored": states, "growing": _growing_rows(growing)} if states else {}
        case Estimated() as estimated:
            return _estimated_row(estimated)
        case Computed() as computed:
            values = {} if computed.sample is None else _estimated_row(computed.sample)
            estimate = {name: values[name] for name in exact_report.ESTIMATE if name in values}
            if computed.sample is not None:
                values.update(exact_report.estimate_row(computed))
                if computed.has_uniform_estimate:
                    values["uniform"] = estimate
            return {**values, "exact": exact_report.row(computed.exact)}
        case Sampled(extremes=extremes, tried=tried):
            by_side: dict[str, Any] = {
                extreme.side.value: {**_answer(extreme.answer), "scheduler": extreme.scheduler, "by": extreme.words}
                for extreme in extremes
            }
            return {**by_side, "schedulers": {"wanted": "lss", "tried": tried}} if tried else by_side
        case never:
            return assert_never(never)


def row(result: Result) -> dict[str, Any]:
    """A result as a value for JSON."""
    values: dict[str, Any] = {"property": result.name, "seconds": round(result.seconds, 3)}
    if result.comment:
        values["comment"] = result.comment
    if about := warning(result):
        values["warning"] = about
    values.update(_outcome_row(result.outcome))
    if result.conditional:
        values["conditional"] = [_conditional_row(under) for under in result.conditional]
    if result.quantiles:
        values["quantiles"] = [
            {
                "share": quantile.share,
                "value": json_number(quantile.value),
                "low": json_number(quantile.low),
                "high": json_number(quantile.high),
                "traces": quantile.traces,
            }
            for quantile in result.quantiles
        ]
    values["interrupted"] = result.is_interrupted
    values["verdict"] = _verdict(result)
    values["expectations"] = [
        {
            "expected": verdict.expectation.text,
            "met": verdict.is_met,
            "certain": verdict.is_certain,
            **({"open": True} if verdict.is_open else {}),
            "under_uniform_choices_only": verdict.is_uniform,
            **({"uniform": str(verdict.policy)} if verdict.is_uniform else {}),
            **({"not_met": missed} if (missed := ": ".join(filter(None, (verdict.under, verdict.because)))) else {}),
            **({"sampled_schedulers": verdict.sampled} if verdict.is_met and verdict.sampled else {}),
            **({"unanimous": verdict.unanimous[0]} if verdict.unanimous is not None and verdict.unanimous_text else {}),
        }
        for verdict in result.verdicts
    ]
    return values


def _conditional_row(under: UnderAssumption) -> dict[str, Any]:
    row_: dict[str, Any] = {"assumption": under.assumption, "remark": under.remark}
    match under.outcome:
        case Computed(exact=exact):
            row_["exact"] = exact_report.row(exact)
        case Estimated() as estimated:
            row_.update(_estimated_row(estimated))
        case Undecided(reason=reason):
            row_["undecided"] = reason
        case never:
            assert_never(never)
    return row_


def _estimated_row(estimated: Estimated) -> dict[str, Any]:
    return {**_answer(estimated.answer), **scheduler_report.rows(estimated.choices)}


def _growing_rows(growing: Sequence[GrowingVariable]) -> list[dict[str, Any]]:
    return [
        {"variable": v.name, "automaton": v.automaton, "values": v.values, "least": v.least, "greatest": v.greatest}
        for v in growing
    ]


def _verdict(result: Result) -> str:
    if not result.has_answer:
        return "no answer"
    if result.has_no_expectation:
        return NO_EXPECTATION
    return UNDECIDED if result.is_undecided else "met" if result.is_met else "not met"


def warning(result: Result) -> str:
    """The reasons why the value may differ from the requested one, or does not show how the system behaves; "" if there
    are none."""
    parts = []
    if result.stuck is not None and not result.includes_stuck:
        parts.append(result.stuck.warning)
    if result.answer is not None:
        parts.append(activity_report.warning(result.answer))
    if isinstance(result.outcome, Estimated):
        parts.append(scheduler_report.warning(result.outcome.answer.question, result.outcome.choices))
    parts += [
        f"expected {verdict.expectation.text}: {verdict.explained(result.epsilon)}"
        for verdict in result.verdicts
        if verdict.is_warned_about
    ]
    parts += doubts(result)
    if can_get_stuck(result):
        parts.append(CAN_GET_STUCK)
    return "; ".join(filter(None, parts))


def _answer(answer: Answer) -> dict[str, Any]:
    tally, (lower, upper) = answer.tally, answer.bounds
    return {
        "expected_value" if answer.question.is_reward else "probability": json_number(answer.value),
        "lower": json_number(lower),
        "upper": json_number(upper),
        "traces": tally.traces,
        "passed": tally.successes,
        "failed": answer.failures,
        "undecided": tally.undecided,
        "ends": ends.as_row(tally),
        **activity_report.row(answer),
        "steps": tally.steps,
        "complete": answer.is_complete,
        "interval": answer.interval,
        "confidence": answer.options.confidence,
        "epsilon": answer.options.epsilon,
        "method": answer.options.method.value,
        "seed": answer.options.seed,
        "max_steps": answer.options.max_steps,
    }
