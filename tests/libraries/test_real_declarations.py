# SPDX-License-Identifier: Apache-2.0
"""The declarations of nodes agree with BehaviorTree.CPP itself (4.8, by `behaviortreepy`): with the manifests of the
nodes that it registers, which a log of a tree contains, and with what the nodes do.

There are wheels of `behaviortreepy` for some platforms only. Without it, this file reports this and has no test.
"""

from __future__ import annotations

import functools
import itertools
import os
import tempfile
from importlib import util
from typing import Any, NamedTuple

import pytest
from lxml import etree

from roaml.libraries import BEHAVIORTREE_CPP, library
from roaml.libraries.node import Node, Port
from roaml.libraries.version import Version, first_patch
from roaml.roles import Direction, NodeKind

JUDGE = Version(4, 8, 2)
"""The version of BehaviorTree.CPP that `behaviortreepy` binds."""
TYPES = {
    "int": {"int"},
    "unsigned int": {"unsigned"},
    "bool": {"bool"},
    "double": {"double"},
    "std::string": {"string", "script"},
    "BT::NodeStatus": {"NodeStatus"},
    "BT::AnyTypeAllowed": {"any", "script"},
    "BT::Any": {"any"},
    **{
        f"std::shared_ptr<std::deque<{type_}, std::allocator<{type_}> > >": {f"queue<{name}>"}
        for type_, name in (("int", "int"), ("bool", "bool"), ("double", "double"), ("std::string", "string"))
    },
}
"""C++ type of a port -> the types that declare it. Scripts are texts in C++."""
VALUES = {
    **dict.fromkeys(("delay_msec", "msec"), "1000"),
    **dict.fromkeys(("num_cycles", "num_attempts"), "2"),
    **dict.fromkeys(("if", "code"), "true"),
    **dict.fromkeys(("entry", "key"), "x"),
    "output_key": "made",
}
"""Port -> a value; that of other ports is 1."""
LOOPS = {"queue<int>": "1;2", "queue<bool>": "true;false", "queue<double>": "0.5;1", "queue<string>": "a;b"}
MAX_CHILDREN = 9

NODES = {
    node.name: node
    for node in library(BEHAVIORTREE_CPP).nodes.values()
    if not node.until and not (node.since and first_patch(node.since) > JUDGE)
}
PORTS = [(node, port) for node in NODES.values() for port in node.ports if not port.alias_of]
PORT_IDS = [f"{node.name}.{port.name}" for node, port in PORTS]


class Run(NamedTuple):
    """What a tree does: the statuses of its root or the text of an error, the entries afterwards, and how often the
    leaves were ticked."""

    answer: tuple[str, ...] | str
    entries: tuple[str, ...] = ()
    ticks: int = 0

    @property
    def is_error(self) -> bool:
        return isinstance(self.answer, str)


def attributes(node: Node, **others: str | None) -> str:
    """The ports of a node that have no default, and `others`; those that are `None` are left out."""
    values: dict[str, str | None] = {
        port.name: LOOPS.get(port.type, VALUES.get(port.name, "1"))
        for port in node.ports
        if port.default is None and not port.alias_of and port.direction is not Direction.OUT
    }
    return "".join(f" {name}='{value}'" for name, value in {**values, **others}.items() if value is not None)


def run(library_: Any, node: Node, children: int, outcomes: tuple[str, ...] = (), **ports: str | None) -> Run:
    """Tick a node once. Its leaves return `outcomes`, and then SUCCESS; the entry `x` exists."""
    factory, blackboard = library_.BehaviorTreeFactory(), library_.Blackboard.create()
    blackboard.set_int("x", 1)
    left, ticks = list(outcomes), []

    def answer(_: object) -> Any:
        ticks.append(1)
        return getattr(library_.NodeStatus, left.pop(0) if left else "SUCCESS")

    factory.register_simple_condition("Leaf", answer)
    body = f"<{node.name}{attributes(node, **ports)}>{'<Leaf/>' * children}</{node.name}>"
    try:
        factory.register_behavior_tree_from_text(
            f'<root BTCPP_format="4"><BehaviorTree ID="Main">{body}</BehaviorTree></root>'
        )
        tree = factory.create_tree("Main", blackboard)
        return Run((tree.tick_exactly_once().name,), tuple(sorted(blackboard.get_keys())), len(ticks))
    except RuntimeError as error:
        return Run(str(error))


if util.find_spec("behaviortreepy") is None:
    print("behaviortreepy is not installed: BehaviorTree.CPP itself does not judge the declarations of nodes")
else:
    import behaviortreepy as real

    @functools.cache
    def manifests() -> dict[str, etree._Element]:
        """The nodes that the library registers, with their ports, from the head of a log."""
        factory = real.BehaviorTreeFactory()
        tree = factory.create_tree_from_text(
            '<root BTCPP_format="4"><BehaviorTree ID="Main"><AlwaysSuccess/></BehaviorTree></root>'
        )
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "log.btlog")
            logger = real.FileLogger(tree, path)
            del logger
            with open(path, "rb") as file:
                text = file.read()
        models = etree.fromstring(text[text.index(b"<root") : text.index(b"</root>") + 7]).find("TreeNodesModel")
        return {model.get("ID"): model for model in models if model.tag != "SubTree"}

    def test_nodes_and_their_kinds() -> None:
        kinds = {name: NodeKind(model.tag.lower()) for name, model in manifests().items()}
        assert {node.name: node.kind for node in NODES.values()} == kinds

    @pytest.mark.parametrize("name", NODES)
    def test_ports(name: str) -> None:
        declared = {port.name: port for port in NODES[name].ports if not port.alias_of}
        registered = {port.get("name"): port for port in manifests()[name]}
        assert declared.keys() == registered.keys()
        for key, port in declared.items():
            real_port = registered[key]
            directions = {"input_port": Direction.IN, "output_port": Direction.OUT, "inout_port": Direction.INOUT}
            assert port.direction is directions[real_port.tag], key
            assert port.default == real_port.get("default"), key
            assert port.type in TYPES[real_port.get("type")], key

    @pytest.mark.parametrize("name", NODES)
    def test_numbers_of_children(name: str) -> None:
        node = NODES[name]
        least, most = node.children
        accepted = [count for count in range(MAX_CHILDREN + 1) if not run(real, node, count).is_error]
        assert accepted == list(range(least, min(most, MAX_CHILDREN) + 1))

    @pytest.mark.parametrize(("node", "port"), PORTS, ids=PORT_IDS)
    def test_ports_that_must_be_set(node: Node, port: Port) -> None:
        """Without some of them, the library throws an exception. A switch without a variable takes its last child."""
        assert port.required or not run(real, node, node.children[0], **{port.name: None}).is_error

    @pytest.mark.parametrize(("node", "port"), PORTS, ids=PORT_IDS)
    def test_ports_with_scripts(node: Node, port: Port) -> None:
        if port.type in ("string", "any", "script"):
            tried = run(real, node, node.children[0], **{port.name: "1 +"})
            assert ("while parsing" in tried.answer) == (port.type == "script")

    @pytest.mark.parametrize(("node", "port"), PORTS, ids=PORT_IDS)
    def test_ports_that_name_an_entry(node: Node, port: Port) -> None:
        """The names of an entry that exists and of one that does not make a difference, without braces."""
        if port.type in ("string", "any"):
            there, missing = (run(real, node, node.children[0], **{port.name: name}) for name in ("x", "other"))
            assert (there != missing) == port.names_entry

    @pytest.mark.parametrize(("node", "port"), PORTS, ids=PORT_IDS)
    def test_ports_that_count_children(node: Node, port: Port) -> None:
        """-1 is the number of children, and -2 is one less."""
        if port.type == "int" and port.direction is Direction.IN:
            count = max(node.children[0], 3) if node.kind is NodeKind.CONTROL else 1
            outcomes = itertools.product(("SUCCESS", "FAILURE"), repeat=3)
            same = all(
                run(real, node, count, drawn, **{port.name: str(-back)})
                == run(real, node, count, drawn, **{port.name: str(count + 1 - back)})
                for drawn in outcomes
                for back in (1, 2)
            )
            assert same == (port.limits is not None and port.limits.counts_children)

    @pytest.mark.parametrize(("node", "port"), PORTS, ids=PORT_IDS)
    def test_least_useful_numbers(node: Node, port: Port) -> None:
        """With smaller numbers, the child is never ticked."""
        if port.limits is not None and port.limits.minimum is not None:
            failing = ("FAILURE",) * 2
            numbers = [
                number for number in range(-1, 4) if run(real, node, 1, failing, **{port.name: str(number)}).ticks
            ]
            assert numbers == [*sorted(port.limits.special), *range(int(port.limits.minimum), 4)]

    def test_leaves_that_are_running_at_first() -> None:
        told = {node.name: node.running for node in NODES.values() if node.running is not None}
        seen = {name: run(real, NODES[name], NODES[name].children[0]).answer == ("RUNNING",) for name in told}
        assert seen == told
        assert {node.name for node in NODES.values() if node.children == (0, 0)} <= told.keys()
