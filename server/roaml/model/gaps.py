# SPDX-License-Identifier: Apache-2.0
"""The facts that the unreadable parts of a machine may contribute to the system.

- A gap is one possible fact, by kind and name: the misspelled `<ros_topic_publsher topic="/level">` may publish on
  `/level`, but it cannot provide a service. An element that is similar to no element of the language causes no gap.
- A rule that needs a fact about the system, such as a publisher of a topic or a sender of an event, reports nothing if
  a gap may provide this fact, because the unreadable part is reported already. All other errors are reported.
- Gaps contain no positions, so they are parts of outlines. `machine_gaps` returns them with their positions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TypeAlias

from roaml.exhaustive import Vocabulary
from roaml.expr.types import UNKNOWN
from roaml.language import HL_SCXML, ElementType
from roaml.language.validate import misfits
from roaml.model.build_machine import INTERFACE_ATTRIBUTES
from roaml.model.machine import Declaration, Handler, Machine, RosSend, Send, SetOutput
from roaml.model.spelling import meant
from roaml.model.syntax import Expression, Name, PortRead, name_of, port_read
from roaml.model.value_types import INTERFACE_KINDS, TypedMachine, ValueUse, find_handle
from roaml.record import Record, replace
from roaml.roles import ProtocolPart, SymbolKind
from roaml.suggest import close_names
from roaml.text import Span
from roaml.xml_syntax import Element


class GapAct(Vocabulary):
    """What an unreadable part may do or be, without using a ROS interface."""

    ANYTHING = "anything"
    SENDS = "event-sender"
    RECEIVES = "event-receiver"
    PARAMETER = "event-sender parameter"
    """Sets a parameter of an event that it sends."""
    PORT = "port"
    VARIABLE = "variable"
    """Reads or writes a variable of the blackboard."""
    REMAP = "remap"
    """Passes a variable to a subtree, by its inner or outer name."""
    NODE = "node"
    """Is a node of the tree."""
    PLUGIN = "plugin"
    """Is the plugin of a node."""
    TREE = "tree"
    """Handles ticks and halts, or answers them."""
    NAME = "name"
    """Is the name of the machine."""


class InterfaceAct(Record, frozen=True):
    """An act of an unreadable part that uses a ROS interface.

    Attributes:
        part: the part that is sent or handled; `None` if the act may also be a declaration of the interface.
        is_of_field: whether the act only reads or sets a field of `part`.
    """

    kind: SymbolKind
    part: ProtocolPart | None = None
    is_of_field: bool = False


Act: TypeAlias = GapAct | InterfaceAct


class Gap(Record, frozen=True):
    """A fact that an unreadable part of a file may contain.

    Attributes:
        act: what the part may do.
        name: the name of the topic, service or action (as written), of the event or of the port; `None` if any name is
            possible.
        port: the port whose value is the name; "" if there is none.
    """

    act: Act
    name: str | None = None
    port: str = ""


def answers(act: Act, missing: Act) -> bool:
    """Whether a part that may do `act` may also do `missing`: a machine that may declare a publisher may also
    publish."""
    if act is GapAct.ANYTHING or act == missing:
        return True
    if isinstance(act, GapAct) or isinstance(missing, GapAct):
        return act is GapAct.SENDS and missing is GapAct.PARAMETER
    return act.kind is missing.kind and (act.part is None or act == replace(missing, is_of_field=False))


class PlacedGap(Record, frozen=True):
    gap: Gap
    span: Span


def machine_gaps(
    machine: Machine,
    typed: TypedMachine,
    has_type: Callable[[str, str], bool],
) -> tuple[PlacedGap, ...]:
    """The gaps of a machine with the positions of their causes, in no particular order.

    Args:
        has_type: whether there is a ROS type, given its kind (msg, srv or action) and its name as written.
    """
    return tuple(_Search(machine, typed, has_type).all())


class _Search:
    def __init__(
        self,
        machine: Machine,
        typed: TypedMachine,
        has_type: Callable[[str, str], bool],
    ) -> None:
        self.machine = machine
        self.typed = typed
        self.has_type = has_type
        self.misfits = list(misfits(machine.element, HL_SCXML))
        self.hidden = {
            (kind, attribute.value.strip())
            for misfit in self.misfits
            for kind in (self._kind_of(misfit.element, misfit.parent_type),)
            for attribute in misfit.element.attributes
            if kind
        }
        """The declarations that cannot be read: their kind, with each attribute value that may be the handle."""

    def all(self) -> Iterator[PlacedGap]:
        for misfit in self.misfits:
            span = misfit.element.name_span
            yield from (PlacedGap(gap, span) for gap in self._unread(misfit.element, misfit.parent_type))
            yield from (PlacedGap(gap, span) for gap in self._facts_of_child(misfit.element, misfit.parent))
        if self.machine.name is None:
            yield PlacedGap(Gap(GapAct.NAME), self.machine.element.name_span)
        for declaration in self.machine.declarations:
            yield from self._declaration(declaration)
        yield from self._statements()
        yield from self._handlers()
        yield from self._ports()

    # ---------------------------------------------------- elements out of place

    def _kind_of(self, element: Element, parent: ElementType) -> SymbolKind | None:
        """The kind of ROS interface that a misplaced or unknown element probably declares; `None` if it declares
        none."""
        type_ = HL_SCXML.find(element.name)
        types = [type_] if type_ is not None else self._resembling(element, parent)
        return next((kind for type_ in types if (kind := _kind(type_))), None)

    def _unread(self, top: Element, parent: ElementType) -> Iterator[Gap]:
        """The facts that a misplaced or unknown element and its content may contain."""
        stack: list[tuple[Element, ElementType | None]] = [(top, parent)]
        while stack:
            element, outer = stack.pop()
            type_ = HL_SCXML.find(element.name)
            types = [type_] if type_ is not None else self._resembling(element, outer)
            for candidate in types:
                yield from self._facts_as(element, candidate)
            stack += [(child, types[0] if types else None) for child in element.elements]

    def _resembling(self, element: Element, parent: ElementType | None) -> list[ElementType]:
        """The possible types of an unknown element: the type with the most similar name; if there is none, the types
        allowed in `parent` that have its attributes."""
        allowed = list(parent.children) if parent is not None else []
        close = close_names(element.name, allowed, 1) or close_names(element.name, HL_SCXML.elements, 1)
        if close:
            nearest = HL_SCXML.find(close[0])
            return [nearest] if nearest is not None else []
        names = {attribute.name for attribute in element.attributes}
        types = [t for name in allowed if (t := HL_SCXML.find(name)) is not None]
        return [t for t in types if any(self._gives_name(t, name, element) for name in names)]

    def _gives_name(self, type_: ElementType, attribute: str, element: Element) -> bool:
        """Whether an attribute of an element of this type names a topic, service, action, event or port, or a
        declaration that exists."""
        known = type_.attributes.get(attribute)
        if known is None:
            return False
        if attribute in (*INTERFACE_ATTRIBUTES, "event", "key"):
            return True
        handle = name_of(element.get(attribute))
        kinds = {d.kind for d in self.machine.declarations if handle and d.handle and d.handle.value == handle.value}
        return not kinds.isdisjoint(known.refers)

    def _facts_as(self, element: Element, type_: ElementType) -> Iterator[Gap]:
        """The facts of an element on the assumption that its type is `type_`."""
        if kind := _kind(type_):
            yield _declared(element, type_, kind)
        elif type_.sends is ProtocolPart.EVENT or type_.receives is ProtocolPart.EVENT:
            event = meant(element, "event", type_.attributes)
            if type_.sends or event is not None:
                yield Gap(GapAct.SENDS if type_.sends else GapAct.RECEIVES, event.value if event else None)
        elif (
            (name := type_.attributes.get("name")) is not None
            and name.refers
            and (part := type_.sends or type_.receives)
        ):
            handle = meant(element, "name", type_.attributes)
            for kind in name.refers:
                if kind in INTERFACE_KINDS:
                    yield from self._facts_about(InterfaceAct(kind, part), handle)
        elif "key" in type_.attributes:
            key = meant(element, "key", type_.attributes)
            yield Gap(GapAct.PORT, key.value if key else None)
        elif type_.sends in _IN_TREE or type_.receives in _IN_TREE:
            yield Gap(GapAct.TREE)

    def _facts_about(self, act: InterfaceAct, handle: Name | None) -> Iterator[Gap]:
        """The facts of an act that refers to the declaration named `handle`, or to one with a similar name."""
        kind = act.kind
        right = [d for d in self.machine.declarations if d.kind is kind and d.handle is not None]
        named = [d for d in right if handle and d.handle and d.handle.value == handle.value]
        if handle is None:
            # The act may refer to any declaration, including one that is missing.
            yield Gap(act)
            return
        if not named:
            if (kind, handle.value) in self.hidden:
                return  # the declaration exists, but cannot be read: its own gap is more specific
            close = close_names(handle.value, [d.handle.value for d in right if d.handle], 1)
            named = [d for d in right if d.handle and d.handle.value in close]
            for declaration in named:
                if declaration.handle is declaration.interface and isinstance(declaration.interface, Name):
                    # The topic, service or action is the handle, and may be misspelled in its declaration.
                    yield Gap(InterfaceAct(kind), handle.value)
                    yield Gap(InterfaceAct(OTHER_SIDE[kind]), declaration.interface.value)
        if not named:
            other = [d for d in self.machine.declarations if d.handle and d.handle.value == handle.value]
            named = [d for d in other if isinstance(d.interface, (Name, PortRead)) and d.kind in INTERFACE_KINDS]
        yield from (_about(act, declaration) for declaration in named)
        if not named:
            yield Gap(InterfaceAct(kind))  # the declaration is missing

    def _facts_of_child(self, element: Element, parent: Element) -> Iterator[Gap]:
        """The facts of an unknown child of a sending element, which may set a field or parameter: `<feild
        name="…">`."""
        if not element.attributes:
            return
        for chart in self.machine.charts:
            for statement in chart.statements:
                if statement.element is parent and isinstance(statement, Send):
                    yield Gap(GapAct.PARAMETER, statement.event.value if statement.event else None)
                elif statement.element is parent and isinstance(statement, RosSend):
                    yield from self._fields(statement)

    # ----------------------------------------------------- elements that are read

    def _declaration(self, declaration: Declaration) -> Iterator[PlacedGap]:
        if declaration.kind not in INTERFACE_KINDS:
            return
        element, type_ = declaration.element, HL_SCXML.elements[declaration.element.name]
        if isinstance(declaration.interface, PortRead):
            key = declaration.interface.key
            if key is None or all(port.key is None or port.key.value != key.value for port in self.machine.ports):
                yield PlacedGap(Gap(InterfaceAct(declaration.kind)), declaration.interface.span)
        elif declaration.interface is None or not is_interface_name(declaration.interface.value):
            yield PlacedGap(_declared(element, type_, declaration.kind), element.name_span)
        unknown = declaration.type is None or not self.has_type(
            INTERFACE_KINDS[declaration.kind], declaration.type.value
        )
        if unknown:
            span = declaration.type.span if declaration.type else element.name_span
            for part in _PARTS[declaration.kind]:
                yield PlacedGap(_about(InterfaceAct(declaration.kind, part, True), declaration), span)

    def _statements(self) -> Iterator[PlacedGap]:
        owners: dict[Element, RosSend] = {}
        for chart in self.machine.charts:
            for statement in chart.statements:
                if isinstance(statement, Send):
                    yield from self._send(statement)
                elif isinstance(statement, RosSend):
                    owners |= {field.element: statement for field in statement.fields}
                    yield from self._user(statement, statement.part)
                    if any(field.name is None for field in statement.fields):
                        yield from (PlacedGap(g, statement.element.name_span) for g in self._fields(statement))
        # The required type of a field is unknown if the ROS type is unknown or has no such field.
        for value in self.typed.values:
            owner = owners.get(value.element) if value.use is ValueUse.FIELD else None
            if owner is not None and (value.required is None or value.required == UNKNOWN):
                yield from (PlacedGap(g, value.element.name_span) for g in self._fields(owner))

    def _send(self, send: Send) -> Iterator[PlacedGap]:
        if send.event is None:
            event = meant(send.element, "event", HL_SCXML.elements["send"].attributes)
            yield PlacedGap(Gap(GapAct.SENDS, event.value if event else None), send.element.name_span)
        for param in send.params:
            if param.name is None:
                yield PlacedGap(
                    Gap(GapAct.PARAMETER, send.event.value if send.event else None), param.element.name_span
                )

    def _fields(self, statement: RosSend) -> Iterator[Gap]:
        declaration = find_handle(self.machine, statement)
        for kind in statement.type.attributes["name"].refers:
            act = InterfaceAct(kind, statement.part, True)
            yield _about(act, declaration) if declaration is not None else Gap(act)

    def _user(self, user: RosSend | Handler, part: ProtocolPart) -> Iterator[PlacedGap]:
        """The gaps of an element that refers to no declaration, or to a declaration of a wrong kind."""
        name = user.type.attributes.get("name")
        kinds = [kind for kind in name.refers if kind in INTERFACE_KINDS] if name else []
        declaration = find_handle(self.machine, user)
        if not kinds or (declaration is not None and declaration.kind in kinds):
            return
        handle = user.handle or meant(user.element, "name", user.type.attributes)
        span = user.handle.span if user.handle else user.element.name_span
        for kind in kinds:
            yield from (PlacedGap(gap, span) for gap in self._facts_about(InterfaceAct(kind, part), handle))
            if declaration is not None and declaration.kind in INTERFACE_KINDS:
                # The declaration may be wrong.
                yield PlacedGap(_about(InterfaceAct(kind), declaration), span)

    def _handlers(self) -> Iterator[PlacedGap]:
        for chart in self.machine.charts:
            for state in chart.states:
                for handler in state.handlers:
                    if handler.effective and handler.trigger not in (None, ProtocolPart.EVENT):
                        yield from self._user(handler, handler.trigger)
                    elif handler.effective and handler.event is None:
                        event = meant(handler.element, "event", handler.type.attributes)
                        if event is not None:
                            yield PlacedGap(Gap(GapAct.RECEIVES, event.value), handler.element.name_span)

    def _ports(self) -> Iterator[PlacedGap]:
        declared = {port.key.value for port in self.machine.ports if port.key}
        for port in self.machine.ports:
            if port.key is None:
                key = meant(port.element, "key", HL_SCXML.elements[port.element.name].attributes)
                yield PlacedGap(Gap(GapAct.PORT, key.value if key else None), port.element.name_span)
        for read in reads_of_ports(self.machine, self.typed):
            if read.key is None or read.key.value not in declared:
                yield PlacedGap(Gap(GapAct.PORT), read.span)
        for chart in self.machine.charts:
            for statement in chart.statements:
                if isinstance(statement, SetOutput) and (statement.key is None or statement.key.value not in declared):
                    yield PlacedGap(Gap(GapAct.PORT), statement.element.name_span)


_IN_TREE = (
    ProtocolPart.BT_TICK,
    ProtocolPart.BT_HALT,
    ProtocolPart.BT_STATUS,
    ProtocolPart.BT_HALTED,
    ProtocolPart.CHILD_TICK,
    ProtocolPart.CHILD_HALT,
)

OTHER_SIDE: Mapping[SymbolKind, SymbolKind] = {
    SymbolKind.PUBLISHER: SymbolKind.SUBSCRIBER,
    SymbolKind.SUBSCRIBER: SymbolKind.PUBLISHER,
    SymbolKind.SERVICE_CLIENT: SymbolKind.SERVICE_SERVER,
    SymbolKind.SERVICE_SERVER: SymbolKind.SERVICE_CLIENT,
    SymbolKind.ACTION_CLIENT: SymbolKind.ACTION_SERVER,
    SymbolKind.ACTION_SERVER: SymbolKind.ACTION_CLIENT,
}
"""The opposite kind of each kind of declaration."""

_PARTS: Mapping[SymbolKind, tuple[ProtocolPart, ...]] = {
    SymbolKind.PUBLISHER: (ProtocolPart.MESSAGE,),
    SymbolKind.SUBSCRIBER: (),
    SymbolKind.SERVICE_CLIENT: (ProtocolPart.REQUEST, ProtocolPart.RESPONSE),
    SymbolKind.SERVICE_SERVER: (ProtocolPart.REQUEST, ProtocolPart.RESPONSE),
    SymbolKind.ACTION_CLIENT: (ProtocolPart.GOAL, ProtocolPart.FEEDBACK, ProtocolPart.RESULT),
    SymbolKind.ACTION_SERVER: (ProtocolPart.GOAL, ProtocolPart.FEEDBACK, ProtocolPart.RESULT),
}
"""Kind of declaration -> the parts of its interface whose fields exist in the translation, so that the other side may
use them."""


def _kind(type_: ElementType) -> SymbolKind | None:
    """The kind of ROS interface that an element declares; `None` if it declares none."""
    return next((a.defines for a in type_.attributes.values() if a.defines in INTERFACE_KINDS), None)


def reads_of_ports(machine: Machine, typed: TypedMachine) -> Iterator[PortRead]:
    """All reads of ports in a machine."""
    values: list[Expression | Name | PortRead | None] = [value.value for value in typed.values]
    values += [d.interface for d in machine.declarations] + [d.rate for d in machine.declarations]
    yield from (value for value in values if isinstance(value, PortRead))


def is_interface_name(name: str) -> bool:
    """Whether `name` is a valid name of a topic, service or action: not empty and without white space, because it
    becomes a part of event names (docs/spec/plain-scxml.md#interface-names)."""
    return bool(name) and not any(character.isspace() for character in name)


def _about(act: Act, declaration: Declaration) -> Gap:
    if isinstance(declaration.interface, PortRead):
        key = declaration.interface.key
        return Gap(act, None, key.value) if key else Gap(act)
    name = declaration.interface.value if declaration.interface else None
    return Gap(act, name if name and is_interface_name(name) else None)


def _declared(element: Element, type_: ElementType, kind: SymbolKind) -> Gap:
    """The gap of a declaration that cannot be read, or whose interface name cannot be read."""
    for attribute in INTERFACE_ATTRIBUTES:
        if attribute in type_.attributes:
            name = meant(element, attribute, type_.attributes)
            if name is not None:
                return Gap(InterfaceAct(kind), name.value if is_interface_name(name.value) else None)
            child = element.find(attribute)
            read = port_read(child) if child is not None else None
            if read is not None and read.key is not None:
                return Gap(InterfaceAct(kind), None, read.key.value)
    return Gap(InterfaceAct(kind))
