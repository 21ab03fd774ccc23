# SPDX-License-Identifier: Apache-2.0
"""The answers, for people, programs and continuous integration."""

from __future__ import annotations

import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from as2fm_lsp.verification import choices, ends
from as2fm_lsp.verification.expectations import Verdict
from as2fm_lsp.verification.refusal import Refusal
from as2fm_lsp.verification.stuck import NOT_STUCK, Look, Stuck
from roaml.smc.choices import Choices
from roaml.smc.lss import Extremes
from roaml.smc.run import Answer, ratio_of

_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


@dataclass(frozen=True, slots=True)
class Exact:
    """The least and the greatest value over all schedulers, and the number of states."""

    least: float
    greatest: float
    states: int


@dataclass(frozen=True, slots=True)
class Result:
    """What came of one property.

    Attributes:
        answer: by traces; None if only exact values were asked for.
        seconds: how long it took.
        is_interrupted: whether somebody could not wait.
        choices: what is known of other schedulers than the uniform one; None if that is the one that is wanted.
        refusal: why there is no answer.
        stuck: its traces that got stuck, if any did.
    """

    name: str
    answer: Answer | None
    verdicts: tuple[Verdict, ...]
    seconds: float
    is_interrupted: bool = False
    extremes: Extremes | None = None
    stuck: Stuck | None = None
    exact: Exact | None = None
    choices: Choices | None = None
    refusal: Refusal | None = None

    @property
    def is_met(self) -> bool:
        """Whether there is an answer, and all is as expected."""
        return self.refusal is None and all(verdict.is_met for verdict in self.verdicts)


def as_text(results: Sequence[Result], note: str) -> str:
    """For people; `note` says what holds for all of them."""
    blocks = [_block(result) for result in results]
    return "".join(f"{block}\n" for block in blocks) + (f"{note}\n" if note else "")


def _block(result: Result) -> str:
    lines = []
    if result.refusal is not None:
        lines.append(f"{result.name}: not answered: {result.refusal.text}")
    if result.exact is not None:
        exact = result.exact
        both = _number(exact.least)
        if exact.least != exact.greatest:
            both = f"from {_number(exact.least)} to {_number(exact.greatest)}"
        lines.append(f"{result.name}: {both}, exactly, from {exact.states:,} states")
    if result.extremes is not None:
        for what, found, by in (
            ("least", result.extremes.least, result.extremes.least_by),
            ("greatest", result.extremes.greatest, result.extremes.greatest_by),
        ):
            lines.append(f"{result.name}: {what} probability found {_estimate(found)} by scheduler {by}")
    elif result.answer is not None:
        lines.append(f"{result.name}: {_estimate(result.answer)}, {result.seconds:.1f} s")
        lines += _remarks(result)
    for verdict in result.verdicts:
        text = f"  expected {verdict.expectation.text}: {verdict.text}"
        if not verdict.is_certain and result.answer is not None:
            text += f"; the interval reaches to the other side of {verdict.expectation.threshold.number:g}"
        lines.append(text)
    return "\n".join(lines)


def _estimate(answer: Answer) -> str:
    tally, (lower, upper) = answer.tally, answer.bounds
    if tally.traces == 0:
        return "nothing is known yet"
    what = "infinite" if math.isinf(answer.value) else _number(answer.value)
    interval = f" in [{_number(lower)}, {_number(upper)}]"
    counts = f"{tally.traces:,} traces: {tally.successes:,} passed, {answer.failures:,} failed"
    if tally.undecided:
        counts += f", {tally.undecided:,} undecided"
    return f"{what}{interval} from {counts}"


def _remarks(result: Result) -> list[str]:
    answer = result.answer
    assert answer is not None
    lines = [f"  ends: {ends.as_line(answer.tally)}"] if answer.tally.traces else []
    if answer.question.is_reward and answer.failures:
        lines.append("  infinite: some traces never reach what the reward is counted to")
    if about := choices.remark(answer.question, result.choices):
        lines.append(f"  {about}")
    ratio = ratio_of(answer.question, answer.options)
    if answer.tally.accepted is not None and ratio is not None:
        low, high = max(0.0, ratio.threshold - ratio.epsilon), min(1.0, ratio.threshold + ratio.epsilon)
        lines.append(
            f"  decided by Wald's sequential test: wrong with a probability of at most {ratio.error:.6g}, unless the "
            f"value is between {low:.6g} and {high:.6g}"
        )
    if answer.is_anytime and answer.tally.traces:
        lines.append("  the interval holds whenever one stops: it is one of a confidence sequence")
    if answer.tally.undecided:
        steps = f"{answer.options.max_steps:,}"
        lines.append(f"  undecided traces were cut after {steps} steps (--max-steps); they widen the interval")
    if result.stuck is not None and not answer.question.is_stuck:
        count = answer.tally.traces
        lines.append(f"  {result.stuck.count:,} of {count:,} traces got stuck, and say nothing about the property")
    if result.is_interrupted:
        lines.append("  interrupted; this is what was known by then")
    elif not answer.is_complete:
        lines.append("  the interval is wider than asked for (--epsilon)")
    return lines


def _number(value: float) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return f"{value:.6g}"


def as_json(
    results: Sequence[Result], errors: Sequence[dict[str, Any]] = (), stuck: dict[str, Any] | None = None
) -> str:
    """For programs; `stuck` is what is known of getting stuck."""
    value: dict[str, Any] = {"results": [row(result) for result in results]}
    if stuck is not None:
        value["stuck"] = stuck
    if errors:
        value["errors"] = list(errors)
    return json.dumps(value, indent=1, ensure_ascii=False) + "\n"


def row(result: Result) -> dict[str, Any]:
    """A result as a value for JSON."""
    found: dict[str, Any] = {"property": result.name, "seconds": round(result.seconds, 3)}
    if result.refusal is not None:
        found["error"] = result.refusal.row()
    if result.answer is not None:
        found.update(_answer(result.answer))
        found.update(choices.rows(result.choices))
        if about := choices.warning(result.answer.question, result.choices):
            found["warning"] = about
    if result.extremes is not None:
        both = result.extremes
        found["least"] = {**_answer(both.least), "scheduler": both.least_by}
        found["greatest"] = {**_answer(both.greatest), "scheduler": both.greatest_by}
    if result.exact is not None:
        exact = result.exact
        found["exact"] = {"least": _finite(exact.least), "greatest": _finite(exact.greatest), "states": exact.states}
    found["interrupted"] = result.is_interrupted
    found["expectations"] = [
        {
            "expected": verdict.expectation.text,
            "met": verdict.is_met,
            "certain": verdict.is_certain,
            "under_uniform_choices_only": verdict.is_uniform,
        }
        for verdict in result.verdicts
    ]
    return found


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
        "steps": tally.steps,
        "complete": answer.is_complete,
        "interval": answer.interval,
        "confidence": answer.options.confidence,
        "epsilon": answer.options.epsilon,
        "method": answer.options.method,
        "seed": answer.options.seed,
        "max_steps": answer.options.max_steps,
    }


def _finite(value: float) -> float | str | None:
    """JSON has no infinite numbers."""
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "infinity" if value > 0 else "-infinity"


def as_junit(results: Sequence[Result], title: str, look: Look | None = None, stuck: str = "") -> str:
    """A test for each property; it fails if an expectation is not met, and is an error if there is no answer. One more
    tells whether the system gets stuck: it fails if that is an error; `stuck` is its text."""
    errors = sum(result.refusal is not None for result in results)
    failures = sum(not result.is_met for result in results) - errors + (look is not None and not look.is_met)
    counts = {
        "tests": str(len(results) + (look is not None)),
        "failures": str(failures),
        "errors": str(errors),
    }
    suites = ET.Element("testsuites", {"name": "as2fm-lsp", **counts})
    suite = ET.SubElement(suites, "testsuite", {"name": "verify", **counts})
    for result in results:
        names = {"classname": _clean(title), "name": _clean(result.name), "time": f"{result.seconds:.3f}"}
        case = ET.SubElement(suite, "testcase", names)
        text = _clean(_block(result))
        uniform = [verdict for verdict in result.verdicts if verdict.is_uniform]
        if uniform:
            properties = ET.SubElement(case, "properties")
            for verdict in uniform:
                ET.SubElement(
                    properties, "property", {"name": f"expected {verdict.expectation.text}", "value": verdict.text}
                )
        if result.refusal is not None:
            ET.SubElement(case, "error", {"message": result.refusal.message, "type": result.refusal.code}).text = text
        elif result.is_met:
            ET.SubElement(case, "system-out").text = text
        else:
            missed = [v.expectation.text for v in result.verdicts if not v.is_met]
            ET.SubElement(case, "failure", {"message": f"expected {' and '.join(missed)}"}).text = text
    if look is not None:
        case = ET.SubElement(suite, "testcase", {"classname": _clean(title), "name": NOT_STUCK})
        told = ET.SubElement(case, "system-out") if look.is_met else ET.SubElement(case, "failure", message="stuck")
        told.text = _clean(stuck)
    ET.indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(suites, encoding="unicode") + "\n"


def _clean(text: str) -> str:
    return _FORBIDDEN.sub("\ufffd", text)
