# SPDX-License-Identifier: Apache-2.0
"""Names that subtrees take from each other (docs/spec/trees.md#subtrees)."""

from __future__ import annotations

from roaml.model.expand import StrayRemap, TreeFileOutline, expand, stray_remaps, tree_file_outline
from roaml.model.tree import build_tree_file
from roaml.xml_syntax import parse


def outline(*trees: str) -> tuple[TreeFileOutline, ...]:
    text = "".join(f'<BehaviorTree ID="T{number}">{tree}</BehaviorTree>' for number, tree in enumerate(trees))
    file = build_tree_file(parse(f'<root BTCPP_format="4" main_tree_to_execute="T0">{text}</root>'))
    assert file is not None
    return (tree_file_outline("tree.xml", file),)


def strays(*trees: str) -> list[StrayRemap]:
    return list(stray_remaps(outline(*trees)))


def test_a_name_may_be_used_any_number_of_subtrees_further_in() -> None:
    inner = [f'<SubTree ID="T{number}" _autoremap="true" />' for number in range(2, 300)]
    assert strays('<SubTree ID="T1" goal="1" />', *inner, '<Script code="goal := 1" />') == []
    (stray,) = strays('<SubTree ID="T1" gaol="1" />', *inner, '<Script code="goal := 1" />')
    assert (stray.key, stray.meant, stray.names) == ("gaol", ("goal",), ("goal",))


def test_only_automatic_remapping_takes_names_along() -> None:
    assert [s.key for s in strays('<SubTree ID="T1" goal="1" />', '<SubTree ID="T2" />', '<X port="{goal}" />')] == [
        "goal"
    ]


def test_subtrees_that_contain_each_other_have_the_same_names() -> None:
    around = '<Sequence><SubTree ID="T{}" _autoremap="true" /><X a="{{{}}}" /></Sequence>'
    trees = (
        '<SubTree ID="T1" x="1" y="1" z="1" />',
        around.format(2, "x"),
        around.format(3, "y"),
        around.format(1, "z"),
    )
    assert strays(*trees) == []
    assert [s.names for s in strays(trees[0].replace("z", "w"), *trees[1:])] == [("z",)]


def test_automatic_remapping_leads_to_the_outermost_tree_that_uses_the_name() -> None:
    through = '<SubTree ID="T{}" _autoremap="true" />'
    sequence = '<Sequence><X a="{{goal}}" />{}</Sequence>'
    trees = outline(
        through.format(1), sequence.format(through.format(2)), sequence.format(through.format(3)), '<X a="{other}" />'
    )
    bound = [dict(instance.ports)["a"] for instance in expand(trees).instances if instance.plugin == "X"]
    assert [value.variable for value in bound if hasattr(value, "variable")] == [
        "T1__goal",
        "T1__goal",
        "T1__T2__T3__other",
    ]
