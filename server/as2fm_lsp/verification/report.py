# SPDX-License-Identifier: Apache-2.0
"""Reports of the results, for users, programs and continuous integration."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from as2fm_lsp.verification import activity_report, ends, exact_report, scheduler_report, stuck_report
from as2fm_lsp.verification.doubts import CAN_GET_STUCK, can_get_stuck, doubts
from as2fm_lsp.verification.stuck_report import PROBABILITY
from roaml.smc.choices import Choices
from roaml.smc.end import End
from roaml.smc.run import Answer, ratio_of
from roaml.verification.expectations import NO_EXPECTATION
from roaml.verification.growth import advice
from roaml.verification.refusal import Refusal
from roaml.verification.results import Result
from roaml.verification.schedulers import may_differ
from roaml.verification.stuck import Stuck, StuckLevel

if TYPE_CHECKING:
    from roaml.views.story import PlaceOf


def as_text(
    results: Sequence[Result], place_of: PlaceOf, level: StuckLevel = StuckLevel.WARNING, shown: str = ""
) -> str:
    """All results of one call, as text for users.

    Args:
        place_of: file and line of an origin.
        level: the severity with which stuck traces are reported.
        shown: where the waiting automata are shown; "" to show them below the first result that they make doubtful.
    """
    blocks = []
    shown_at: dict[object, str] = {}
    for result in results:
        where = "" if result.stuck is None else shown or shown_at.get(result.stuck.chain, "")
        blocks.append(_block(result, place_of, level, where, is_alone=False))
        if result.stuck is not None and not result.includes_stuck:
            shown_at.setdefault(result.stuck.chain, f"above, below `{result.name}`")
    open_ = [
        (result.answer.question, result.choices or Choices())
        for result in results
        if result.answer is not None
        and result.exact is None
        and may_differ(result.choices)
        and not result.answer.question.asks_for_extreme_state
    ]
    return "".join(f"{line}\n" for line in (*blocks, *_without_expectation(results), *scheduler_report.note(open_)))


def _without_expectation(results: Sequence[Result]) -> list[str]:
    """A line with the names of the properties for which nothing is expected; empty if there are none."""
    names = [result.name for result in results if result.has_no_expectation]
    return [f"{NO_EXPECTATION}: {', '.join(names)}"] if names else []


def one_as_text(result: Result, place_of: PlaceOf, level: StuckLevel = StuckLevel.WARNING, shown: str = "") -> str:
    """A single result, as text for users. See `as_text`."""
    return _block(result, place_of, level, shown, is_alone=True)


def _block(result: Result, place_of: PlaceOf, level: StuckLevel, shown: str, *, is_alone: bool) -> str:
    lines = []
    if result.refusal is not None:
        lines.append(f"{result.name}: not answered: {_refusal_text(result.refusal)}")
    if result.undecided:
        lines.append(f"{result.name}: undecided: {result.undecided}, {result.seconds:.1f} s")
    if result.exact is not None:
        name = f"{result.name} ({PROBABILITY})" if result.includes_stuck else result.name
        estimate = _estimate(result.answer) if result.answer is not None and result.has_uniform_estimate else ""
        lines += exact_report.lines(
            name, result.exact, result.seconds, only_uniform=result.is_uniform, uniform_estimate=estimate
        )
        if result.answer is not None:
            lines += _remarks(result.answer) if estimate else [f"  {line}" for line in _example_remarks(result.answer)]
            if estimate and not result.answer.is_complete:
                lines.append("  the interval is wider than requested (--epsilon)")
    for sampled in result.sampled:
        lines.append(f"{result.name}: {sampled.side} probability found {_estimate(sampled.answer)}")
        lines.append(f"  by {sampled.words}")
        if sampled.stuck is not None and not sampled.answer.question.is_stuck:
            lines += _stuck_lines(sampled.stuck, place_of, level, shown)
        lines += _remarks(sampled.answer)
    if result.tried:
        lines.append(f"  {result.tried:,} schedulers were tried, {result.seconds:.1f} s")
    if result.answer is not None and result.exact is None:
        is_stuck = result.answer.question.is_stuck
        name = f"{result.name} ({PROBABILITY})" if is_stuck else result.name
        lines.append(f"{name}: {_estimate(result.answer)}, {result.seconds:.1f} s")
        if result.stuck is not None and not is_stuck:
            lines += _stuck_lines(result.stuck, place_of, level, shown)
        lines += _remarks(result.answer)
        if is_alone or not may_differ(result.choices) or result.answer.question.asks_for_extreme_state:
            about = scheduler_report.remark(result.answer.question, result.choices)
            lines += [f"  {about}"] if about else []
        if not result.is_interrupted and not result.answer.is_complete:
            lines.append("  the interval is wider than requested (--epsilon)")
    if result.is_interrupted:
        clause = "this is the result so far" if result.answer or result.sampled else "there is no result so far"
        after = f" after {result.explored:,} states, {result.seconds:.1f} s" if result.explored else ""
        lines.append(f"  interrupted; {clause}" if lines else f"{result.name}: interrupted{after}; {clause}")
    lines += _growing_lines(result)
    lines += _doubt_lines(result, level)
    for verdict in result.verdicts:
        if result.undecided:
            lines.append(f"  expected {verdict.expectation.text}: undecided")
            continue
        doubt = verdict.doubt(result.epsilon)
        text = f"  expected {verdict.expectation.text}: {verdict.text}"
        lines.append(f"{text}; {doubt}" if doubt else text)
    if is_alone and result.has_no_expectation:
        lines.append(f"  {NO_EXPECTATION}")
    if not is_alone and result.comment and lines:
        lines.insert(1, f"  {' '.join(result.comment.split())}")
    return "\n".join(lines)


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


def _growing_lines(result: Result) -> list[str]:
    if not result.growing:
        return []
    growing = ", ".join(variable.text for variable in result.growing)
    return [f"  more and more values so far: {growing}; {advice(result.growing)}"]


def _doubt_lines(result: Result, level: StuckLevel) -> list[str]:
    lines = [f"  warning: {doubt}" for doubt in doubts(result)]
    return [*lines, f"  {level}: {CAN_GET_STUCK}"] if can_get_stuck(result) else lines


def _estimate(answer: Answer) -> str:
    tally, (lower, upper) = answer.tally, answer.bounds
    if tally.traces == 0:
        return activity_report.warning(answer) or "no result yet"
    value = "unknown" if answer.is_unknown else "infinite" if math.isinf(answer.value) else _number(answer.value)
    interval = f" in [{_number(lower)}, {_number(upper)}]"
    good, bad = ("stuck", "not stuck") if answer.question.is_stuck else ("passed", "failed")
    counts = f"{tally.traces:,} traces: {tally.successes:,} {good}, {answer.failures:,} {bad}"
    if tally.undecided:
        counts += f", {tally.undecided:,} undecided"
    return f"{value}{interval} from {counts}"


def _remarks(answer: Answer) -> list[str]:
    lines = [f"  ends: {ends.as_line(answer.tally)}"] if answer.tally.traces else []
    if answer.question.is_reward and answer.failures:
        lines.append("  infinite: some traces never reach the condition up to which the reward is accumulated")
    ratio = ratio_of(answer.question, answer.options)
    if answer.tally.accepted is not None and ratio is not None:
        low, high = max(0.0, ratio.threshold - ratio.epsilon), min(1.0, ratio.threshold + ratio.epsilon)
        lines.append(
            f"  decided by Wald's sequential test: wrong with a probability of at most {ratio.error:.6g}, unless the "
            f"value is between {low:.6g} and {high:.6g}"
        )
    if answer.is_anytime and answer.tally.traces:
        lines.append("  the interval is valid at any stopping time: it is one of a confidence sequence")
    cut = answer.tally.ended(End.CUT)
    if cut:
        steps = f"{answer.options.max_steps:,}"
        lines.append(f"  {cut:,} undecided traces were cut after {steps} steps (--max-steps); they widen the interval")
    lines += [f"  {remark}" for remark in activity_report.remarks(answer)]
    return lines


def _example_remarks(answer: Answer) -> list[str]:
    """Remarks on the traces that were generated as examples for an exact value."""
    lines = [f"ends of {answer.tally.traces:,} random traces: {ends.as_line(answer.tally)}"]
    return lines + activity_report.remarks(answer)


def _number(value: float) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return f"{value:.6g}"


def as_json(
    results: Sequence[Result],
    errors: Sequence[dict[str, Any]] = (),
    stuck: dict[str, Any] | None = None,
    tree: dict[str, Any] | None = None,
) -> str:
    """All results for programs, as JSON.

    Args:
        errors: the errors of the model because of which properties have no result.
        stuck: the result of the check whether the system gets stuck.
        tree: the measurements of a tree without a system.
    """
    value: dict[str, Any] = {"results": [row(result) for result in results]}
    if stuck is not None:
        value["stuck"] = stuck
    if tree is not None:
        value["tree"] = tree
    if errors:
        value["errors"] = list(errors)
    return json.dumps(value, indent=1, ensure_ascii=False) + "\n"


def row(result: Result) -> dict[str, Any]:
    """A result as a value for JSON."""
    values: dict[str, Any] = {"property": result.name, "seconds": round(result.seconds, 3)}
    if result.comment:
        values["comment"] = result.comment
    if result.refusal is not None:
        values["error"] = _refusal_row(result.refusal)
    if result.answer is not None:
        values.update(_answer(result.answer))
        if result.exact is not None:
            estimate = {name: values[name] for name in exact_report.ESTIMATE if name in values}
            values.update(exact_report.estimate_row(result))
            if result.has_uniform_estimate:
                values["uniform"] = estimate
        values.update(scheduler_report.rows(result.choices))
    if about := warning(result):
        values["warning"] = about
    for sampled in result.sampled:
        values[sampled.side.value] = {**_answer(sampled.answer), "scheduler": sampled.scheduler, "by": sampled.words}
    if result.tried:
        values["schedulers"] = {"wanted": "lss", "tried": result.tried}
    if result.exact is not None:
        values["exact"] = exact_report.row(result.exact)
    if result.undecided:
        values["undecided"] = result.undecided
    if result.explored:
        values["explored"] = result.explored
    if result.undecided or result.explored:
        values["growing"] = [
            {"variable": v.name, "automaton": v.automaton, "values": v.values, "least": v.least, "greatest": v.greatest}
            for v in result.growing
        ]
    values["interrupted"] = result.is_interrupted
    values["verdict"] = _verdict(result)
    values["expectations"] = [
        {
            "expected": verdict.expectation.text,
            "met": verdict.is_met,
            "certain": verdict.is_certain,
            "under_uniform_choices_only": verdict.is_uniform,
            **({"not_met": verdict.under} if verdict.under else {}),
            **({"unanimous": verdict.unanimous[0]} if verdict.unanimous is not None and verdict.is_met else {}),
        }
        for verdict in result.verdicts
    ]
    return values


def _verdict(result: Result) -> str:
    if result.refusal is not None or result.undecided:
        return "no answer"
    return NO_EXPECTATION if result.has_no_expectation else "met" if result.is_met else "not met"


def warning(result: Result) -> str:
    """The reasons why the value may differ from the requested one, or does not show how the system behaves; "" if there
    are none."""
    parts = []
    if result.stuck is not None and not result.includes_stuck:
        parts.append(result.stuck.warning)
    if result.answer is not None:
        parts.append(activity_report.warning(result.answer))
    if result.answer is not None and result.exact is None:
        parts.append(scheduler_report.warning(result.answer.question, result.choices))
    parts += doubts(result)
    if can_get_stuck(result):
        parts.append(CAN_GET_STUCK)
    return "; ".join(filter(None, parts))


def _answer(answer: Answer) -> dict[str, Any]:
    tally, (lower, upper) = answer.tally, answer.bounds
    return {
        "expected_value" if answer.question.is_reward else "probability": _finite(answer.value),
        "lower": _finite(lower),
        "upper": _finite(upper),
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


def _finite(value: float) -> float | str | None:
    """The number as a value for JSON, which has only finite numbers: `infinity` or `-infinity` as text, `None` for
    NaN."""
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "infinity" if value > 0 else "-infinity"
