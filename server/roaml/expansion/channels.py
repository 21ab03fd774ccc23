# SPDX-License-Identifier: Apache-2.0
"""The channels that a system file declares: the quality of service of its topics and services
(docs/spec/channels.md)."""

from __future__ import annotations

import enum
import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from roaml.distributions.laws import LawError
from roaml.expansion.draws import DrawnNumber
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expansion.uses import VARIABLE, ParameterUse, names_in
from roaml.expansion.values import Content, Scope, evaluate, number_text
from roaml.expr.parse import parse
from roaml.language import SYSTEM
from roaml.language.validate import misspelled_attribute
from roaml.model.drawn_durations import DataReader, DrawnDuration, DurationError, read_duration
from roaml.model.parameters import DEFAULT_TICK_RATE
from roaml.model.syntax import Name, name_of
from roaml.model.system_file import SystemSection
from roaml.record import Record
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean
from roaml.text import Decoded, Span
from roaml.xml_syntax import Attribute, Document, Element

CHANNEL = "channel"
"""The name of the element that declares a channel."""
DEFAULT_DEPTH = 10
"""The depth of a queue, as in the default profile of ROS 2."""
MAX_DEPTH = 100
"""The maximum depth of a queue."""
LOSS = "loss"
"""The attribute with a probability."""
_RELIABLE, _BEST_EFFORT = "reliable", "best_effort"
_NANOSECONDS_PER_MILLISECOND = 10**6
_PART = regex(r"""'[^']*'|"[^"]*"|(?<=\))\s*\*|[^(),'"]+""")
"""A part of a delay: the name of a distribution, an argument, the name of a file in quotes, or what a distribution of
numbers is multiplied by, and the sign before it."""
_UNIT = regex(r"\s*\b(?:ms|s|min)\s*\Z")


class ChannelKind(enum.Enum):
    """What a channel transports. The value is the name of the attribute that names it."""

    TOPIC = "topic"
    SERVICE = "service"


class DeclaredChannel(Record, frozen=True, eq=False):
    """A `<channel>` that names a topic or service.

    Attributes:
        name: the name of the topic or service.
        depth: the number of messages in a queue at most.
        loss: the probability that a message is lost.
        delays: the numbers of steps that a message is on its way, with their probabilities; (0, 1) without a delay.
        step: the length of a step, in ns; 0 without a delay.
        values: the attributes whose values the machines of the channel contain, with their values.
        drawn: how the delay is discretised; `None` if it is not drawn.
        is_valid: whether all attributes are valid. Otherwise defaults replace the invalid ones, so that properties can
            still name what the receivers get.
    """

    element: Element
    kind: ChannelKind
    name: Name
    depth: int
    loss: Fraction
    delays: tuple[tuple[int, float], ...]
    step: int
    values: tuple[tuple[Attribute, str], ...]
    drawn: DrawnNumber | None
    is_valid: bool

    @property
    def key(self) -> tuple[ChannelKind, str]:
        """What identifies the topic or service."""
        return self.kind, interface_key(self.kind, self.name.value)


def interface_key(kind: ChannelKind, name: str) -> str:
    """What two names of the same topic or service have in common (docs/spec/ros.md#topics)."""
    return name.removeprefix("/") if kind is ChannelKind.TOPIC else name


def read_channels(
    path: str,
    document: Document,
    sections: Iterable[Element],
    scope: Scope,
    periods: Sequence[Fraction],
    problems: Problems,
    read: DataReader,
) -> tuple[DeclaredChannel, ...]:
    """The channels of a system file, one for each topic and service.

    Args:
        path: the path of the system file.
        sections: its elements `<channels>`.
        scope: the parameters of the system.
        periods: the times between the ticks of its timers and trees, in ms. Default steps divide them.
        problems: receives what is wrong with them.
        read: reads the data of delays.
    """
    channels: dict[tuple[ChannelKind, str], DeclaredChannel] = {}
    for element in (child for section in sections for child in section.elements if child.name == CHANNEL):
        channel = _Reader(path, document, element, scope, periods, problems, read).channel()
        if channel is None:
            continue
        if channel.key in channels:
            first = channels[channel.key].name.span
            message = (
                f"the {channel.kind.value} `{channel.name.value}` has two channels; remove one of the declarations"
            )
            problems.add(
                ExpansionProblem.CHANNEL, channel.name.span, message, related=((first, "first declared here"),)
            )
            continue
        channels[channel.key] = channel
    return tuple(channels.values())


def tick_periods(document: Document, machines: Iterable[Document], scope: Scope) -> tuple[Fraction, ...]:
    """The times between the ticks of the timers and trees of a system in ms, without those that are no whole number of
    nanoseconds, which no step of a channel divides.

    Args:
        document: the system file.
        machines: its machines, expanded.
    """
    elements = [e for d in (document, *machines) if d.root is not None for e in d.root.walk()]
    rates = {a.value for e in elements for n in ("rate_hz", "tick_rate") if (a := e.get(n)) is not None}
    ticked = [element for element in elements if element.name == "bt_tick_rate"]
    rates |= {a.value for element in ticked if (a := element.get("value")) is not None}
    if not ticked and any(element.name == SystemSection.BEHAVIOR_TREE.value for element in elements):
        rates.add(str(DEFAULT_TICK_RATE))
    text = (VARIABLE.sub(lambda m: scope[m[1]].text if m[1] in scope else m[0], rate) for rate in sorted(rates))
    values = (evaluate(parse(Decoded(rate.strip(), 0))[0], scope) for rate in text)
    periods = (1000 / value for value in values if isinstance(value, Fraction) and value > 0)
    return tuple(period for period in periods if (period * _NANOSECONDS_PER_MILLISECOND).denominator == 1)


def delay_uses(document: Document, element: Element, scope: Scope) -> Iterator[ParameterUse]:
    """The uses of parameters in the times of a channel, without those of the form `$(var NAME)`."""
    for attribute in (element.get("delay"), element.get("step")):
        if attribute is None or "$(var" in attribute.value:
            continue
        decoded = document.decoded(attribute.value_span)
        for start, end in _numbers(decoded.text):
            tree, _ = parse(decoded.part(start, end))
            yield from (ParameterUse(n.name, n.span) for n in names_in(tree) if n.name in scope)


def _numbers(text: str) -> Iterator[tuple[int, int]]:
    """The places of the parts of a delay that can be numbers, without their units."""
    for match in _PART.finditer(text):
        if match[0].strip()[:1] in ("'", '"', "*", ""):
            continue
        unit = _UNIT.search(match[0])
        number = match[0][: unit.start()] if unit else match[0].rstrip()
        yield match.start() + len(number) - len(number.lstrip()), match.start() + len(number)


class _Reader:
    def __init__(
        self,
        path: str,
        document: Document,
        element: Element,
        scope: Scope,
        periods: Sequence[Fraction],
        problems: Problems,
        read: DataReader,
    ) -> None:
        self._path = path
        self._document = document
        self._element = element
        self._scope = scope
        self._periods = periods
        self._problems = problems
        self._read = read
        self._values: list[tuple[Attribute, str]] = []
        self._is_valid = True

    def _wrong(self, span: Span, message: str, close: tuple[str, ...] = ()) -> None:
        self._is_valid = False
        self._problems.add(ExpansionProblem.CHANNEL, span, message, close=close)

    def _not(self, attribute: Attribute, what: str) -> None:
        """Report a value that is not `what`, and may be a misspelled parameter."""
        close = close_names(attribute.value, self._scope, 1) if attribute.value.isidentifier() else ()
        close = tuple(name for name in close if name != attribute.value)
        self._wrong(attribute.value_span, f"`{attribute.value}` is not {what}{did_you_mean(close)}", close)

    def channel(self) -> DeclaredChannel | None:
        element = self._element
        kinds = [kind for kind in ChannelKind if element.get(kind.value) is not None]
        name = name_of(element.get(kinds[0].value)) if len(kinds) == 1 else None
        if name is None:
            known = SYSTEM.elements[CHANNEL].attributes
            if kinds or not any(misspelled_attribute(element, kind.value, known) for kind in ChannelKind):
                message = "a channel needs the name of either a `topic` or a `service`; write one of the two"
                self._wrong(element.name_span, message)
            return None
        kind = kinds[0]
        if kind is ChannelKind.SERVICE:
            self._refuse_losses()
            loss, depth = Fraction(0), 1
        else:
            loss, depth = self._loss(), self._depth()
        self._reliability(loss)
        delay = self._delay()
        step = self._step(delay)
        delays, drawn = self._delays(delay, step)
        nanoseconds = int(step * _NANOSECONDS_PER_MILLISECOND)
        values = tuple(self._values)
        return DeclaredChannel(element, kind, name, depth, loss, delays, nanoseconds, values, drawn, self._is_valid)

    # ------------------------------------------------------------------ values

    def _text(self, attribute: Attribute) -> str:
        """The value of an attribute, in which `$(var NAME)` is replaced."""
        scope = self._scope
        return VARIABLE.sub(lambda m: scope[m[1]].text if m[1] in scope else m[0], attribute.value).strip()

    def _evaluated(self, text: str) -> Content | None:
        tree, findings = parse(Decoded(text, 0))
        return None if findings else evaluate(tree, self._scope)

    def _refuse_losses(self) -> None:
        """Report what a channel of a service cannot have."""
        for name, reason in (
            (LOSS, "a request that is lost would never be answered, and HL-SCXML has no timeout for it"),
            ("depth", "a service handles one request at a time, and the others wait"),
        ):
            attribute = self._element.get(name)
            if attribute is not None:
                self._wrong(
                    attribute.name_span,
                    f"the channel of a service has no `{name}`: {reason}; remove the attribute, or describe "
                    "retransmissions with `delay`",
                )

    def _loss(self) -> Fraction:
        attribute = self._element.get(LOSS)
        if attribute is None:
            return Fraction(0)
        value = self._evaluated(self._text(attribute))
        if not isinstance(value, Fraction) or not 0 <= value <= 1:
            self._not(attribute, "a probability from 0 to 1, as `loss` needs")
            return Fraction(0)
        self._values.append((attribute, number_text(value, is_real=False)))
        return value

    def _depth(self) -> int:
        attribute = self._element.get("depth")
        if attribute is None:
            return DEFAULT_DEPTH
        value = self._evaluated(self._text(attribute))
        if not isinstance(value, Fraction) or value.denominator != 1 or not 1 <= value <= MAX_DEPTH:
            self._not(attribute, f"a depth, an integer from 1 to {MAX_DEPTH}")
            return DEFAULT_DEPTH
        self._values.append((attribute, str(value)))
        return int(value)

    def _reliability(self, loss: Fraction) -> None:
        attribute = self._element.get("reliability")
        if attribute is None:
            return
        text, known = self._text(attribute), (_RELIABLE, _BEST_EFFORT)
        if text not in known:
            close = close_names(text, known, 1)
            hint = did_you_mean(close) if close else f"; write `{_RELIABLE}` or `{_BEST_EFFORT}`"
            self._wrong(attribute.value_span, f"there is no reliability `{attribute.value}`{hint}", tuple(close))
        elif text == _RELIABLE and loss > 0:
            self._wrong(
                attribute.value_span,
                f"a reliable channel loses no messages, but this one has a `loss` above 0; write `{_BEST_EFFORT}`, or "
                "describe retransmissions with `delay`",
            )
        elif text == _BEST_EFFORT and self._element.get(ChannelKind.SERVICE.value) is not None:
            self._wrong(
                attribute.value_span,
                f"the channel of a service is `{_RELIABLE}`: HL-SCXML has no timeout for a response that does not "
                "arrive; remove the attribute",
            )

    # ------------------------------------------------------------------ delays

    def _time(self, attribute: Attribute) -> Fraction | DrawnDuration | None:
        """The duration in an attribute, in ms or as a distribution; `None` if it is not valid."""
        text = self._text(attribute)
        for start, end in reversed(list(_numbers(text))):
            value = self._evaluated(text[start:end])
            if isinstance(value, Fraction):
                text = text[:start] + number_text(value, is_real=False) + text[end:]
        try:
            duration = read_duration(text, f" in `{attribute.name}`")
            if isinstance(duration, DrawnDuration):
                duration = duration.with_data(self._read)
        except DurationError as error:
            self._wrong(attribute.value_span, str(error))
            return None
        self._values.append((attribute, text))
        return duration

    def _delay(self) -> Fraction | DrawnDuration:
        attribute = self._element.get("delay")
        return (self._time(attribute) if attribute is not None else None) or Fraction(0)

    def _step(self, delay: Fraction | DrawnDuration) -> Fraction:
        """The step of the delay in ms; 0 without a delay."""
        attribute = self._element.get("step")
        if attribute is not None:
            step = self._time(attribute)
            if step is None:
                return Fraction(0)
            if not isinstance(step, Fraction) or step <= 0 or (step * _NANOSECONDS_PER_MILLISECOND).denominator != 1:
                self._wrong(
                    attribute.value_span,
                    f"`{attribute.value}` is not a step: a duration above 0 and a whole number of ns, such as `10 ms`",
                )
                return Fraction(0)
            if self._element.get("delay") is None:
                self._wrong(attribute.name_span, "`step` has an effect only on a `delay`; remove it, or add a `delay`")
            return step if delay else Fraction(0)
        if isinstance(delay, Fraction):
            return _common_divisor([delay, *self._periods]) if delay else delay
        if delay.is_continuous:
            place = self._element.get("delay")
            assert place is not None
            self._wrong(
                place.value_span,
                f"`{delay.name}` has any number of different delays; add the step to which they are rounded up, such "
                'as `step="10 ms"`',
            )
            return Fraction(0)
        times = [value for value in delay.parts if value > 0]
        return _common_divisor([*times, *self._periods]) if times else Fraction(0)

    def _delays(
        self, delay: Fraction | DrawnDuration, step: Fraction
    ) -> tuple[tuple[tuple[int, float], ...], DrawnNumber | None]:
        if not step:
            return ((0, 1.0),), None
        if isinstance(delay, Fraction):
            return ((math.ceil(delay / step), 1.0),), None
        attribute = self._element.get("delay")
        assert attribute is not None
        try:
            ticks = delay.ticks(step)
        except LawError as error:
            self._wrong(attribute.value_span, f"`{delay.text}` cannot be a delay: {error}; use a greater `step`")
            return ((0, 1.0),), None
        shift = step if delay.is_continuous else Fraction(0)
        drawn = DrawnNumber(
            self._path, attribute.value_span, delay.text, len(ticks.values), shift, ticks.cut, unit="ms"
        )
        pairs = zip(ticks.values, ticks.probabilities, strict=True)
        return tuple((int(value), share) for value, share in pairs), drawn


def _common_divisor(numbers: list[Fraction]) -> Fraction:
    """The greatest number of which all `numbers` are multiples; 0 if there are none."""
    denominator = math.lcm(*(number.denominator for number in numbers))
    return Fraction(math.gcd(*(int(number * denominator) for number in numbers)), denominator)
