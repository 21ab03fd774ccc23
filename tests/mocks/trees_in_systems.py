# SPDX-License-Identifier: Apache-2.0
"""Random trees inside a system: the leaves of the program are plugins, made of mocks."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from fractions import Fraction

from random_trees import ENTRIES, Drawn, as_xml, is_program_leaf
from translated_trees import CODES, Observed

from roaml import api
from roaml.jani.model import Model
from roaml.jani.typecheck import check_model
from roaml.mocks.mock import Mock
from roaml.mocks.plugin import mock_plugin
from roaml.model.expand import ROOT_NUMBER
from roaml.record import replace
from roaml.scxml.names import sent_by
from roaml.smc.model import ModelChecker
from roaml.smc.record import Recorder, Recording
from roaml.verification.tree_outcome import tree_properties

RATE = Fraction(10)
FOLDER = "/trees"
_EVENT = re.compile(r"bt_(\d+)_((?:inner\d*_)?)(tick|response|halt_response|halt)")


def files(drawn: Drawn, ticks: int) -> dict[str, str]:
    """The files of a system with the tree; `Act<n>` is RUNNING for n ticks."""
    # A `SubTree` gives the entries their first values. Its top node has the number 1000.
    inner = as_xml(drawn).replace('BehaviorTree ID="Main"', 'BehaviorTree ID="Inner"')
    values = "".join(f' {entry}="{value}"' for entry, value in ENTRIES.items())
    outer = f'<BehaviorTree ID="Main"><SubTree ID="Inner"{values}/></BehaviorTree></root>'
    types = {"Check": 0, **{f"Act{n}": n for n in range(4)}}
    plugins = {
        f"{FOLDER}/{name}.ascxml": mock_plugin(
            name, Mock(name, 0.6, Fraction(100 * duration)), RATE, is_condition=name == "Check"
        )
        for name, duration in types.items()
        if name in inner
    }
    listed = "".join(f'<input type="bt-plugin-ascxml" src="{path.rpartition("/")[2]}"/>' for path in plugins)
    main = (
        f'<roaml><parameters><max_time value="{100 * ticks + 50}" unit="ms"/>'
        f'<bt_tick_rate value="{RATE}"/></parameters>'
        f'<behavior_tree><input type="bt.cpp-xml" src="tree.xml"/>{listed}</behavior_tree>'
        '<properties><input type="jani" src="properties.jani"/></properties></roaml>'
    )
    tree = inner.replace("</root>", outer)
    return {
        f"{FOLDER}/main.xml": main,
        f"{FOLDER}/tree.xml": tree,
        f"{FOLDER}/properties.jani": '{"properties": []}',
        **plugins,
    }


def translated(drawn: Drawn, ticks: int) -> Model:
    model = api.to_jani(api.load(f"{FOLDER}/main.xml", texts=files(drawn, ticks)))
    assert list(check_model(model)) == []
    return model


def leaves_of(drawn: Drawn) -> dict[int, tuple[str, str]]:
    """Number -> name and type of the leaves of the program. A `<SubTree>` has no number."""
    numbers, names = itertools.count(1000), itertools.count()

    def walk(node: Drawn) -> Iterator[tuple[int, tuple[str, str]]]:
        name = f"leaf{next(names)}"
        number = next(numbers) if node.type != "SubTree" else 0
        if is_program_leaf(node):
            yield number, (name, node.type)
        for child in node.children:
            yield from walk(child)

    return dict(walk(drawn))


def observe_system(drawn: Drawn, model: Model, seed: int) -> Observed:
    """One run of the translated system."""
    model = replace(model, properties=tree_properties(ROOT_NUMBER))
    checker = ModelChecker(model, model.properties[:1])
    recorder = Recorder(checker, checker.compiled_properties[0], seed, 40_000)
    status = {storage.name: storage for storage in recorder.shared if storage.name.endswith("_response__status")}
    leaves = leaves_of(drawn)
    # A leaf is behind its conditions and those of the subtrees whose top it is.
    innermost: dict[int, str] = {}
    for name in sorted(status, key=len):
        if (responding := _EVENT.fullmatch(name.removesuffix("__status"))) is not None:
            innermost[int(responding[1])] = responding[2]
    state = dict.fromkeys(leaves, "IDLE")
    seen = Observed([], [], {name: [] for name, _ in leaves.values()}, False)
    for step in recorder.walk(Recording(0)):
        match = _EVENT.fullmatch(sent_by(step.action or ""))
        if match is None:
            continue
        number, where, what = int(match[1]), match[2], match[3]
        answer = ""
        if what == "response":
            code = recorder.values([status[f"bt_{number}_{where}response__status"]])[0]
            assert isinstance(code, int)
            answer = CODES[code]
        if number in leaves and where == innermost[number]:
            name, type_ = leaves[number]
            if what == "halt":
                if state[number] == "RUNNING":
                    seen.calls.append((name, "halt"))
                state[number] = "IDLE"
            elif what == "response":
                if type_ == "Check" or state[number] not in ("SUCCESS", "FAILURE"):
                    seen.calls.append((name, answer))
                    if answer != "RUNNING":
                        seen.outcomes[name].append(answer)
                state[number] = answer
        if number == 1000 and not where:
            if what == "tick":
                seen.is_stuck = True
            elif what == "response":
                seen.answers.append(answer)
                seen.is_stuck = False
    return seen
