# SPDX-License-Identifier: Apache-2.0
"""Builds a `Machine` from an XML tree. Unknown and misplaced parts are left out; rules about the grammar report
them."""

from __future__ import annotations

from roaml.expr.types import BASE_TYPES, parse_type
from roaml.interruption import checkpoint
from roaml.language import HL_SCXML, ElementType
from roaml.model.machine import (
    Assign,
    Body,
    Branch,
    CallChild,
    Chart,
    Data,
    Declaration,
    Handler,
    If,
    Machine,
    NoEffect,
    Param,
    Port,
    ReturnHalted,
    ReturnStatus,
    RosSend,
    Send,
    SetOutput,
    State,
    Statement,
    Target,
    Thread,
)
from roaml.model.syntax import (
    Name,
    TypeRef,
    expression_of,
    name_of,
    text_or_port,
    type_of,
    value_of,
)
from roaml.regex import regex
from roaml.roles import Direction, ProtocolPart, SymbolKind
from roaml.text import Span
from roaml.xml_syntax import Comment, Document, Element

INTERFACE_ATTRIBUTES = ("topic", "service_name", "action_name")

_PLAIN = frozenset(("datamodel", "data", "state", "onentry", "onexit", "transition", "target", "assign", "send"))
_PLAIN_ELEMENTS = _PLAIN | {"param", "if", "elseif", "else", "expr", "ascxml", "scxml"}
_TYPE_COMMENT = regex(r"TYPE\s+([^\s:]+)\s*:\s*(\S+)")


def build_machine(document: Document) -> Machine | None:
    """The machine in `document`; `None` if its root is not an HL-SCXML element."""
    root = document.root
    if root is None or root.name not in HL_SCXML.roots:
        return None
    return _Builder(document).machine(root)


class _Builder:
    def __init__(self, document: Document) -> None:
        self.document = document
        groups = HL_SCXML.groups
        self.transitions, self.executables, self.declarations = (
            groups[name] for name in ("Transition", "Executable", "Declaration")
        )

    def children(self, element: Element) -> list[Element]:
        """The child elements that are not in a foreign namespace."""
        return [child for child in element.elements if not child.is_foreign]

    def machine(self, root: Element) -> Machine:
        declarations: list[Declaration] = []
        ports: list[Port] = []
        threads: list[Thread] = []
        for child in self.children(root):
            if child.name in ("bt_declare_port_in", "bt_declare_port_out"):
                ports.append(self.port(child))
            elif child.name in self.declarations:
                declarations.append(self.declaration(child))
            elif child.name == "ros_action_thread":
                threads.append(self.thread(child, len(threads)))
        return Machine(
            root,
            root.name,
            name_of(root.get("name")),
            self.chart(root, ""),
            tuple(declarations),
            tuple(ports),
            tuple(threads),
            self.is_plain(root),
        )

    def is_plain(self, root: Element) -> bool:
        for element in root.walk():
            if element.name not in _PLAIN_ELEMENTS:
                return False
            if element.name == "data" and (type_ := element.get("type")):
                name = parse_type(type_.value)
                if name is not None and name.base not in BASE_TYPES:
                    return False
        return True

    def chart(self, element: Element, scope: str) -> Chart:
        children = self.children(element)
        models = [child for child in children if child.name == "datamodel"]
        return Chart(
            element,
            scope,
            name_of(element.get("initial")),
            tuple(data for model in models for data in self.datamodel(model)),
            tuple(self.state(child) for child in children if child.name == "state"),
        )

    def thread(self, element: Element, number: int) -> Thread:
        count = name_of(element.get("n_threads"))
        copies = int(count.value[:9]) if count and count.value.isascii() and count.value.isdigit() else 0
        return Thread(element, name_of(element.get("name")), copies or None, self.chart(element, f"thread {number}"))

    # ------------------------------------------------------------------ data

    def datamodel(self, element: Element) -> list[Data]:
        declarations = []
        comment: Comment | None = None
        for node in element.nodes:
            if isinstance(node, Comment):
                comment = node
            elif isinstance(node, Element):
                if node.name == "data":
                    declarations.append(self.data(node, comment))
                comment = None
        return declarations

    def data(self, element: Element, comment: Comment | None) -> Data:
        id_, type_ = name_of(element.get("id")), type_of(element.get("type"))
        by_comment = False
        if type_ is None and comment is not None and id_ is not None:
            match = _TYPE_COMMENT.search(comment.value)
            if match and match[1] == id_.value:
                start = comment.span.start + len("<!--") + match.start(2)
                type_ = TypeRef(match[2], Span(start, start + len(match[2])), parse_type(match[2]))
                by_comment = True
        value, lower, upper = (
            value_of(self.document, element, name) for name in ("expr", "lower_bound_incl", "upper_bound_incl")
        )
        return Data(element, id_, type_, value, lower, upper, by_comment)

    def declaration(self, element: Element) -> Declaration:
        type_ = HL_SCXML.elements[element.name]
        kind = next(a.defines for a in type_.attributes.values() if a.defines)
        if kind is SymbolKind.TIMER:
            rate = text_or_port(self.document, element, "rate_hz")
            return Declaration(element, kind, name_of(element.get("name")), None, None, rate)
        attribute = next(name for name in INTERFACE_ATTRIBUTES if name in type_.attributes)
        interface = text_or_port(self.document, element, attribute)
        handle = name_of(element.get("name"))
        if handle is None and isinstance(interface, Name):
            handle = interface
        return Declaration(element, kind, handle, interface, name_of(element.get("type")))

    def port(self, element: Element) -> Port:
        direction = Direction(element.name.rpartition("_")[2])
        return Port(element, name_of(element.get("key")), type_of(element.get("type")), direction)

    # ---------------------------------------------------------------- states

    def state(self, element: Element) -> State:
        checkpoint()
        entry = exit_ = None
        handlers = []
        for child in self.children(element):
            if child.name == "onentry":
                entry = entry or Body(child, self.body(child))
            elif child.name == "onexit":
                exit_ = exit_ or Body(child, self.body(child))
            elif child.name in self.transitions:
                handlers.append(self.handler(child))
        return State(element, name_of(element.get("id")), entry, exit_, tuple(handlers))

    def handler(self, element: Element) -> Handler:
        type_ = HL_SCXML.elements[element.name]
        event = name_of(element.get("event")) if "event" in type_.attributes else None
        trigger: ProtocolPart | None = type_.receives
        if trigger is ProtocolPart.EVENT and element.get("event") is None:
            trigger = None
        cond = expression_of(self.document, element.get("cond"))
        handle = self.handle(element, type_)
        child = name_of(element.get("id")) if "id" in type_.attributes else None
        return Handler(
            element, type_, trigger, event, handle, child, cond, self.targets(element, type_), not type_.ignored
        )

    def targets(self, element: Element, type_: ElementType) -> tuple[Target, ...]:
        if type_.receives is ProtocolPart.GOAL_RESPONSE:
            return tuple(Target(None, name_of(element.get(name)), None, ()) for name in ("accept", "reject"))
        choices = [child for child in self.children(element) if child.name == "target"]
        if choices and element.get("target") is None:
            return tuple(
                Target(choice, name_of(choice.get("id")), name_of(choice.get("prob")), self.body(choice))
                for choice in choices
            )
        return (Target(None, name_of(element.get("target")), None, self.body(element)),)

    def handle(self, element: Element, type_: ElementType) -> Name | None:
        """The handle that a callback or a sending element refers to; `None` if there is none. It is the value of
        `name`; if `name` is missing, as in the older dialect, it is the name of the interface."""
        if type_.attributes.get("name") is None or not type_.attributes["name"].refers:
            return None
        named = name_of(element.get("name"))
        if named is not None:
            return named
        for attribute in INTERFACE_ATTRIBUTES:
            if attribute in type_.attributes and (older := name_of(element.get(attribute))):
                return older
        return None

    # ------------------------------------------------------------ statements

    def body(self, element: Element) -> tuple[Statement, ...]:
        return tuple(self.statement(child) for child in self.children(element) if child.name in self.executables)

    def statement(self, element: Element) -> Statement:
        match element.name:
            case "assign":
                location = expression_of(self.document, element.get("location"))
                return Assign(element, location, value_of(self.document, element, "expr"))
            case "send":
                return Send(element, name_of(element.get("event")), self.params(element, "param"))
            case "if":
                return self.choice(element)
            case "bt_return_status":
                return ReturnStatus(element, name_of(element.get("status")))
            case "bt_return_halted":
                return ReturnHalted(element)
            case "bt_tick_child" | "bt_halt_child":
                return CallChild(element, element.name == "bt_halt_child", name_of(element.get("id")))
            case "bt_set_output":
                value = expression_of(self.document, element.get("expr"))
                return SetOutput(element, name_of(element.get("key")), value)
        type_ = HL_SCXML.elements[element.name]
        if type_.ignored:
            return NoEffect(element)
        return RosSend(
            element,
            type_,
            self.handle(element, type_),
            self.params(element, "field"),
            expression_of(self.document, element.get("goal_id")),
            expression_of(self.document, element.get("thread_id")),
        )

    def params(self, element: Element, tag: str) -> tuple[Param, ...]:
        return tuple(
            Param(child, name_of(child.get("name")), value_of(self.document, child, "expr"))
            for child in self.children(element)
            if child.name == tag
        )

    def choice(self, element: Element) -> Statement:
        parts: list[tuple[Element, list[Statement]]] = [(element, [])]
        for child in self.children(element):
            if child.name in ("elseif", "else"):
                parts.append((child, []))
                # Content inside `<elseif>` or `<else>` is an error, but is still part of the branch.
                parts[-1][1].extend(self.body(child))
            elif child.name in self.executables:
                parts[-1][1].append(self.statement(child))
        branches, otherwise = [], None
        for marker, content in parts:
            branch = Branch(marker, expression_of(self.document, marker.get("cond")), tuple(content))
            if marker.name == "else":
                otherwise = otherwise or branch
            else:
                branches.append(branch)
        return If(element, tuple(branches), otherwise)
