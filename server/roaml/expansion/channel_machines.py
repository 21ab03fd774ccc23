# SPDX-License-Identifier: Apache-2.0
"""The machines that stand for channels, as HL-SCXML (docs/spec/channels.md#expansion)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from xml.sax.saxutils import quoteattr

from roaml.distributions.outcomes import decimal_text
from roaml.expansion.channels import DeclaredChannel
from roaml.expansion.values import number_text
from roaml.expr.types import Scalar, ScalarKind, Type
from roaml.record import Record

_NANOSECONDS_PER_SECOND = 10**9


class Fields(Record, frozen=True):
    """The leaf fields of a message, a request or a response: their dotted paths with their types."""

    leaves: tuple[tuple[str, Type], ...]

    def data(self, part: str) -> Iterator[str]:
        """The declarations of variables for one message."""
        for path, type_ in self.leaves:
            yield f"<data {_attributes(id=_variable(part, path), type=str(type_), expr=_default(type_))} />"

    def stored(self, part: str, source: str) -> Iterator[str]:
        """The assignments that store the message `source`, such as `_msg`, in variables."""
        for path, _ in self.leaves:
            yield _assign(_variable(part, path), f"{source}.{path}")

    def moved(self, part: str, source: str) -> Iterator[str]:
        """The assignments that copy a stored message."""
        for path, _ in self.leaves:
            yield _assign(_variable(part, path), _variable(source, path))

    def cleared(self, part: str) -> Iterator[str]:
        """The assignments after which equal queues are equal states: numbers and booleans of unused places have their
        initial values."""
        for path, type_ in self.leaves:
            if isinstance(type_, Scalar) and type_.kind is not ScalarKind.STRING:
                yield _assign(_variable(part, path), _default(type_))

    def sent(self, element: str, handle: str, part: str) -> Iterator[str]:
        """The element that sends a stored message."""
        if not self.leaves:
            yield f'<{element} name="{handle}" />'
            return
        yield f'<{element} name="{handle}">'
        yield from (f"    <field {_attributes(name=path, expr=_variable(part, path))} />" for path, _ in self.leaves)
        yield f"</{element}>"


class Way(Record, frozen=True):
    """Where a channel is: between `sent`, the name that the senders use, and `delivered`, the one of the receiver.

    Attributes:
        automaton: the name of the machine.
        type: the ROS type.
    """

    automaton: str
    sent: str
    delivered: str
    type: str


def topic_machine(channel: DeclaredChannel, way: Way, fields: Fields) -> str:
    """The queue between the publishers of a topic and one of its subscribers.

    `waiting` is the number of messages in the queue, `message_…_0` the oldest one, `steps_0` the steps of the clock
    until it has arrived. Messages arrive in their order: only the oldest one is delivered.
    """
    depth, is_late = channel.depth, bool(channel.step)
    places = range(depth)
    data = ['<data id="waiting" type="int16" expr="0" />']
    for place in places:
        if is_late:
            data.append(f'<data id="steps_{place}" type="int32" expr="0" />')
        data += fields.data(_place(place))
    content: list[str] = []
    for count in range(depth + 1):
        content += _received(channel, fields, count)
    is_due = "waiting > 0 && steps_0 == 0" if is_late else "waiting > 0"
    content += [
        f"<transition {_attributes(cond=is_due, target='open')}>",
        *_indented(fields.sent("ros_topic_publish", "delivered", _place(0))),
        *_indented(_removed(fields, depth, is_late=is_late)),
        *_indented([_assign("waiting", "waiting - 1")]),
        "</transition>",
    ]
    if is_late:
        steps = (_assign(f"steps_{place}", f"Math.max(steps_{place} - 1, 0)") for place in places)
        content += _ticked(channel, "waiting > 0", "open", steps)
    declared = [
        f"<ros_topic_subscriber {_attributes(name='sent', topic=way.sent, type=way.type)} />",
        f"<ros_topic_publisher {_attributes(name='delivered', topic=way.delivered, type=way.type)} />",
    ]
    return _machine(channel, way, "open", data, declared, {"open": content})


def _received(channel: DeclaredChannel, fields: Fields, count: int) -> Iterator[str]:
    """The handler for a message that is sent while `count` messages are in the queue."""
    yield f"<ros_topic_callback {_attributes(name='sent', cond=f'waiting == {count}')}>"
    if channel.loss > 0:
        share = "" if channel.loss == 1 else f' prob="{number_text(channel.loss, is_real=False)}"'
        yield f'    <target id="open"{share} />'
    kept = 1 - channel.loss
    delays = channel.delays if kept > 0 else ()
    is_late = bool(channel.step)
    for number, (steps, share_) in enumerate(delays):
        is_last = number == len(delays) - 1
        share = "" if is_last else f' prob="{_product(kept, share_)}"'
        yield f'    <target id="open"{share}>'
        place = min(count, channel.depth - 1)
        body: list[str] = []
        if count == channel.depth:
            body += _advanced(fields, channel.depth, is_late=is_late)
        else:
            body.append(_assign("waiting", "waiting + 1"))
        body += fields.stored(_place(place), "_msg")
        if is_late:
            body.append(_assign(f"steps_{place}", str(steps)))
        yield from _indented(_indented(body))
        yield "    </target>"
    yield "</ros_topic_callback>"


def _advanced(fields: Fields, depth: int, *, is_late: bool) -> Iterator[str]:
    """The assignments that replace the oldest message of the queue by the next one, and so on."""
    for place in range(depth - 1):
        yield from fields.moved(_place(place), _place(place + 1))
        if is_late:
            yield _assign(f"steps_{place}", f"steps_{place + 1}")


def _removed(fields: Fields, depth: int, *, is_late: bool) -> Iterator[str]:
    """The assignments that remove the oldest message from the queue."""
    yield from _advanced(fields, depth, is_late=is_late)
    yield from fields.cleared(_place(depth - 1))
    if is_late:
        yield _assign(f"steps_{depth - 1}", "0")


def service_machine(channel: DeclaredChannel, way: Way, request: Fields, response: Fields) -> str:
    """The server of the clients of a service, which asks the server of the service later."""
    data = ['<data id="steps" type="int32" expr="0" />', *request.data("request"), *response.data("response")]
    states = {
        "idle": list(_stored(channel, "handle_request", "asked", "requested", request.stored("request", "_req"))),
        "requested": [
            *_on_the_way(channel, "requested"),
            f"<transition {_attributes(cond='steps == 0', target='waiting')}>",
            *_indented(request.sent("ros_service_send_request", "forwarded", "request")),
            *_indented(request.cleared("request")),
            "</transition>",
        ],
        "waiting": list(
            _stored(channel, "handle_response", "forwarded", "responded", response.stored("response", "_res"))
        ),
        "responded": [
            *_on_the_way(channel, "responded"),
            f"<transition {_attributes(cond='steps == 0', target='idle')}>",
            *_indented(response.sent("ros_service_send_response", "asked", "response")),
            *_indented(response.cleared("response")),
            "</transition>",
        ],
    }
    declared = [
        f"<ros_service_server {_attributes(name='asked', service_name=way.sent, type=way.type)} />",
        f"<ros_service_client {_attributes(name='forwarded', service_name=way.delivered, type=way.type)} />",
    ]
    return _machine(channel, way, "idle", data, declared, states)


def _stored(channel: DeclaredChannel, handler: str, handle: str, target: str, assigned: Iterable[str]) -> Iterator[str]:
    """The handler that stores a request or response and draws its delay."""
    body = list(assigned)
    yield f'<ros_service_{handler} name="{handle}">'
    for number, (steps, share) in enumerate(channel.delays):
        is_last = number == len(channel.delays) - 1
        prob = "" if is_last else f' prob="{decimal_text(share)}"'
        yield f'    <target id="{target}"{prob}>'
        yield from _indented(_indented([*body, _assign("steps", str(steps))]))
        yield "    </target>"
    yield f"</ros_service_{handler}>"


def _on_the_way(channel: DeclaredChannel, state: str) -> Iterator[str]:
    if channel.step:
        yield from _ticked(channel, "steps > 0", state, [_assign("steps", "steps - 1")])


# ------------------------------------------------------------------------ parts


def _ticked(channel: DeclaredChannel, cond: str, target: str, body: Iterable[str]) -> Iterator[str]:
    """The handler for the steps of a delay. All channels hear of a step of the clock at the same time, before timers
    tick; the step of the clock may be shorter than that of the delay."""
    time = f"(_msg.sec * {_NANOSECONDS_PER_SECOND} + _msg.nanosec) % {channel.step} == 0"
    yield f"<ros_topic_callback {_attributes(name='clock', cond=f'{cond} && {time}', target=target)}>"
    yield from _indented(body)
    yield "</ros_topic_callback>"


def _machine(
    channel: DeclaredChannel, way: Way, initial: str, data: list[str], declared: list[str], states: dict[str, list[str]]
) -> str:
    if channel.step:
        rate = number_text(Fraction(_NANOSECONDS_PER_SECOND, channel.step), is_real=False)
        declared.append('<ros_topic_subscriber name="clock" topic="clock" type="builtin_interfaces/Time" />')
        declared.append(f'<ros_time_rate name="step" rate_hz="{rate}" />')
    lines = [
        f"<!-- The channel of the {channel.kind.value} {way.sent.replace('--', '- -')}. -->",
        f'<ascxml {_attributes(name=way.automaton)} version="1.0" initial="{initial}">',
        "    <datamodel>",
        *_indented(_indented(data)),
        "    </datamodel>",
        *_indented(declared),
    ]
    for name, content in states.items():
        lines += [f'    <state id="{name}">', *_indented(_indented(content)), "    </state>"]
    return "\n".join([*lines, "</ascxml>", ""])


def _product(kept: Fraction, share: float) -> str:
    if share == 1:
        return number_text(kept, is_real=False)
    return decimal_text(float(kept) * share)


def _place(number: int) -> str:
    return f"message_{number}"


def _variable(part: str, path: str) -> str:
    """The variable for a leaf field; `part` makes it different for each message."""
    return f"{part}__{path.replace('.', '__')}"


def _assign(location: str, expr: str) -> str:
    return f"<assign {_attributes(location=location, expr=expr)} />"


def _attributes(**values: str) -> str:
    return " ".join(f"{name}={quoteattr(value)}" for name, value in values.items())


def _indented(lines: Iterable[str]) -> Iterator[str]:
    return (f"    {line}" for line in lines)


def _default(type_: Type) -> str:
    """The initial value of a variable."""
    match type_:
        case Scalar(kind=ScalarKind.BOOL):
            return "false"
        case Scalar(kind=ScalarKind.STRING):
            return "''"
        case Scalar(kind=ScalarKind.REAL):
            return "0.0"
        case Scalar():
            return "0"
    return "[]"
