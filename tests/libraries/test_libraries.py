# SPDX-License-Identifier: Apache-2.0
"""The nodes of the libraries are complete and consistent, and equal those of the schema."""

from __future__ import annotations

from roaml.language import BEHAVIOR_TREE
from roaml.libraries import BEHAVIORTREE_CPP, LIBRARIES, library
from roaml.libraries.version import first_patch
from roaml.roles import Direction, NodeKind

CPP = library(BEHAVIORTREE_CPP)
NAV2 = library("nav2")

REGISTERED = (
    *("Sequence", "Fallback", "AsyncSequence", "AsyncFallback", "SequenceWithMemory", "ReactiveSequence"),
    *("ReactiveFallback", "Parallel", "ParallelAll", "IfThenElse", "WhileDoElse", "Switch2", "Switch3", "Switch4"),
    *("Switch5", "Switch6", "TryCatch", "Inverter", "ForceSuccess", "ForceFailure", "Repeat", "RetryUntilSuccessful"),
    *("KeepRunningUntilFailure", "Delay", "Timeout", "RunOnce", "Precondition", "LoopInt", "LoopBool", "LoopDouble"),
    *("LoopString", "SkipUnlessUpdated", "WaitValueUpdate", "AlwaysSuccess", "AlwaysFailure", "Sleep", "Script"),
    *("ScriptCondition", "SetBlackboard", "UnsetBlackboard", "WasEntryUpdated"),
)
"""The nodes that BehaviorTree.CPP 4.10 registers, except `SubTree`."""


def test_all_registered_nodes_are_known() -> None:
    newest = first_patch(CPP.version)
    newer = {node.name for node in CPP.nodes.values() if node.since and first_patch(node.since) > newest}
    assert {node.name for node in CPP.nodes.values() if not node.until} - newer == set(REGISTERED)


def test_nav2_has_its_nodes() -> None:
    kinds = [node.kind for node in NAV2.nodes.values()]
    counts = {kind: kinds.count(kind) for kind in set(kinds)}
    assert counts == {NodeKind.CONTROL: 6, NodeKind.DECORATOR: 7, NodeKind.ACTION: 49, NodeKind.CONDITION: 20}
    assert not NAV2.nodes.keys() & CPP.nodes.keys()


def test_every_node_and_port_has_a_text() -> None:
    for name in (BEHAVIORTREE_CPP, *LIBRARIES):
        for node in library(name).nodes.values():
            assert node.text, node.name
            assert all(port.text and port.type for port in node.ports), node.name
            assert len({port.name for port in node.ports}) == len(node.ports)


def test_defaults_are_of_ports_that_are_read() -> None:
    for node in (*CPP.nodes.values(), *NAV2.nodes.values()):
        for port in node.ports:
            assert port.default is None or (port.direction is Direction.IN and not port.required), (node.name, port)


def test_other_names_lead_to_nodes() -> None:
    assert all(name.now in CPP.nodes for name in CPP.renamed.values())
    instead = {absent.instead: absent.reason for absent in CPP.absent.values() if absent.instead}
    assert all(name in CPP.nodes and f"`{name}`" in reason for name, reason in instead.items())
    assert not CPP.nodes.keys() & (CPP.absent.keys() | CPP.renamed.keys())


def test_the_schema_has_the_same_nodes() -> None:
    for node in CPP.nodes.values():
        element = BEHAVIOR_TREE.elements[node.name]
        count = element.any_child
        assert element.node is node.kind
        assert ((count.least, count.most) if count else (0, 0)) == node.children
        assert {attribute.name for attribute in element.attributes.values() if attribute.port} == set(node.port_by_name)
