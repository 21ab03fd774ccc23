# SPDX-License-Identifier: Apache-2.0
"""Behavior trees as data, and the HL-SCXML systems that they are written as.

The leaves are plugins that follow scripts. `Leaf` answers to its ticks what its script says, beginning again at its
end, and counts its ticks and halts; `Writer` writes the values of its script to a blackboard variable and succeeds.
Leaves of the same script are instances of the same plugin.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from xml.sax.saxutils import quoteattr

VARIABLES = {
    "n": "int32",
    "m": "int32",
    "msec": "uint32",
    "few": "int8",
    "least": "uint8",
    "yes": "bool",
    "word": "string",
}
"""The blackboard variables that trees may use, and their types."""

LEAF, WRITER = "Leaf", "Writer"


@dataclass(frozen=True)
class Tree:
    """A node with all below it.

    Attributes:
        kind: name of the node in BehaviorTree.CPP, `Leaf` or `Writer`.
        ports: key -> text, as in the tree's XML.
        script: of a leaf, its answers as numbers; of a writer, the values.
        apart: it is written as a tree of its own, which a `<SubTree>` stands for.
    """

    kind: str
    ports: tuple[tuple[str, str], ...] = ()
    children: tuple[Tree, ...] = ()
    script: tuple[str, ...] = ()
    apart: bool = False

    def walk(self) -> Iterator[Tree]:
        yield self
        for child in self.children:
            yield from child.walk()

    @property
    def variables(self) -> frozenset[str]:
        """The blackboard variables of all ports."""
        return frozenset(text[1:-1] for node in self.walk() for _, text in node.ports if is_reference(text))


def node(kind: str, *children: Tree, **ports: object) -> Tree:
    return Tree(kind, tuple((key, str(value)) for key, value in ports.items()), children)


def leaf(script: str) -> Tree:
    """`script` has an `S`, `F` or `R` for each answer."""
    return Tree(LEAF, script=tuple(str("SFR".index(letter) + 1) for letter in script))


def writer(variable: str, *values: object) -> Tree:
    return Tree(WRITER, (("to", f"{{{variable}}}"),), script=tuple(map(str, values)))


def is_reference(text: str) -> bool:
    return text.startswith("{")


@dataclass(frozen=True)
class Setup:
    """How a tree is executed.

    Attributes:
        ticks: how often, at most.
        rate: in Hz.
        goes_on: it is ticked again after its root has answered SUCCESS or FAILURE.
    """

    ticks: int
    rate: Fraction = Fraction(1)
    goes_on: bool = True


# ----------------------------------------------------------------------- texts


def system(tree: Tree, setup: Setup) -> dict[str, str]:
    """File name -> text; the system file is `main.xml`."""
    plugins = {f"{plugin_name(node)}.ascxml": plugin(node) for node in tree.walk() if node.script}
    return {"tree.xml": tree_file(tree), **plugins, **main(plugins, setup), "properties.jani": '{"properties": []}'}


def main(plugins: Iterable[str], setup: Setup) -> dict[str, str]:
    inputs = "".join(f'<input type="bt-plugin-ascxml" src="{file}"/>' for file in plugins)
    milliseconds = setup.ticks / setup.rate * 1000
    assert milliseconds.denominator == 1
    text = (
        f'<roaml><parameters><max_time value="{milliseconds}" unit="ms"/><bt_tick_rate value="{float(setup.rate)}"/>'
        f'<bt_tick_if_not_running value="{"true" if setup.goes_on else "false"}"/></parameters>'
        f'<behavior_tree tree-semantics="as2fm"><input type="bt.cpp-xml" src="tree.xml"/>{inputs}</behavior_tree>'
        '<properties><input type="jani" src="properties.jani"/></properties></roaml>'
    )
    return {"main.xml": text}


def tree_file(tree: Tree) -> str:
    """The parts in subtrees of their own use other names for the variables."""
    trees: list[str] = []

    def written(part: Tree, names: Mapping[str, str]) -> str:
        if part.apart:
            inner = {variable: f"its_{names.get(variable, variable)}" for variable in sorted(part.variables)}
            remapped = _attributes((name, f"{{{names.get(variable, variable)}}}") for variable, name in inner.items())
            content = element(part, inner)
            trees.append(content)
            return f'<SubTree ID="Part{len(trees)}"{remapped}/>'
        return element(part, names)

    def element(part: Tree, names: Mapping[str, str]) -> str:
        tag = plugin_name(part) if part.script else part.kind
        ports = (
            (key, f"{{{names.get(text[1:-1], text[1:-1])}}}" if is_reference(text) else text)
            for key, text in part.ports
        )
        return f"<{tag}{_attributes(ports)}>{''.join(written(child, names) for child in part.children)}</{tag}>"

    outermost = written(tree, {})
    parts = "".join(f'<BehaviorTree ID="Part{i + 1}">{text}</BehaviorTree>' for i, text in enumerate(trees))
    return (
        f'<root BTCPP_format="4" main_tree_to_execute="Main"><BehaviorTree ID="Main">{outermost}</BehaviorTree>'
        f"{parts}</root>"
    )


def _attributes(values: Iterable[tuple[str, str]]) -> str:
    return "".join(f" {key}={quoteattr(text)}" for key, text in values)


def plugin_name(part: Tree) -> str:
    words = (part.kind, *([type_of(part)] if part.kind == WRITER else []), *part.script)
    return "_".join(words).replace("-", "minus")


def type_of(part: Tree) -> str:
    return VARIABLES[dict(part.ports)["to"][1:-1]]


def plugin(part: Tree) -> str:
    return scripted_writer(part) if part.kind == WRITER else scripted_leaf(part)


def scripted_leaf(part: Tree) -> str:
    count = len(part.script)
    return f"""
<ascxml name="{plugin_name(part)}" version="1.0" initial="ready">
    <datamodel>
        <data id="answers" type="int8[{count}]" expr="[{", ".join(part.script)}]"/>
        <data id="answer" type="int8" expr="0"/>
        <data id="ticks" type="int16" expr="0"/>
        <data id="halts" type="int16" expr="0"/>
    </datamodel>
    <state id="ready">
        <bt_tick target="ready">
            <assign location="answer" expr="answers[ticks % {count}]"/>
            <assign location="ticks" expr="ticks + 1"/>
            <bt_return_status status="answer"/>
        </bt_tick>
        <bt_halt target="ready">
            <assign location="halts" expr="halts + 1"/>
            <bt_return_halted/>
        </bt_halt>
    </state>
</ascxml>
"""


def scripted_writer(part: Tree) -> str:
    type_, count = type_of(part), len(part.script)
    literals = [f"'{value}'" if type_ == "string" else value for value in part.script]
    choices = "".join(
        f'<{"elseif" if i else "if"} cond="next == {i}"{"/" if i else ""}>'
        f'<bt_set_output key="to" expr={quoteattr(literal)}/>'
        for i, literal in enumerate(literals)
    )
    return f"""
<ascxml name="{plugin_name(part)}" version="1.0" initial="ready">
    <bt_declare_port_out key="to" type="{type_}"/>
    <datamodel><data id="next" type="int16" expr="0"/></datamodel>
    <state id="ready">
        <bt_tick target="ready">
            {choices}</if>
            <assign location="next" expr="(next + 1) % {count}"/>
            <bt_return_status status="SUCCESS"/>
        </bt_tick>
        <bt_halt target="ready"><bt_return_halted/></bt_halt>
    </state>
</ascxml>
"""
