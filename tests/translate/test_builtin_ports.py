# SPDX-License-Identifier: Apache-2.0
"""Where the ports of built-in nodes get their values from: constants, the blackboard, subtrees and tree models."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace

import bt_model
import bt_runs
import pytest
from bt_cases import cases, gated
from bt_trees import Setup, Tree, leaf, node, system, writer
from translating import FOLDER, errors, lowered

from roaml.diagnostics import Diagnostic
from roaml.language import BEHAVIOR_TREE
from roaml.model.outline import PortOutline
from roaml.model.system import builtin_plugins
from roaml.roles import Direction

SETUP = Setup(12)
VARIABLE_OF = {"int8": "few", "uint8": "least", "int32": "n", "uint32": "msec", "bool": "yes", "any": "n"}
EXAMPLES = {part.kind: part for tree in reversed(list(cases())) for part in tree.walk()}
PORTS = [
    (kind, port)
    for kind, plugin in builtin_plugins().items()
    for port in plugin.ports
    if port.direction is Direction.IN
]


def in_tree(diagnostics: Sequence[Diagnostic], text: str) -> list[str]:
    """What the findings are about; all are in the tree."""
    assert {d.path for d in diagnostics} <= {os.path.join(FOLDER, "tree.xml")}
    return [text[d.span.start : d.span.end] for d in diagnostics]


def same_steps(files: dict[str, str], tree: Tree) -> None:
    assert bt_runs.of_network(lowered(files), seed=1)[0] == bt_model.run(tree, SETUP)


@pytest.mark.parametrize(("kind", "port"), PORTS, ids=lambda value: getattr(value, "key", value))
def test_port_bound_to_the_blackboard(kind: str, port: PortOutline) -> None:
    """The node reads the variable, or there is an error at the value: it never comes to a translation that is none."""
    value = f"{{{VARIABLE_OF[port.type]}}}"
    plain = EXAMPLES[kind]
    tree = gated(replace(plain, ports=tuple({**dict(plain.ports), port.key: value}.items())))
    files = system(tree, SETUP)
    diagnostics = errors(files)
    role = next(a.port for a in BEHAVIOR_TREE.elements[kind].ports if a.name == port.key)
    assert role is not None
    if role.constant:
        assert [d.code for d in diagnostics] == ["node-configuration"]
        assert in_tree(diagnostics, files["tree.xml"]) == [value]
    else:
        same_steps(files, tree)


WORKER = leaf("RSF")
WORKER_TAG = "Leaf_3_1_2"


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        pytest.param(
            f"""<BehaviorTree ID="Main">
                    <Parallel><SubTree ID="Do" times="1"/><SubTree ID="Do" times="2"/></Parallel>
                </BehaviorTree>
                <BehaviorTree ID="Do"><Repeat num_cycles="{{times}}"><{WORKER_TAG}/></Repeat></BehaviorTree>""",
            node("Parallel", *(node("Repeat", WORKER, num_cycles=n) for n in (1, 2))),
            id="constants of a subtree",
        ),
        pytest.param(
            f"""<BehaviorTree ID="Main">
                    <Sequence>
                        <Writer_int32_1_2_3 to="{{n}}"/>
                        <SubTree ID="Check" seen="{{n}}" wanted="1"/>
                        <SubTree ID="Check" seen="2" wanted="{{n}}"/>
                    </Sequence>
                </BehaviorTree>
                <BehaviorTree ID="Check">
                    <BlackboardCheckInt value_A="{{seen}}" value_B="{{wanted}}" return_on_mismatch="1">
                        <{WORKER_TAG}/>
                    </BlackboardCheckInt>
                </BehaviorTree>""",
            node(
                "Sequence",
                writer("n", 1, 2, 3),
                node("BlackboardCheckInt", WORKER, value_A="{n}", value_B=1, return_on_mismatch=1),
                node("BlackboardCheckInt", WORKER, value_A=2, value_B="{n}", return_on_mismatch=1),
            ),
            id="remapped variables",
        ),
        pytest.param(
            """<BehaviorTree ID="Main">
                    <Sequence>
                        <SetBlackboard value="1" output_key="{n}"/>
                        <SubTree ID="Own"/>
                        <BlackboardCheckInt value_A="{n}" value_B="1" return_on_mismatch="2">
                            <AlwaysSuccess/>
                        </BlackboardCheckInt>
                    </Sequence>
                </BehaviorTree>
                <BehaviorTree ID="Own">
                    <Sequence>
                        <SetBlackboard value="7" output_key="{n}"/>
                        <BlackboardCheckInt value_A="{n}" value_B="{@n}" return_on_mismatch="1">
                            <AlwaysFailure/>
                        </BlackboardCheckInt>
                    </Sequence>
                </BehaviorTree>""",
            node(
                "Sequence",
                node("SetBlackboard", value=1, output_key="{n}"),
                node(
                    "Sequence",
                    node("SetBlackboard", value=7, output_key="{m}"),
                    node(
                        "BlackboardCheckInt", node("AlwaysFailure"), value_A="{m}", value_B="{n}", return_on_mismatch=1
                    ),
                ),
                node("BlackboardCheckInt", node("AlwaysSuccess"), value_A="{n}", value_B=1, return_on_mismatch=2),
            ),
            id="a variable of the subtree alone",
        ),
        pytest.param(
            """<BehaviorTree ID="Main">
                    <Sequence>
                        <SubTree ID="Own" _autoremap="true"/>
                        <BlackboardCheckInt value_A="{n}" value_B="7" return_on_mismatch="2">
                            <AlwaysSuccess/>
                        </BlackboardCheckInt>
                    </Sequence>
                </BehaviorTree>
                <BehaviorTree ID="Own"><SetBlackboard value="7" output_key="{n}"/></BehaviorTree>""",
            node(
                "Sequence",
                node("SetBlackboard", value=7, output_key="{n}"),
                node("BlackboardCheckInt", node("AlwaysSuccess"), value_A="{n}", value_B=7, return_on_mismatch=2),
            ),
            id="automatic remapping",
        ),
        pytest.param(
            f"""<TreeNodesModel>
                    <Decorator ID="Repeat"><input_port name="num_cycles" default="3"/></Decorator>
                </TreeNodesModel>
                <BehaviorTree ID="Main"><Inverter><Repeat><{WORKER_TAG}/></Repeat></Inverter></BehaviorTree>""",
            node("Inverter", node("Repeat", WORKER, num_cycles=3)),
            id="defaults of a tree model",
        ),
        pytest.param(
            f"""<BehaviorTree ID="Main">
                    <Control ID="Fallback">
                        <Decorator ID="Inverter"><Action ID="{WORKER_TAG}"/></Decorator>
                        <Condition ID="AlwaysFailure"/>
                    </Control>
                </BehaviorTree>""",
            node("Fallback", node("Inverter", WORKER), node("AlwaysFailure")),
            id="explicit spelling",
        ),
    ],
)
def test_written_otherwise(text: str, tree: Tree) -> None:
    """Another way to write a tree takes the same steps."""
    written = f'<root BTCPP_format="4" main_tree_to_execute="Main">{text}</root>'
    same_steps({**system(tree, SETUP), "tree.xml": written}, tree)


@pytest.mark.parametrize("kind", [e.name for e in BEHAVIOR_TREE.elements.values() if e.node and not e.translated])
def test_node_that_cannot_be_translated(kind: str) -> None:
    element = BEHAVIOR_TREE.elements[kind]
    ports = {a.name: "1" for a in element.ports}
    files = system(node("Sequence", node(kind, *[leaf("S")] * (element.any_child is not None), **ports)), SETUP)
    assert kind in in_tree(errors(files), files["tree.xml"])
