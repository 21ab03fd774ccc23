# SPDX-License-Identifier: Apache-2.0
"""The whole system, linked across files: the automata, the topics, services, actions and events that connect them, and
the variables of the blackboard.

- A system is built from outlines only, so it contains no positions. A `Symbol` refers to a declaration in the text.
- Systems are compared by identity: a system is cached by its parts, and all results across files depend on it.
"""

from __future__ import annotations

import bisect
import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TypeAlias

from roaml.diagnostics import Symbol
from roaml.exhaustive import assert_never
from roaml.expr.types import BASE_TYPES, Struct, StructKind, Type
from roaml.language import BEHAVIOR_TREE, ElementType
from roaml.libraries import BEHAVIORTREE_CPP, LIBRARIES, Node, Port, library, library_node
from roaml.model.expand import (
    Instance,
    NodeSource,
    PortConstant,
    PortValue,
    Reference,
    TreeUse,
    board_prefix,
    is_on_board,
)
from roaml.model.gaps import Act, Gap, GapAct, InterfaceAct, answers, is_interface_name
from roaml.model.outline import (
    EventReceived,
    EventSent,
    InterfaceUse,
    MachineOutline,
    PluginOutline,
    PortOutline,
)
from roaml.model.parameters import Parameters, TreeSemantics
from roaml.model.tree import EXPLICIT, SUBTREES
from roaml.record import Record, field, replace
from roaml.roles import Direction, NodeKind, SymbolKind
from roaml.scxml.event_data import parameter_types
from roaml.scxml.names import (
    ACTION_PREFIX,
    CANCEL_PREFIX,
    SERVICE_PREFIX,
    TOPIC_PREFIX,
    TREE_PREFIX,
    cancel_request,
    flag_of,
    is_interface_event,
    sanitise,
)
from roaml.suggest import close_names

CLOCK_TOPIC = "clock"
CLOCK_TYPE = "builtin_interfaces/Time"
CHILDREN_COUNT = "CHILDREN_COUNT"
ANY_TYPE = "any"
"""The type of a port that accepts any type."""


Fact: TypeAlias = "tuple[Act, str | None]"
"""An act (see `Gap`) and the name that it concerns; `None` means any name. The name of a topic is sanitised, as in
names of events."""


class SystemAutomaton(Record, frozen=True):
    """A machine in its place in the system: a ROS node, or the copy of a plugin for one node of the tree.

    Attributes:
        path: the file of the machine; "" for nodes of BehaviorTree.CPP.
        instance: the node of the tree; `None` for ROS nodes.
        index: the index among the ROS nodes of the system file, so that a file that is listed twice gives two automata;
            0 for nodes of the tree.
    """

    name: str
    path: str
    outline: MachineOutline
    instance: Instance | None = None
    index: int = 0

    @property
    def board(self) -> str:
        """The beginning of the full names of the variables of its tree; "" for ROS nodes."""
        return "" if self.instance is None else board_prefix(self.instance.tree)

    def port(self, key: str) -> PortValue | None:
        """The value of the port `key`; `None` if the machine does not declare it or the tree does not set it."""
        if self.instance is None or self.outline.port(key) is None:
            return None
        if key == CHILDREN_COUNT:
            return PortConstant(str(len(self.instance.children)))
        return self.instance.port(key)

    def interface_name(self, use: InterfaceUse) -> str | None:
        """The name of the topic, service or action of a declaration; `None` if it is missing, invalid or unknown."""
        value = self.port(use.port) if use.port else PortConstant(use.name)
        name = value.text.strip() if isinstance(value, PortConstant) else ""
        return name if is_interface_name(name) else None

    def symbol(self, use: InterfaceUse) -> Symbol:
        return Symbol(self.path, use.kind, use.handle)


class ChannelEndpoint(Record, frozen=True):
    """An automaton that uses a topic, service or action, with its declaration."""

    automaton: SystemAutomaton
    use: InterfaceUse

    @property
    def symbol(self) -> Symbol:
        return self.automaton.symbol(self.use)


class Channel(Record):
    """A topic, service or action. The name of a topic is sanitised. `sources` are its publishers or servers, `users`
    its subscribers or clients."""

    name: str
    sources: list[ChannelEndpoint] = field(default_factory=list)
    users: list[ChannelEndpoint] = field(default_factory=list)

    @property
    def endpoints(self) -> list[ChannelEndpoint]:
        return [*self.sources, *self.users]


class PlainEvent(Record):
    """A plain event with all its senders and receivers."""

    name: str
    senders: list[tuple[SystemAutomaton, EventSent]] = field(default_factory=list)
    receivers: list[tuple[SystemAutomaton, EventReceived]] = field(default_factory=list)

    @property
    def data(self) -> Struct:
        """The parameters that the senders send, with the common types of their values. If the types of a parameter are
        incompatible, the first known type is used."""
        params = parameter_types((param.name, param.type) for _, sent in self.senders for param in sent.params)
        return Struct("", tuple(params.items()), f"data of event {self.name}", StructKind.EVENT, self.name)


class BoundPort(Record, frozen=True):
    """A port that is bound to a blackboard variable."""

    automaton: SystemAutomaton
    port: PortOutline

    @property
    def source(self) -> NodeSource:
        assert self.automaton.instance is not None
        return self.automaton.instance.source


class EntryOutline(Record, frozen=True):
    """A variable of the blackboard of a tree that is executed as BehaviorTree.CPP executes it. `type` is the name of
    its type; `read` and `written` state whether nodes or scripts read and write it."""

    type: str
    read: bool
    written: bool


class SystemTree(Record, frozen=True):
    """A tree that a system executes (docs/spec/trees.md#several-trees).

    Attributes:
        name: the name that the system gives it; "" if it has none.
        path: the file that the system lists.
        tick_rate: its own rate in Hz; `None` if it is that of the system.
    """

    name: str
    path: str
    tick_rate: float | None = None


_BESIDE_EVENTS = (GapAct.PORT, GapAct.VARIABLE, GapAct.REMAP, GapAct.NAME, GapAct.PARAMETER)
"""The acts that do not affect which events a machine handles and sends."""


class System(Record, frozen=True, eq=False, dict=True, weakref=True):
    """A system file and everything that it names.

    Attributes:
        path: the path of the system file.
        older: whether the system is written in the older dialect (docs/spec/files.md#older-dialect).
        nodes: the path and outline of each ROS node, in the order of the system file.
        plugins: the path and outline of each plugin, in the order of the system file.
        instances: the nodes of the executed trees, tree by tree, in pre-order.
        tree_uses: the uses of trees that contain the instances; `Instance.use` is an index into it.
        tree_paths: the tree files and the files that they include; empty if the system has no tree.
        structs: the structs by name.
        gaps: the facts that unreadable parts of the system file and the trees, and unreadable files, may contain. The
            outline of a machine contains the facts of its own unreadable parts.
        plugins_known: whether every plugin that the system lists could be read and has a name.
        observed: the names of the global variables of the translation that the properties use.
        trees: the listed trees, in the order of the system file.
        owners: for each plugin, the name of the tree that it belongs to; "" if it belongs to all trees.
        entries: name -> entry of the blackboard, for a tree with `is_library_tree`; empty for other trees.
    """

    path: str
    older: bool
    parameters: Parameters
    nodes: tuple[tuple[str, MachineOutline], ...]
    plugins: tuple[tuple[str, MachineOutline], ...]
    instances: tuple[Instance, ...]
    tree_uses: tuple[TreeUse, ...]
    tree_paths: tuple[str, ...]
    structs: Mapping[str, Type]
    gaps: frozenset[Gap]
    plugins_known: bool
    observed: frozenset[str] = frozenset()
    trees: tuple[SystemTree, ...] = ()
    owners: tuple[str, ...] = ()
    entries: Mapping[str, EntryOutline] = field(default_factory=dict)

    @property
    def is_as2fm(self) -> bool:
        """Whether the system has the semantics of AS2FM (docs/spec/nodes.md#semantics)."""
        return self.parameters.semantics is TreeSemantics.AS2FM

    @cached_property
    def is_library_tree(self) -> bool:
        """Whether the tree is executed as the libraries execute it: always with the semantics of the library; with
        those of AS2FM, if one of its nodes, conditions or scripts has no other meaning
        (docs/spec/nodes.md#semantics)."""
        if not self.is_as2fm:
            return bool(self.instances)
        if any(use.scripts for use in self.tree_uses):
            return True
        return any(i.scripts or self._needs_library(i.plugin) for i in self.instances)

    def is_program(self, automaton: SystemAutomaton) -> bool:
        """Whether a node of the tree is executed as the libraries execute it; false for machines, and for nodes that
        deviate with the semantics of AS2FM."""
        return not automaton.path and self.is_library_tree and not self._deviates(automaton.outline.name)

    def _deviates(self, name: str) -> bool:
        """Whether a node has the meaning of AS2FM. Nodes without children have one meaning."""
        node = library_node(name) if self.is_as2fm and name in builtin_plugins() else None
        return node is not None and node.children[1] > 0

    def _needs_library(self, plugin: str) -> bool:
        element = BEHAVIOR_TREE.elements.get(plugin)
        if element is not None and element.node:
            return element.program_only
        return plugin in library_plugins() and plugin not in self._plugins

    @cached_property
    def automata(self) -> tuple[SystemAutomaton, ...]:
        """All automata in processing order: the ROS nodes, then the nodes of the tree in pre-order
        (docs/spec/systems.md#processing-order)."""
        all_automata = [
            SystemAutomaton(outline.name, path, outline, None, i) for i, (path, outline) in enumerate(self.nodes)
        ]
        for instance in self.instances:
            path, outline = self.plugin(instance.plugin, instance.tree)
            if outline is not None:
                all_automata.append(SystemAutomaton(instance.automaton, path, outline, instance))
        return tuple(all_automata)

    @property
    def complete(self) -> bool:
        """Whether the system has no unreadable part that may contribute a fact."""
        return not self.possible

    @cached_property
    def possible(self) -> frozenset[Fact]:
        """All facts that unreadable parts may contain."""
        facts: set[Fact] = set()
        for gap in self.gaps:
            facts |= self.facts(gap)
        if self.ticked_nodes or self.idle_plugins:
            facts.add((GapAct.ANYTHING, None))  # the entry probably should name another file
        for automaton in self.automata:
            facts |= self.facts_of(automaton)
        for instance in self.instances:
            if self.plugin(instance.plugin, instance.tree)[1] is None:
                facts |= self.facts_of_unknown(instance)
        return frozenset(facts)

    def may(self, act: Act, name: str, automaton: SystemAutomaton | None = None) -> bool:
        """Whether an unreadable part may do `act` with `name`, the name of a channel, event, port or variable.

        Args:
            automaton: the automaton with the unreadable part; `None` for any part of the system.
        """
        possible = self.possible if automaton is None else self.facts_of(automaton)
        return any(answers(other, act) and about in (None, name) for other, about in possible)

    def may_have_variable(self, name: str) -> bool:
        """Whether the translated system may have a variable named `name` after the unreadable parts are corrected."""
        return any(may_give_variable(act, other, name) for act, other in self.possible)

    def facts(self, gap: Gap, automaton: SystemAutomaton | None = None) -> set[Fact]:
        """The facts of a gap in the machine of `automaton`. If `automaton` is `None`, the gap is in the system file or
        in a tree."""
        if gap.act is GapAct.NODE:
            return self._facts_of_any_node()
        if gap.act is GapAct.REMAP:
            named = [v for v in self.blackboard if gap.name is not None and f"__{v}".endswith(f"__{gap.name}")]
            return {(GapAct.VARIABLE, variable) for variable in named}
        if gap.act is GapAct.PORT:
            ports = automaton.instance.ports if automaton is not None and automaton.instance is not None else ()
            bound = [value for key, value in ports if gap.name in (None, key)]
            return {(GapAct.VARIABLE, value.variable) for value in bound if isinstance(value, Reference)}
        if gap.port and automaton is not None:
            value = automaton.port(gap.port)
            name = value.text.strip() if isinstance(value, PortConstant) else ""
            return {_fact(gap.act, name if is_interface_name(name) else None)}
        return {_fact(gap.act, gap.name)}

    def facts_of(self, automaton: SystemAutomaton) -> set[Fact]:
        """The facts that the unreadable parts of the machine of an automaton, or its node in the tree, may contain."""
        facts = {fact for gap in automaton.outline.gaps for fact in self.facts(gap, automaton)}
        for use in automaton.outline.interfaces:
            if use.port and automaton.interface_name(use) is None:
                facts |= self.facts_of_name(automaton, use)
        return facts

    @cached_property
    def partly_read(self) -> frozenset[int]:
        """The `id()` of each automaton with an unreadable part that may handle or send events."""
        return frozenset(
            id(automaton)
            for automaton in self.automata
            if any(_is_about_events(act) for act, _ in self.facts_of(automaton))
        )

    def facts_of_name(self, automaton: SystemAutomaton, use: InterfaceUse) -> set[Fact]:
        """The facts of a tree node with a port that should contain the name of a topic, service or action, but does
        not."""
        value = automaton.port(use.port)
        bound: set[Fact] = {(GapAct.VARIABLE, value.variable)} if isinstance(value, Reference) else set()
        return {*bound, (InterfaceAct(use.kind), None)}

    def facts_of_unknown(self, instance: Instance) -> set[Fact]:
        """The facts of a tree node whose plugin is unknown: those of the plugin with the most similar name."""
        facts: set[Fact] = {(GapAct.VARIABLE, v.variable) for _, v in instance.ports if isinstance(v, Reference)}
        element = BEHAVIOR_TREE.elements.get(instance.plugin)
        if element is not None and element.node:
            return {*facts, (GapAct.TREE, None)}  # a node of BehaviorTree.CPP that cannot be translated
        names = [outline.name for _, outline in (*self.plugins, *self.nodes)]
        close = close_names(instance.plugin, [*names, *builtin_plugins()], 1)
        facts |= {(GapAct.NODE, name) for name in close} or {(GapAct.NODE, None)}
        if not close or not self.plugins_known:
            return {*facts, (GapAct.ANYTHING, None)}
        for path, outline in (*self.plugins, *self.nodes):
            if outline.name in close:
                intended = SystemAutomaton(instance.automaton, path, outline, instance)
                facts |= set(_readable_facts(intended)) | self.facts_of(intended)
        return {*facts, (GapAct.TREE, None)}

    def _facts_of_any_node(self) -> set[Fact]:
        """The facts of a tree node on the assumption that it may have any plugin."""
        if not self.plugins_known:
            return {(GapAct.ANYTHING, None)}
        facts: set[Fact] = {
            (GapAct.NODE, None),
            (GapAct.VARIABLE, None),
            (GapAct.TREE, None),
            (InterfaceAct(SymbolKind.PUBLISHER), CLOCK_TOPIC),
        }
        for path, outline in self.plugins:
            facts |= set(_readable_facts(SystemAutomaton(outline.name, path, outline)))
            facts |= {
                _fact(gap.act, None if gap.port else gap.name) for gap in outline.gaps if gap.act is not GapAct.PORT
            }
        return facts

    @cached_property
    def ticked_nodes(self) -> frozenset[str]:
        """The files that are listed as ROS nodes although they handle ticks, so they are plugins."""
        return frozenset(path for path, outline in self.nodes if outline.plugin.ticked)

    @cached_property
    def idle_plugins(self) -> frozenset[str]:
        """The files that are listed as plugins although they take no part in the behavior tree, and that no node of the
        tree names."""
        if any(gap.act in (GapAct.ANYTHING, GapAct.NODE) for gap in self.gaps):
            return frozenset()
        used = {instance.plugin for instance in self.instances}
        return frozenset(
            path
            for path, outline in self.plugins
            if outline.name not in used
            and not outline.takes_part_in_tree
            and not any(gap.act in (GapAct.TREE, GapAct.PORT, GapAct.ANYTHING) for gap in outline.gaps)
        )

    @cached_property
    def by_instance(self) -> Mapping[int, SystemAutomaton]:
        return {automaton.instance.number: automaton for automaton in self.automata if automaton.instance}

    @cached_property
    def _plugins(self) -> Mapping[str, tuple[str, MachineOutline]]:
        return {outline.name: (path, outline) for path, outline in reversed(self.plugins)}

    @cached_property
    def _plugins_by_tree(self) -> Mapping[str, Mapping[str, tuple[str, MachineOutline]]]:
        """Name of a tree -> its plugins by name."""
        if not any(self.owners):
            return {tree.name: self._plugins for tree in self.trees}
        return {
            tree.name: {
                outline.name: (path, outline)
                for (path, outline), owner in reversed(tuple(zip(self.plugins, self.owners, strict=True)))
                if owner in ("", tree.name)
            }
            for tree in self.trees
        }

    def plugin(self, name: str, tree: str | None = None) -> tuple[str, MachineOutline | None]:
        """The path and outline of the plugin named `name`; "" and `None` if there is none. The nodes of the libraries
        have the path "". Those that the schema of trees defines take precedence over plugins with the same name
        (docs/spec/trees.md#nodes); over the others, plugins take precedence.

        Args:
            tree: the name of the tree whose plugins are searched; `None` for those of all trees.
        """
        plugins = self._plugins if tree is None else self._plugins_by_tree.get(tree, self._plugins)
        is_program = self.is_library_tree and not self._deviates(name)
        builtin = (library_plugins() if is_program else builtin_plugins()).get(name)
        if builtin is not None and (name in BEHAVIOR_TREE.elements or name not in plugins):
            return "", builtin
        return plugins.get(name, ("", None))

    def seen_from(self, path: str) -> System:
        """This system with the plugins in another order: `plugin` without a tree finds those of the tree that uses the
        file `path` first. The system itself unless plugins of different trees have the same name."""
        if not self._has_equal_plugins:
            return self
        tree = next((i.tree for i in self.instances if i.source.path == path), None)
        if tree is None:
            return self
        if tree not in self._views:
            order = sorted(range(len(self.plugins)), key=lambda index: self.owners[index] not in ("", tree))
            plugins, owners = (tuple(values[index] for index in order) for values in (self.plugins, self.owners))
            self._views[tree] = replace(self, plugins=plugins, owners=owners)
        return self._views[tree]

    @cached_property
    def _has_equal_plugins(self) -> bool:
        return any(self.owners) and len(self._plugins) < len(self.plugins)

    @cached_property
    def _views(self) -> dict[str, System]:
        """The results of `seen_from`, by tree."""
        return {}

    def tick_rate(self, tree: str) -> float:
        """The rate at which the tree with the name `tree` is ticked, in Hz."""
        own = next((listed.tick_rate for listed in self.trees if listed.name == tree), None)
        return self.parameters.tick_rate if own is None else own

    def has_own_rate(self, tree: str) -> bool:
        return any(listed.name == tree and listed.tick_rate is not None for listed in self.trees)

    @cached_property
    def roots(self) -> tuple[Instance, ...]:
        """The topmost nodes of the executed trees."""
        return tuple(instance for instance in self.instances if instance.parent is None)

    def automata_of(self, path: str) -> tuple[SystemAutomaton, ...]:
        """The automata of the machine in the file `path`."""
        return tuple(automaton for automaton in self.automata if automaton.path == path)

    @cached_property
    def has_timer(self) -> bool:
        return bool(self.instances) or any(a.outline.timers for a in self.automata)

    # ------------------------------------------------------------- channels

    @cached_property
    def topics(self) -> Mapping[str, Channel]:
        """The topics by sanitised name."""
        return self._channels(SymbolKind.PUBLISHER, SymbolKind.SUBSCRIBER, sanitise)

    @cached_property
    def services(self) -> Mapping[str, Channel]:
        """The services by name as written (docs/spec/ros.md#services)."""
        return self._channels(SymbolKind.SERVICE_SERVER, SymbolKind.SERVICE_CLIENT, str)

    @cached_property
    def actions(self) -> Mapping[str, Channel]:
        """The actions by name as written."""
        return self._channels(SymbolKind.ACTION_SERVER, SymbolKind.ACTION_CLIENT, str)

    def channels(self, kind: SymbolKind) -> Mapping[str, Channel]:
        """The channels of the kind `kind`: TOPIC, SERVICE or ACTION. Other kinds raise `ValueError`."""
        match kind:
            case SymbolKind.TOPIC:
                return self.topics
            case SymbolKind.SERVICE:
                return self.services
            case SymbolKind.ACTION:
                return self.actions
        raise ValueError(f"{kind} is not a kind of channel")

    def _channels(self, source: SymbolKind, user: SymbolKind, key: Callable[[str], str]) -> Mapping[str, Channel]:
        channels: dict[str, Channel] = {}
        for automaton in self.automata:
            for use in automaton.outline.interfaces:
                name = automaton.interface_name(use) if use.kind in (source, user) else None
                if name is not None:
                    channel = channels.setdefault(key(name), Channel(key(name)))
                    (channel.sources if use.kind is source else channel.users).append(ChannelEndpoint(automaton, use))
        return channels

    def channel(self, automaton: SystemAutomaton, use: InterfaceUse) -> Channel | None:
        """The topic, service or action of a declaration of an automaton; `None` if its name is unknown."""
        name = automaton.interface_name(use)
        if name is None:
            return None
        match use.kind:
            case SymbolKind.PUBLISHER | SymbolKind.SUBSCRIBER:
                return self.topics.get(sanitise(name))
            case SymbolKind.SERVICE_CLIENT | SymbolKind.SERVICE_SERVER:
                return self.services.get(name)
        return self.actions.get(name)

    # --------------------------------------------------------------- events

    @cached_property
    def events(self) -> Mapping[str, PlainEvent]:
        events: dict[str, PlainEvent] = {}
        for automaton in self.automata:
            for sent in automaton.outline.sent:
                events.setdefault(sent.event, PlainEvent(sent.event)).senders.append((automaton, sent))
            for received in automaton.outline.received:
                events.setdefault(received.event, PlainEvent(received.event)).receivers.append((automaton, received))
        return events

    def is_observed(self, event: str) -> bool:
        """Whether a property uses the flag or a parameter of the event."""
        names = self._sorted_observed
        following = bisect.bisect_left(names, f"{event}__")
        is_parameter = following < len(names) and names[following].startswith(f"{event}__")
        return is_parameter or flag_of(event) in self.observed

    @cached_property
    def _sorted_observed(self) -> Sequence[str]:
        return sorted(self.observed)

    @cached_property
    def event_data(self) -> Mapping[str, Struct]:
        return {name: event.data for name, event in self.events.items()}

    # ----------------------------------------------------------- blackboard

    @cached_property
    def blackboard(self) -> Mapping[str, tuple[BoundPort, ...]]:
        """Every blackboard variable with the ports that are bound to it."""
        bound_ports: dict[str, list[BoundPort]] = {}
        for automaton in self.automata:
            for port in automaton.outline.ports:
                value = automaton.port(port.key)
                if isinstance(value, Reference):
                    bound_ports.setdefault(value.variable, []).append(BoundPort(automaton, port))
        return {name: tuple(ports) for name, ports in bound_ports.items()}

    @cached_property
    def variables(self) -> Mapping[str, str]:
        """The variables of the blackboard with the names of their types."""
        if self.is_library_tree:
            return {name: entry.type for name, entry in self.entries.items()}
        return {name: self.variable_type(name) for name in self.blackboard}

    def writes_variable(self, name: str) -> bool:
        """Whether a node or script writes a variable of the blackboard."""
        if self.is_library_tree:
            return name in self.entries and self.entries[name].written
        return any(bound.port.written for bound in self.blackboard.get(name, ()))

    def reads_blackboard(self, tree: str) -> bool:
        """Whether a node or script reads a variable of the blackboard of the tree with the name `tree`."""
        if any(entry.read for name, entry in self.entries.items() if is_on_board(name, tree)):
            return True
        boards = (ports for name, ports in self.blackboard.items() if is_on_board(name, tree))
        return any(bound.port.read for ports in boards for bound in ports)

    def variable_type(self, variable: str) -> str:
        """The name of the type of a blackboard variable: the type of the first bound port that has a base type;
        `string` if there is none (docs/spec/trees.md#blackboard)."""
        types = (bound.port.type for bound in self.blackboard.get(variable, ()))
        return next((type_ for type_ in types if type_ in BASE_TYPES), "string")


# ------------------------------------------------------------ unreadable parts

_OF_TOPICS = (SymbolKind.PUBLISHER, SymbolKind.SUBSCRIBER)


def _fact(act: Act, name: str | None) -> Fact:
    is_topic = isinstance(act, InterfaceAct) and act.kind in _OF_TOPICS
    return act, sanitise(name) if name is not None and is_topic else name


def _is_about_events(act: Act) -> bool:
    return not act.is_of_field if isinstance(act, InterfaceAct) else act not in _BESIDE_EVENTS


def _readable_facts(automaton: SystemAutomaton) -> Iterator[Fact]:
    """The facts that the readable parts of an automaton contain."""
    for use in automaton.outline.interfaces:
        yield _fact(InterfaceAct(use.kind), automaton.interface_name(use))
    yield from ((GapAct.SENDS, sent.event) for sent in automaton.outline.sent)
    yield from ((GapAct.RECEIVES, received.event) for received in automaton.outline.received)


_PREFIXES = {
    SymbolKind.PUBLISHER: TOPIC_PREFIX,
    SymbolKind.SERVICE_CLIENT: SERVICE_PREFIX,
    SymbolKind.SERVICE_SERVER: SERVICE_PREFIX,
    SymbolKind.ACTION_CLIENT: ACTION_PREFIX,
    SymbolKind.ACTION_SERVER: ACTION_PREFIX,
}


def may_give_variable(act: Act, name: str | None, variable: str) -> bool:
    """Whether a gap with `act` and `name` may add the global variable `variable` to the translation (see
    `roaml.model.globals`)."""
    if isinstance(act, InterfaceAct):
        prefix = _PREFIXES.get(act.kind)
        if prefix is None:
            return False
        request = cancel_request(name or "")
        if prefix == ACTION_PREFIX and variable.startswith(
            request if name is None else (f"{request}.", f"{request}__")
        ):
            return True
        return variable.startswith(prefix if name is None else f"{prefix}{sanitise(name)}_")
    match act:
        case GapAct.ANYTHING:
            return True
        case GapAct.SENDS | GapAct.PARAMETER:
            if name is None:
                return not (is_interface_event(variable) or variable.startswith(TREE_PREFIX))
            return variable == flag_of(name) or variable.startswith(f"{name}__")
        case GapAct.TREE | GapAct.VARIABLE:
            return variable.startswith(TREE_PREFIX)
        case GapAct.NAME:
            return variable.startswith((SERVICE_PREFIX, ACTION_PREFIX, CANCEL_PREFIX))
        case GapAct.RECEIVES | GapAct.PORT | GapAct.REMAP | GapAct.NODE | GapAct.PLUGIN:
            return False
        case _:
            return assert_never(act)


# ---------------------------------------------------- nodes of BehaviorTree.CPP


@functools.cache
def builtin_plugins() -> Mapping[str, MachineOutline]:
    """The outlines of the nodes of BehaviorTree.CPP that AS2FM has, by name. The schema describes them."""
    return {
        element.name: _builtin(element)
        for element in BEHAVIOR_TREE.elements.values()
        if element.node
        and element.translated
        and not element.program_only
        and element.name not in (*EXPLICIT, *SUBTREES)
    }


@functools.cache
def library_plugins() -> Mapping[str, MachineOutline]:
    """The outlines of the nodes of libraries that can be executed as BehaviorTree.CPP executes them, by name
    (docs/spec/nodes.md#library)."""
    cpp = library(BEHAVIORTREE_CPP)
    known = dict(cpp.nodes)
    known |= {renamed.name: cpp.nodes[renamed.now] for renamed in cpp.renamed.values()}
    for name in LIBRARIES:
        nodes = library(name).nodes.items()
        known |= {node: of for node, of in nodes if of.kind in (NodeKind.CONTROL, NodeKind.DECORATOR)}
    return {name: _library_outline(name, node) for name, node in known.items()}


def _library_outline(name: str, node: Node) -> MachineOutline:
    ports = tuple(_library_port(port) for port in node.ports if not port.alias_of)
    has_children = node.kind in (NodeKind.CONTROL, NodeKind.DECORATOR)
    plugin = PluginOutline(True, True, True, True, 0, has_children, None, has_children)
    return MachineOutline(name, "ascxml", False, frozenset(), ports, (), (), (), (), (), plugin)


def _library_port(port: Port) -> PortOutline:
    if port.names_entry:  # the port itself does not read the entry
        return PortOutline(port.name, ANY_TYPE, Direction.IN, False, port.direction.writes)
    direction = Direction.OUT if port.direction is Direction.OUT else Direction.IN
    return PortOutline(port.name, ANY_TYPE, direction, port.direction.reads, port.direction.writes)


def _builtin(element: ElementType) -> MachineOutline:
    has_children = element.any_child is not None
    ports = tuple(
        PortOutline(a.name, a.port.type, a.port.direction, a.port.direction.reads, a.port.direction.writes)
        for a in element.ports
        if a.port
    )
    plugin = PluginOutline(True, True, True, True, 0, has_children, None, has_children)
    return MachineOutline(element.name, "ascxml", False, frozenset(), ports, (), (), (), (), (), plugin)
