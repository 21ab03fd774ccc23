// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import ELK from "elkjs/lib/elk.bundled.js";
import type { Picture, PictureEdge, PictureNode, Place } from "../src/pictures/contract";
import { partAt } from "../src/pictures/partAt";
import { fit, neighbour, reveal, search, zoom } from "../src/pictures/view/find";
import { drawingOf, graphOf, pathOf, type Drawing } from "../src/pictures/view/layout";

const URI = "file:///m.ascxml";

function place(startLine: number, startColumn: number, endLine: number, endColumn: number): Place {
    const [start, end] = [
        { line: startLine, character: startColumn },
        { line: endLine, character: endColumn },
    ];
    return { uri: URI, range: { start, end } };
}

function node(id: string, more: Partial<PictureNode> = {}): PictureNode {
    return { id, kind: "state", label: id, details: [], parent: "", initial: false, place: null, ...more };
}

function edge(source: string, target: string, more: Partial<PictureEdge> = {}): PictureEdge {
    return { source, target, kind: "event", labels: [], probabilistic: false, place: null, ...more };
}

const MACHINE: Picture = {
    kind: "machine",
    title: "M",
    nodes: [
        node("a", { initial: true, place: place(1, 0, 5, 9) }),
        node("b", { place: place(6, 0, 9, 9), details: ["log"] }),
        node("t", { kind: "thread", place: place(10, 0, 20, 9) }),
        node("t/a", { parent: "t", initial: true, place: place(11, 2, 14, 9) }),
        node("t/b", { parent: "t", place: place(15, 2, 19, 9) }),
    ],
    edges: [
        edge("a", "b", { labels: ["go", "[x > 1]"], place: place(2, 4, 4, 20) }),
        edge("a", "a", { labels: ["again"], place: place(5, 0, 5, 4) }),
        edge("t/a", "t/b", { labels: ["start"], place: place(12, 4, 12, 20) }),
        edge("t/b", "t/a", { labels: ["done"] }),
        edge("t/b", "t/b", { kind: "eventless" }),
    ],
};

const TREE: Picture = {
    kind: "tree",
    title: "tree.xml",
    nodes: [
        node("1", { kind: "control", label: "Sequence" }),
        node("2", { kind: "action", label: "Put" }),
        node("3", { kind: "action", label: "Get" }),
        node("{v}", { kind: "variable", label: "v" }),
    ],
    edges: [
        edge("1", "2", { kind: "child" }),
        edge("1", "3", { kind: "child" }),
        edge("2", "{v}", { kind: "writes" }),
        edge("{v}", "3", { kind: "reads" }),
    ],
};

async function layout(picture: Picture): Promise<Drawing> {
    const measure = (text: string, size: number) => text.length * size * 0.6;
    return drawingOf(picture, await new ELK().layout(graphOf(picture, measure, ({ kind }) => kind)));
}

function box(drawing: Drawing, index: number) {
    const found = drawing.nodes.find((each) => each.index === index);
    assert.ok(found);
    return found;
}

test("initial nodes are at the top, frames contain their nodes", async () => {
    const drawing = await layout(MACHINE);
    assert.ok(box(drawing, 0).y < box(drawing, 1).y);
    assert.ok(box(drawing, 3).y < box(drawing, 4).y);
    const [frame, inside] = [box(drawing, 2), box(drawing, 4)];
    assert.ok(inside.x > frame.x && inside.x + inside.width < frame.x + frame.width);
    assert.ok(inside.y > frame.y && inside.y + inside.height < frame.y + frame.height);
    assert.equal(drawing.nodes.filter(({ index }) => index === -1).length, 2);
    for (const each of drawing.nodes) assert.ok(each.x >= 0 && each.x + each.width <= drawing.width);
});

test("edges end at their nodes, in frames as well", async () => {
    for (const picture of [MACHINE, TREE]) {
        const drawing = await layout(picture);
        for (const drawn of drawing.edges) {
            const written = picture.edges[drawn.index];
            if (!written) continue;
            const at = (id: string) =>
                box(
                    drawing,
                    picture.nodes.findIndex((each) => each.id === id),
                );
            const [first, last] = [drawn.points[0], drawn.points.at(-1)];
            assert.ok(first && last && touches(at(written.source), first) && touches(at(written.target), last));
            assert.equal(drawn.label !== undefined, written.labels.length > 0);
        }
    }
});

function touches(rect: { x: number; y: number; width: number; height: number }, { x, y }: { x: number; y: number }) {
    const near = 0.5;
    const across = x >= rect.x - near && x <= rect.x + rect.width + near;
    return across && y >= rect.y - near && y <= rect.y + rect.height + near;
}

test("children of the tree keep their order, variables are below", async () => {
    const drawing = await layout(TREE);
    assert.ok(box(drawing, 1).x < box(drawing, 2).x);
    assert.ok(box(drawing, 0).y < box(drawing, 1).y);
    assert.ok(box(drawing, 3).y > box(drawing, 1).y);
});

test("the caret is in the narrowest part", () => {
    const at = (line: number, character: number, uri = URI) => partAt(MACHINE, uri, { line, character });
    assert.deepEqual(at(1, 3), { node: 0 });
    assert.deepEqual(at(3, 0), { edge: 0 });
    assert.deepEqual(at(12, 10), { edge: 2 });
    assert.deepEqual(at(13, 0), { node: 3 });
    assert.deepEqual(at(10, 1), { node: 2 });
    assert.equal(at(30, 0), null);
    assert.equal(at(3, 0, "file:///other"), null);
});

test("arrow keys go to the nearest node in their direction", () => {
    const at = (index: number, x: number, y: number) => ({ index, x, y, width: 10, height: 10 });
    const nodes = [at(0, 0, 0), at(1, 100, 0), at(2, 0, 100), at(3, 60, 60), at(-1, 20, 0)];
    assert.equal(neighbour(nodes, 0, "ArrowRight"), 1);
    assert.equal(neighbour(nodes, 0, "ArrowDown"), 2);
    assert.equal(neighbour(nodes, 3, "ArrowLeft"), 2);
    assert.equal(neighbour(nodes, 0, "ArrowUp"), undefined);
    assert.equal(neighbour(nodes, -1, "ArrowUp"), 0);
    assert.equal(neighbour([], 0, "ArrowUp"), undefined);
});

test("searching finds all words, in any case, in labels, kinds and details", () => {
    assert.deepEqual(search(TREE, "ACTION p"), [1]);
    assert.deepEqual(search(MACHINE, "log"), [1]);
    assert.deepEqual(search(MACHINE, "  "), []);
    assert.deepEqual(search(MACHINE, "nothing"), []);
});

test("fitting, zooming and revealing", () => {
    const whole = fit({ width: 2000, height: 100 }, 1000, 500);
    assert.ok(whole.scale < 0.5 && whole.scale > 0.4);
    assert.equal(fit({ width: 10, height: 10 }, 1000, 500).scale, 1);
    const closer = zoom({ x: 0, y: 0, scale: 1 }, 2, { x: 100, y: 50 });
    // What was under the pointer stays there: (100, 50) of the drawing.
    assert.deepEqual([(100 - closer.x) * closer.scale, (50 - closer.y) * closer.scale], [100, 50]);
    assert.equal(zoom(closer, 1000, { x: 0, y: 0 }).scale, 4);
    const sight = { x: 0, y: 0, scale: 1 };
    assert.deepEqual(reveal(sight, { x: 10, y: 10, width: 20, height: 20 }, 100, 100), sight);
    const moved = reveal(sight, { x: 200, y: 10, width: 20, height: 20 }, 100, 100);
    assert.ok(moved.x > 120 && moved.x < 200 && moved.y === 0);
});

test("lines have round corners that fit between their points", () => {
    assert.equal(pathOf([]), "");
    assert.equal(
        pathOf([
            { x: 0, y: 0 },
            { x: 5, y: 0 },
        ]),
        "M 0 0 L 5 0",
    );
    const corner = [
        { x: 0, y: 0 },
        { x: 10, y: 0 },
        { x: 10, y: 4 },
    ];
    assert.equal(pathOf(corner), "M 0 0 L 8 0 Q 10 0 10 2 L 10 4");
});
