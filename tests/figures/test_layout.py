# SPDX-License-Identifier: Apache-2.0
"""Layouts of random graphs and trees: nothing overlaps, lines end at their nodes and cross nothing else."""

from __future__ import annotations

import random
from itertools import combinations, pairwise

import pytest
from hypothesis import given, settings

import kept_strategies as st
from examples import examples
from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout import Boxes, Layout, LayoutDirection, Link, layered, nested, outline, tidy_tree
from roaml.figures.layout.layers import assign_layers
from roaml.figures.layout.order import crossings
from roaml.figures.layout.spread import spread
from roaml.figures.layout.straight import Straightening
from roaml.figures.layout.tracks import assign_tracks
from roaml.figures.layout.vertices import Vertex, VertexKind

NEAR = 0.05
SIZES = st.builds(Extent, st.integers(8, 300), st.integers(8, 200))
DIRECTIONS = st.sampled_from(list(LayoutDirection))


@st.composite
def graphs(draw: st.DrawFn) -> tuple[dict[str, Extent], list[Link]]:
    names = [str(number) for number in range(draw(st.integers(1, 10)))]
    nodes = {name: draw(SIZES) for name in names}
    pairs = [(source, target) for source in names for target in names if source != target]
    ends = draw(st.lists(st.sampled_from(pairs), max_size=2 * len(names))) if pairs else []
    return nodes, [Link(source, target, draw(st.none() | SIZES)) for source, target in ends]


def segments(layout: Layout) -> list[tuple[int, Point, Point]]:
    return [
        (number, a, b) for number, route in enumerate(layout.routes) for part in route.parts for a, b in pairwise(part)
    ]


def area(a: Point, b: Point) -> Box:
    return Box(min(a.x, b.x), min(a.y, b.y), abs(a.x - b.x), abs(a.y - b.y))


def crosses(a: Point, b: Point, box: Box) -> bool:
    line, inner = area(a, b), box.grown(-NEAR)
    return (
        line.x < inner.right
        and inner.x < line.right + NEAR / 2
        and line.y < inner.bottom
        and inner.y < line.bottom + NEAR / 2
    )


def touches(box: Box, point: Point) -> bool:
    edge = box.grown(NEAR).contains(Box(*point, 0, 0))
    return edge and not box.grown(-NEAR).contains(Box(*point, 0, 0))


def flaws(nodes: dict[str, Extent], links: list[Link], layout: Layout) -> list[str]:
    boxes = [*layout.nodes.values(), *(route.label for route in layout.routes if route.label)]
    flaws = [f"overlap: {a}, {b}" for a, b in combinations(boxes, 2) if a.grown(-NEAR).overlaps(b)]
    whole = Box(0, 0, *layout.size).grown(NEAR)
    flaws += [f"outside: {box}" for box in boxes if not whole.contains(box)]
    lines = segments(layout)
    flaws += [f"crosses: {a}, {b}, {box}" for _, a, b in lines for box in boxes if crosses(a, b, box)]
    flaws += [f"slanted: {a}, {b}" for _, a, b in lines if a.x != b.x and a.y != b.y]
    for (first, a, b), (second, c, d) in combinations(lines, 2):
        if first != second and (a.x == b.x) == (c.x == d.x) and area(a, b).grown(1).overlaps(area(c, d).grown(1)):
            flaws.append(f"coincide: {a}, {b}, {c}, {d}")
    for link, route in zip(links, layout.routes, strict=True):
        ends = [layout.nodes[link.source], *([route.label] * 2 if route.label else []), layout.nodes[link.target]]
        points = [point for part in route.parts for point in (part[0], part[-1])]
        flaws += [f"loose: {link}" for box, point in zip(ends, points, strict=True) if not touches(box, point)]
    for name, size in nodes.items():
        box = layout.nodes[name]
        flaws += [f"small: {name}"] if box.width < size.width - NEAR or box.height < size.height - NEAR else []
    return flaws


@settings(max_examples=examples(60), deadline=None)
@given(graphs(), DIRECTIONS)
def test_layered(graph: tuple[dict[str, Extent], list[Link]], direction: LayoutDirection) -> None:
    nodes, links = graph
    layout = layered(nodes, links, direction, 1.5)
    assert flaws(nodes, links, layout) == []
    assert layered(nodes, links, direction, 1.5) == layout


@st.composite
def long_lines(draw: st.DrawFn) -> tuple[dict[str, Extent], list[Link]]:
    """Lines and rings of 12 to 40 nodes, in any order of their links, with or without the dot of an initial state. The
    last node may lead back to any other one."""
    count = draw(st.integers(12, 40))
    sizes = [draw(SIZES) for _ in range(count)] if draw(st.booleans()) else [Extent(100, 40)] * count
    labels = st.builds(Extent, st.integers(20, 120), st.integers(15, 60))
    links = [Link(str(n), str(n + 1), draw(st.none() | labels)) for n in range(count - 1)]
    back = draw(st.none() | st.integers(0, count - 2))
    links += [] if back is None else [Link(str(count - 1), str(back), draw(st.none() | labels))]
    nodes = {str(number): size for number, size in enumerate(sizes)}
    if draw(st.booleans()):
        nodes, links = {"start": Extent(10, 10), **nodes}, [Link("start", "0"), *links]
    return nodes, draw(st.permutations(links))


@settings(max_examples=examples(60), deadline=None)
@given(long_lines(), DIRECTIONS, st.sampled_from([0.6, 1.0, 1.8]))
def test_long_lines_are_read_like_text(
    graph: tuple[dict[str, Extent], list[Link]], direction: LayoutDirection, aspect: float
) -> None:
    """Each node follows the one before it in its row, or is the first of the next row; no lines cross."""
    nodes, links = graph
    layout = layered(nodes, links, direction, aspect)
    assert flaws(nodes, links, layout) == []
    lines = segments(layout)
    for (one, a, b), (other, c, d) in combinations(lines, 2):
        if one != other and (a.x == b.x) != (c.x == d.x):
            assert not area(a, b).grown(NEAR).overlaps(area(c, d).grown(NEAR)), (a, b, c, d)
    boxes = layout.nodes if direction is LayoutDirection.RIGHT else layout.turned.nodes
    rows = [[boxes["0"]]]
    for number in range(1, len(nodes) - ("start" in nodes)):
        box, last = boxes[str(number)], rows[-1][-1]
        if box.x >= last.right:
            assert abs(middle(box) - middle(last)) < NEAR
            rows[-1].append(box)
        else:
            assert box.y >= max(before.bottom for before in rows[-1])
            rows.append([box])
    assert {len(row) for row in rows[:-1]} <= {len(rows[0])}
    assert len(rows[-1]) <= len(rows[0])


def test_layers_of_small_graphs_are_not_divided() -> None:
    """The leaves of a small star are in one layer, those of a large one in several."""
    for count, is_small in ((12, True), (30, False)):
        nodes = {str(number): Extent(110, 40) for number in range(count)}
        links = [Link("0", str(number), Extent(60, 25)) for number in range(1, count)]
        boxes = layered(nodes, links, LayoutDirection.DOWN, 1.5).nodes
        assert (len({middle(boxes[str(number)]) for number in range(1, count)}) == 1) is is_small


def middle(box: Box) -> float:
    return box.y + box.height / 2


def test_rings_have_the_desired_ratio() -> None:
    """A ring of 30 nodes suits the window, in both directions."""
    nodes = {str(number): Extent(110, 40) for number in range(30)}
    links = [Link(str(n), str((n + 1) % 30), Extent(60, 25)) for n in range(30)]
    for direction in LayoutDirection:
        width, height = layered(nodes, links, direction, 1.6).size
        assert 1.2 < width / height < 2.1


def test_the_first_node_comes_first() -> None:
    nodes = dict.fromkeys("abc", Extent(40, 20))
    links = [Link("a", "b"), Link("b", "c"), Link("c", "a", Extent(30, 10))]
    down = layered(nodes, links, LayoutDirection.DOWN, 1).nodes
    assert down["a"].y < down["b"].y < down["c"].y
    right = layered(nodes, links, LayoutDirection.RIGHT, 1).nodes
    assert right["a"].x < right["b"].x < right["c"].x


def test_a_longer_label_does_not_change_the_arrangement() -> None:
    """Typing in a label moves nodes, but does not rearrange them."""
    nodes = dict.fromkeys("abcd", Extent(60, 30))
    ends = ("ab", "ac", "bd", "cd", "da")
    layouts = [
        layered(nodes, [Link(s, t, Extent(width, 20)) for s, t in ends], LayoutDirection.DOWN, 1).nodes
        for width in (30, 90, 150)
    ]
    for layout in layouts:
        assert layout["a"].y < layout["b"].y == layout["c"].y < layout["d"].y
        assert layout["b"].x < layout["c"].x


@st.composite
def trees(draw: st.DrawFn) -> tuple[dict[str, Extent], dict[str, list[str]]]:
    count = draw(st.integers(1, 25))
    children: dict[str, list[str]] = {}
    for number in range(1, count):
        children.setdefault(str(draw(st.integers(0, number - 1))), []).append(str(number))
    return {str(number): draw(SIZES) for number in range(count)}, children


def test_divided_layers_keep_labels_near_their_nodes() -> None:
    """The label of each link of a star is in the layer directly above the node to which the link leads."""
    node, label = Vertex(VertexKind.NODE, Extent(100, 40)), Vertex(VertexKind.LABEL, Extent(100, 20))
    leaves = range(1, 25, 2)
    edges = [pair for leaf in leaves for pair in ((0, leaf + 1), (leaf + 1, leaf))]
    layers = assign_layers([node, *[node, label] * len(leaves)], edges, 500)
    assert len(set(layers)) > 4
    assert {layers[leaf] - layers[leaf + 1] for leaf in leaves} == {1}


@st.composite
def boxed_graphs(draw: st.DrawFn) -> tuple[dict[str, Extent], list[Link], Boxes]:
    """Graphs whose nodes are in up to 4 boxes, some of which are in other ones. No box is empty."""
    nodes, links = draw(graphs())
    names = [f"box {number}" for number in range(draw(st.integers(1, 4)))]
    parents = {
        name: draw(st.sampled_from(names[:number]))
        for number, name in enumerate(names)
        if number and draw(st.booleans())
    }
    parents |= {node: draw(st.sampled_from(names)) for node in nodes if draw(st.booleans())}
    used = {name for node in nodes for name in Boxes(parents, {}).path(node)}
    kept = {name: parent for name, parent in parents.items() if name in used}
    return nodes, links, Boxes(kept, {name: draw(SIZES) for name in names if name in used})


@settings(max_examples=examples(100), deadline=None)
@given(boxed_graphs(), DIRECTIONS)
def test_nested(graph: tuple[dict[str, Extent], list[Link], Boxes], direction: LayoutDirection) -> None:
    """Boxes contain what is in them and nothing else; lines cross only the borders of boxes that they leave or enter,
    and no heading."""
    nodes, links, boxes = graph
    layout = nested(nodes, links, boxes, direction, 1.5)
    assert flaws(nodes, links, Layout(layout.size, {name: layout.nodes[name] for name in nodes}, layout.routes)) == []
    assert layout.nodes.keys() == nodes.keys() | boxes.headings.keys()
    inside = {box: {name for name in layout.nodes if box in boxes.path(name)[:-1]} for box in boxes.headings}
    for box, content in inside.items():
        border = layout.nodes[box]
        heading = Box(border.x, border.y, *boxes.headings[box])
        assert border.grown(NEAR).contains(heading)
        for name, other in layout.nodes.items():
            if name in content:
                assert border.grown(-NEAR).contains(other)
                assert not heading.grown(-NEAR).overlaps(other)
            elif name != box and name not in boxes.path(box):
                assert not border.overlaps(other)
        for number, a, b in segments(layout):
            link = links[number]
            assert not crosses(a, b, heading.grown(-NEAR)), (link, heading)
            if link.source not in content and link.target not in content:
                assert not crosses(a, b, border), link
            elif link.source in content and link.target in content:
                assert border.contains(area(a, b)), link


@settings(max_examples=examples(60), deadline=None)
@given(trees(), DIRECTIONS)
def test_trees(tree: tuple[dict[str, Extent], dict[str, list[str]]], direction: LayoutDirection) -> None:
    nodes, children = tree
    layout = tidy_tree(nodes, children, direction)
    boxes = list(layout.nodes.values())
    assert not [(a, b) for a, b in combinations(boxes, 2) if a.grown(-NEAR).overlaps(b)]
    assert all(Box(0, 0, *layout.size).grown(NEAR).contains(box) for box in boxes)
    assert not [(a, b) for _, a, b in segments(layout) for box in boxes if crosses(a, b, box)]
    pairs = [(parent, child) for parent, group in children.items() for child in group]
    for (parent, child), route in zip(pairs, layout.routes, strict=True):
        assert touches(layout.nodes[parent], route.parts[0][0])
        assert touches(layout.nodes[child], route.parts[0][-1])
    starts = {(parent, route.parts[0][0]) for (parent, _), route in zip(pairs, layout.routes, strict=True)}
    assert len(starts) == len({parent for parent, _ in pairs})
    for group in children.values():
        places = [layout.nodes[child] for child in group]
        across = [box.x + box.width / 2 for box in places]
        down = [box.y + box.height / 2 for box in places]
        if direction is LayoutDirection.DOWN and len({box.y for box in places}) == 1:
            assert across == sorted(across)
        else:
            assert down == sorted(down)


@settings(max_examples=examples(60), deadline=None)
@given(trees())
def test_outlines(tree: tuple[dict[str, Extent], dict[str, list[str]]]) -> None:
    """Nodes are below each other, children after their parent and at the right of its left side."""
    nodes, children = tree
    layout = outline(nodes, children)
    boxes = list(layout.nodes.values())
    assert layout.nodes.keys() == nodes.keys()
    assert not [(a, b) for a, b in pairwise(boxes) if a.bottom > b.y]
    assert all(Box(0, 0, *layout.size).grown(NEAR).contains(box) for box in boxes)
    assert not [(a, b) for _, a, b in segments(layout) for box in boxes if crosses(a, b, box)]
    pairs = [(parent, child) for parent, group in children.items() for child in group]
    for (parent, child), route in zip(pairs, layout.routes, strict=True):
        above, below = layout.nodes[parent], layout.nodes[child]
        assert touches(above, route.parts[0][0])
        assert touches(below, route.parts[0][-1])
        assert below.x > above.x
        assert below.y > above.y
    for group in children.values():
        assert [layout.nodes[child].y for child in group] == sorted(layout.nodes[child].y for child in group)


def test_a_wide_tree_has_outlines_instead_of_rows() -> None:
    """A root with 8 nodes that have 8 leaves each: 64 leaves in a row would be 50 times as wide as high."""
    leaves = {f"{a}": [f"{a}{b}" for b in range(8)] for a in range(8)}
    children = {"root": list(leaves), **leaves}
    nodes = dict.fromkeys(["root", *leaves, *(leaf for group in leaves.values() for leaf in group)], Extent(100, 40))
    width, height = tidy_tree(nodes, children, LayoutDirection.DOWN).size
    assert width < 3 * height
    small = tidy_tree({name: nodes[name] for name in ("root", "0", "1")}, {"root": ["0", "1"]}, LayoutDirection.DOWN)
    assert small.nodes["0"].y == small.nodes["1"].y


def test_lines_that_exchange_their_places() -> None:
    """One of them changes its track on the way, so that their vertical parts do not coincide."""
    turns, count = assign_tracks([(0.0, 50.0), (50.0, 0.0)])
    assert sorted(map(len, turns)) == [1, 2]
    assert count == 3
    assert [line[-1].to for line in turns] == [50.0, 0.0]
    assert assign_tracks([(10.0, 10.0)]) == ([[]], 0)


def test_spread() -> None:
    assert spread([0, 0], [10]) == [-5, 5]
    assert spread([0, 100], [10]) == [0, 100]
    assert spread([0, 0, 0], [10, 10], low=0) == [0, 10, 20]
    assert spread([0, 0], [10], [1, 3]) == [-7.5, 2.5]
    assert spread([], []) == []


def test_parts_that_are_not_connected_are_placed_so_that_they_suit_the_page() -> None:
    """A chain of four nodes and one of two nodes: beside each other on a page, in a row or column if there is no other
    space."""
    nodes = {name: Extent(120, 60) for name in "abcdef"}
    links = [Link(one, other) for one, other in ("ab", "bc", "cd", "ef")]
    sizes = {aspect: layered(nodes, links, LayoutDirection.DOWN, aspect).size for aspect in (0.01, 0.8, 100.0)}
    assert sizes[0.8] == sizes[100.0]
    assert sizes[0.8].width > 240 > sizes[0.01].width
    assert sizes[0.01].height > sizes[0.8].height


@pytest.mark.parametrize("direction", LayoutDirection)
def test_parts_that_are_not_connected_are_read_like_text(direction: LayoutDirection) -> None:
    nodes = {name: Extent(100, 50) for name in "abc"}
    boxes = Boxes({"a": "A", "b": "B", "c": "C"}, {name: Extent(60, 20) for name in "ABC"})
    for layout in (layered(nodes, [], direction, 1.3), nested(nodes, [], boxes, direction, 1.3)):
        places = {name: layout.nodes[name] for name in nodes}
        assert places["a"].y == places["b"].y < places["c"].y
        assert places["a"].x < places["b"].x


SHAPES = ("chain", "ring", "star", "hub", "tree", "returns")


@st.composite
def large_graphs(draw: st.DrawFn) -> tuple[dict[str, Extent], list[Link]]:
    """Large graphs of the kinds that models have, with a few links more."""
    count = draw(st.integers(12, 64))
    shape = draw(st.sampled_from(SHAPES))
    following = [(number, number + 1) for number in range(count - 1)]
    ends = {
        "chain": following,
        "ring": [*following, (count - 1, 0)],
        "star": [(0, number) for number in range(1, count)],
        "hub": [pair for number in range(1, count) for pair in ((0, number), (number, 0))],
        "tree": [((number - 1) // 3, number) for number in range(1, count)],
        "returns": [*following, *((number, 0) for number in range(2, count))],
    }[shape]
    more = st.tuples(st.integers(0, count - 1), st.integers(0, count - 1)).filter(lambda pair: pair[0] != pair[1])
    ends = [*ends, *draw(st.lists(more, max_size=6))]
    label = draw(st.sampled_from([None, Extent(90, 24)]))
    return {str(number): Extent(100, 40) for number in range(count)}, [Link(str(a), str(b), label) for a, b in ends]


@settings(max_examples=examples(12), deadline=None)
@given(large_graphs(), DIRECTIONS)
def test_large_graphs_are_wrapped(graph: tuple[dict[str, Extent], list[Link]], direction: LayoutDirection) -> None:
    """Neither side is more than three times as long as the other one, and nothing else is lost."""
    nodes, links = graph
    layout = layered(nodes, links, direction, 1)
    assert flaws(nodes, links, layout) == []
    width, height = layout.size
    assert max(width / height, height / width) <= 3


def test_lines_pass_labels_straight() -> None:
    """In a tree, all lines from labels to nodes are straight, too."""
    nodes = {str(number): Extent(100 + 7 * (number % 5), 32) for number in range(13)}
    links = [Link(str((n - 1) // 3), str(n), Extent(50 + 40 * (n % 3), 25)) for n in range(1, 13)]
    for direction in LayoutDirection:
        for route in layered(nodes, links, direction, 1.3).routes:
            (*_, near), below = route.parts
            ends = [point.turned if direction is LayoutDirection.RIGHT else point for point in (near, *below)]
            assert len(below) == 2
            assert max(point.x for point in ends) - min(point.x for point in ends) < NEAR


def test_the_first_node_is_above_further_columns() -> None:
    for seed in range(10):
        chance = random.Random(seed)
        names = ["dot", *(f"n{number}" for number in range(40))]
        links = [Link(names[chance.randrange(max(1, n - 3), n)], names[n], Extent(60, 24)) for n in range(2, 41)]
        links += [Link(names[n], names[chance.randrange(1, n)]) for n in range(2, 41) if chance.random() < 0.3]
        sizes = {name: Extent(100, 32) for name in names} | {"dot": Extent(10, 10)}
        layout = layered(sizes, [Link("dot", "n0"), *links], LayoutDirection.DOWN, 0.8)
        first = layout.nodes["n0"]
        assert layout.size.height / layout.size.width < 2.5
        assert all(box.y >= first.bottom for name, box in layout.nodes.items() if name not in ("dot", "n0"))


def test_lines_end_at_the_wanted_places_of_nodes() -> None:
    """In the order of these places, and beside each other if several lines have the same one."""
    clients = [str(number) for number in range(5)]
    nodes = {name: Extent(80, 30) for name in clients} | {"server": Extent(120, 100)}
    wanted = [30.0, -20.0, 0.0, -20.0, None]
    links = [Link(name, "server", None, None, place) for name, place in zip(clients, wanted, strict=True)]
    frames = Boxes({"server": "frame"}, {"frame": Extent(60, 20)})
    for layout in (
        layered(nodes, links, LayoutDirection.RIGHT, 1.8),
        nested(nodes, links, frames, LayoutDirection.RIGHT, 1.8),
    ):
        if "frame" not in layout.nodes:
            assert flaws(nodes, links, layout) == []
        ends = [route.parts[-1][-1].y - middle_of(layout.nodes["server"]) for route in layout.routes]
        assert abs(ends[0] - 30) < NEAR
        assert abs(ends[2]) < NEAR
        assert all(abs(end + 20) < 10 for end in (ends[1], ends[3]))
        assert abs(ends[1] - ends[3]) > 5
        assert ends[4] < min(ends[:4])


def middle_of(box: Box) -> float:
    return box.y + box.height / 2


def test_rows_of_long_lines_fit_a_window() -> None:
    nodes = {str(number): Extent(110, 40) for number in range(100)}
    links = [Link(str(n), str(n + 1), Extent(60, 25)) for n in range(99)]
    width, height = layered(nodes, links, LayoutDirection.RIGHT, 1.8).size
    assert 900 < width <= 1180
    assert height / width < 3


def test_straightening_keeps_track_of_straight_lines() -> None:
    """After moves, the vertices that straight lines connect are the same as if they were searched again."""
    chance = random.Random(7)
    rows = [list(range(start, start + 8)) for start in range(0, 80, 8)]
    edges = [(upper, chance.choice(rows[index + 1])) for index, row in enumerate(rows[:-1]) for upper in row]
    places = [float(vertex % 8 * 60 + chance.randrange(20)) for row in rows for vertex in row]
    straightening = Straightening(rows, [[40.0] * 7 for _ in rows], edges, places, [0.0] * len(edges))
    straightening.run()
    assert straightening.places != places
    known = {tuple(sorted(group)) for group in straightening._groups}
    again = Straightening(rows, [[40.0] * 7 for _ in rows], edges, straightening.places, [0.0] * len(edges))
    assert known == {tuple(sorted(group)) for group in again._groups}


def test_crossings_stop_at_a_limit() -> None:
    """A count above the limit need not be complete; one that is not above it is."""
    rows = [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
    below = [[5], [4], [3], [8], [7], [6], [], [], []]
    assert crossings(rows, below) == crossings(rows, below, 6) == 6
    assert 2 < crossings(rows, below, 2) <= 6


def test_a_part_whose_first_node_is_at_the_end_is_mirrored() -> None:
    """The first node is in the left part of the drawing, unless the layers are in the order of the nodes."""
    ends = [(0, 1), (1, 2), (0, 3), (3, 2), (3, 4), (4, 5), (1, 6), (6, 7), (7, 1), (5, 3), (2, 8), (8, 9), (9, 0)]
    firsts = []
    for order in range(12):
        chance = random.Random(order)
        links = [Link(str(a), str(b), Extent(60, 20)) for a, b in chance.sample(ends, len(ends))]
        layout = layered({str(n): Extent(90, 30) for n in range(10)}, links, LayoutDirection.DOWN, 1.0)
        rows: dict[float, list[tuple[float, int]]] = {}
        for name, box in layout.nodes.items():
            rows.setdefault(round(box.y + box.height / 2), []).append((box.x, int(name)))
        is_in_order = all([n for _, n in sorted(row)] == sorted(n for _, n in row) for row in rows.values())
        first = layout.nodes["0"]
        firsts.append(is_in_order or first.x + first.width / 2 <= 0.6 * layout.size.width)
    assert all(firsts)


def test_mirrored_twice_is_the_same() -> None:
    links = [Link("a", "b", Extent(50, 20)), Link("a", "c"), Link("b", "a")]
    layout = layered(dict.fromkeys("abc", Extent(80, 30)), links, LayoutDirection.DOWN, 1.0)
    assert layout.mirrored != layout
    assert layout.mirrored.nodes["b"].x == layout.size.width - layout.nodes["b"].right
    again = layout.mirrored.mirrored
    assert all(abs(again.nodes[name].x - box.x) < NEAR for name, box in layout.nodes.items())
    assert len(segments(again)) == len(segments(layout)) > 0


@pytest.mark.parametrize(("count", "sides"), [(30, (14, 15)), (12, (0, 11))])
def test_a_node_with_many_others_has_them_on_both_sides(count: int, sides: tuple[int, int]) -> None:
    nodes = {f"n{number}": Extent(80.0, 30.0) for number in range(count)}
    links = [Link("n0", f"n{number}", Extent(60.0, 20.0)) for number in range(1, count)]
    layout = layered(nodes, links, LayoutDirection.RIGHT, 1.3)
    assert not flaws(nodes, links, layout)
    first = layout.nodes["n0"].x
    before = [name for name in nodes if layout.nodes[name].x < first]
    assert (len(before), count - 1 - len(before)) == sides
    # The others are in the order of the links, first those behind it.
    behind = [name for name in nodes if layout.nodes[name].x > first]
    right = sorted(behind, key=lambda name: layout.nodes[name].y)
    assert right == [f"n{number}" for number in range(1, sides[1] + 1)]
    assert all(route.parts[0][0].x in (layout.nodes["n0"].x, layout.nodes["n0"].right) for route in layout.routes)
