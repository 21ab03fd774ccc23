// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Box, CoverageWords, Picture, PictureEdge, PictureNode, Place, Words } from "../src/pictures/contract";
import { partAt } from "../src/pictures/partAt";
import {
    around,
    amongOthers,
    bestDrawing,
    centered,
    fit,
    fitLegibly,
    fullest,
    follow,
    mapOf,
    neighbour,
    pan,
    reveal,
    search,
    shifts,
    withStart,
    visiblePart,
    zoom,
} from "../src/pictures/view/find";
import { badgeOf, isOf, nodeCoverageWords, summaryOf } from "../src/pictures/view/coverage";
import { shownActivity, shownId } from "../src/pictures/view/shown";
import { edgeHint, edgeWords, legendOf, nodeWords } from "../src/pictures/view/words";

const URI = "file:///m.ascxml";

function place(startLine: number, startColumn: number, endLine: number, endColumn: number): Place {
    const [start, end] = [
        { line: startLine, character: startColumn },
        { line: endLine, character: endColumn },
    ];
    return { uri: URI, range: { start, end } };
}

function node(id: string, more: Partial<PictureNode> = {}): PictureNode {
    const places = { place: null, actions: [], use: null, useActions: [] };
    return { id, kind: "state", label: id, details: [], parent: "", hides: [], initial: false, ...places, ...more };
}

function edge(source: string, target: string, more: Partial<PictureEdge> = {}): PictureEdge {
    return {
        source,
        target,
        kind: "event",
        labels: [],
        probabilistic: false,
        interface: "",
        place: null,
        actions: [],
        ...more,
    };
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
    drawings: [],
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
    drawings: [],
};

const ROS: Picture = {
    kind: "ros",
    title: "main.xml",
    nodes: [
        node("A", { kind: "node" }),
        node("B", { kind: "plugin" }),
        node("C", { kind: "node" }),
        node("topic", { kind: "topic", label: "/level", details: ["std_msgs/Int32"] }),
        node("service", { kind: "service", label: "/ask", details: ["std_srvs/Trigger"] }),
    ],
    edges: [
        edge("A", "topic", { kind: "publishes", place: place(4, 0, 4, 9) }),
        edge("topic", "B", { kind: "subscribes" }),
        edge("topic", "C", { kind: "subscribes" }),
        edge("C", "service", { kind: "calls" }),
        edge("A", "B", { kind: "sends", labels: ["go"] }),
    ],
    drawings: [],
};

/** Words that are equal to their keys. */
const LEGEND_WORDS = { byChance: "random", mock: "mock", initial: "initial", final: "final" };
const WORDS = { ...LEGEND_WORDS, kinds: new Proxy({}, { get: (_, kind) => kind }) } as Words;

test("the caret is in the narrowest part", () => {
    const at = (line: number, character: number, uri = URI) => partAt(MACHINE, uri, { line, character });
    const subtree = node("s", { kind: "subtree", place: place(30, 0, 40, 9), use: place(3, 0, 3, 9) });
    assert.deepEqual(partAt({ ...TREE, nodes: [subtree] }, URI, { line: 3, character: 4 }), { node: 0 });
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
    const nodes = [at(0, 0, 0), at(1, 100, 0), at(2, 0, 100), at(3, 60, 60)];
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
    assert.deepEqual(search(MACHINE, "again"), [0]);
    assert.deepEqual(search(MACHINE, "  "), []);
    assert.deepEqual(search(MACHINE, "nothing"), []);
});

test("fitting, zooming and revealing", () => {
    const whole = fit({ width: 2000, height: 100 }, 1000, 500);
    assert.ok(whole.scale < 0.5 && whole.scale > 0.4);
    assert.equal(fit({ width: 10, height: 10 }, 1000, 500).scale, 1);
    const closer = zoom({ x: 0, y: 0, scale: 1 }, 2, { x: 100, y: 50 });
    // The point of the drawing under the pointer, (100, 50), stays there.
    assert.deepEqual([(100 - closer.x) * closer.scale, (50 - closer.y) * closer.scale], [100, 50]);
    assert.equal(zoom(closer, 1000, { x: 0, y: 0 }).scale, 4);
    const sight = { x: 0, y: 0, scale: 1 };
    assert.deepEqual(reveal(sight, { x: 10, y: 10, width: 20, height: 20 }, 100, 100), sight);
    const moved = reveal(sight, { x: 200, y: 10, width: 20, height: 20 }, 100, 100);
    assert.ok(moved.x > 120 && moved.x < 200 && moved.y === 0);
});

test("the map is for drawings of which the window shows a part", () => {
    const drawing = { width: 300, height: 200 };
    assert.deepEqual(visiblePart({ x: -50, y: -100, scale: 1 }, drawing, 400, 400), { x: 0, y: 0, ...drawing });
    assert.deepEqual(visiblePart({ x: 100, y: -20, scale: 2 }, drawing, 300, 200), {
        x: 100,
        y: 0,
        width: 150,
        height: 80,
    });
    assert.deepEqual(visiblePart({ x: 400, y: 0, scale: 1 }, drawing, 100, 100).width, 0);
});

test("nodes glide from where they were, although other nodes were added before them", () => {
    const box = { y: 0, width: 10, height: 10 };
    const before = {
        ids: ["a", "b"],
        nodes: [
            { index: 0, x: 0, ...box },
            { index: 1, x: 20, ...box },
        ],
    };
    const after = {
        ids: ["new", "a", "b"],
        nodes: [
            { index: 0, x: 20, ...box },
            { index: 1, x: 0, ...box },
            { index: 2, x: 50, ...box },
        ],
    };
    assert.deepEqual(shifts(before, after), [{ index: 2, x: -30, y: 0 }]);
    assert.deepEqual(shifts(before, before), []);
});

test("a picture is legible at first, and drawn in the direction that suits the window", () => {
    const [tall, wide] = [
        { width: 300, height: 900 },
        { width: 1200, height: 300 },
    ];
    assert.equal(bestDrawing([tall, wide], 400, 1000), 0);
    assert.equal(bestDrawing([tall, wide], 1400, 400), 1);
    // Neither drawing fits. The one whose width fits is used, so that it can be read from top to bottom.
    assert.equal(bestDrawing([tall, wide], 500, 500), 0);
    assert.equal(bestDrawing([tall, wide], 2000, 2000), 0);
    // An outline is used if no other drawing is legible as a whole, or if it is the only one whose width fits.
    const outline = { width: 340, height: 1500 };
    assert.equal(bestDrawing([tall, wide, outline], 400, 1000), 0);
    assert.equal(bestDrawing([wide, wide, outline], 400, 1000), 2);
    assert.equal(bestDrawing([wide, wide, outline], 2000, 2000), 0);
    assert.equal(bestDrawing([wide, wide, { width: 340, height: 300 }], 1000, 400), 2);
    assert.equal(bestDrawing([wide, wide, outline], 800, 600, 0.6), 0);
    assert.equal(bestDrawing([{ width: 1150, height: 900 }, wide, outline], 1000, 1600), 2);
    assert.ok(Math.abs(fitLegibly({ width: 500, height: 800 }, 1000, 800).scale - 0.96) < 1e-9);
    // The smallest texts have 12 px. A first view shows them with at least 10 px if it shows all, otherwise with 11 px.
    assert.ok(Math.abs(fitLegibly({ width: 500, height: 900 }, 1000, 800).scale - 768 / 900) < 1e-9);
    assert.equal(
        bestDrawing(
            [
                { width: 1150, height: 800 },
                { width: 800, height: 1500 },
            ],
            1000,
            800,
        ),
        0,
    );
    for (const size of [
        { width: 500, height: 940 },
        { width: 500, height: 1200 },
        { width: 1100, height: 3000 },
    ])
        assert.equal(fitLegibly(size, 1000, 800).scale, 11 / 12);
    const view = fitLegibly({ width: 3000, height: 400 }, 1000, 800);
    assert.equal(view.scale, 11 / 12);
    assert.ok(view.x < 0 && view.x > -50 && view.y < -200);
    assert.equal(fitLegibly({ width: 300, height: 400 }, 1000, 800).scale, 1);
    assert.deepEqual(pan({ x: 10, y: 20, scale: 2 }, 8, -4), { x: 14, y: 18, scale: 2 });
});

test("a hover over an edge of the ROS graph says senders, interface, receivers, type and line", () => {
    const hints = ROS.edges.map((each) => edgeHint(ROS, each));
    assert.deepEqual(hints, [
        "A → /level → B, C\nstd_msgs/Int32\nm.ascxml:5",
        "A → /level → B\nstd_msgs/Int32",
        "A → /level → C\nstd_msgs/Int32",
        "C → /ask\nstd_srvs/Trigger",
        "A → B\ngo",
    ]);
});

test("parts have names for readers of the screen", () => {
    const [first, second] = MACHINE.edges;
    assert.ok(first && second && MACHINE.nodes[1]);
    assert.equal(edgeWords(MACHINE, first, WORDS), "a → b, event, go, [x > 1]");
    assert.equal(edgeWords(MACHINE, { ...second, probabilistic: true }, WORDS), "a → a, event, again, random");
    assert.equal(nodeWords(MACHINE.nodes[1], WORDS), "state, b, log");
});

test("the legend has one entry for each color", () => {
    const entries = (picture: Picture) => legendOf(picture, WORDS).map(({ tone, text }) => `${tone}: ${text}`);
    assert.deepEqual(entries(MACHINE), ["event: event", "plain: eventless", "plain: initial", "plain: final"]);
    assert.deepEqual(entries(TREE), ["control: control", "action: action", "blackboard: variable"]);
    const [root, ...others] = TREE.nodes;
    assert.ok(root);
    const mocked: Picture = { ...TREE, nodes: [{ ...root, details: ["mock: 0.9 in 2 s"] }, ...others] };
    assert.deepEqual(entries(mocked).at(-1), "chance: mock");
    assert.deepEqual(entries(ROS), ["topic: topic", "service: service", "event: event"]);
    // A line is dashed as those of its kind are.
    const [plain] = MACHINE.edges;
    assert.ok(plain);
    const random: Picture = { ...MACHINE, edges: [...MACHINE.edges, { ...plain, probabilistic: true }] };
    assert.deepEqual(
        legendOf(random, WORDS).map(({ tone, kind }) => `${tone}: ${kind}`),
        ["event: event", "plain: eventless", "chance: chance", "plain: ", "plain: "],
    );
    // Interfaces may be in the cards of nodes.
    const [first, second] = [node("a", { kind: "node" }), node("b", { kind: "node", hides: ["service /go"] })];
    const through = edge("a", "b", { kind: "calls", labels: ["/go"], interface: "service" });
    const grouped: Picture = { ...ROS, nodes: [first, second], edges: [through] };
    assert.deepEqual(entries(grouped), ["service: service"]);
    assert.equal(edgeHint(grouped, through), "a → b\n/go");
    assert.equal(shownId(grouped, "service /go"), "b");
    assert.equal(shownId(grouped, "a"), "a");
});

test("a map of a drawing, and the view around a point of it", () => {
    const drawing = { width: 4000, height: 1000 };
    const { width, height, factor } = mapOf(drawing, 200, 150);
    assert.deepEqual([width, height, factor], [200, 50, 0.05]);
    assert.equal(mapOf({ width: 100, height: 50 }, 200, 150).factor, 1);
    assert.deepEqual(centered({ x: 0, y: 0, scale: 0.5 }, { x: 2000, y: 500 }, 600, 400), {
        x: 1400,
        y: 100,
        scale: 0.5,
    });
});

test("a graph is shown where the most nodes are whole, first of all at its start", () => {
    const sight = { x: -16, y: -16, scale: 1 };
    const area = { width: 3000, height: 2000 };
    const at = (x: number, y: number) => ({ x, y, width: 100, height: 50 });
    const alone = [at(0, 0), at(0, 1900)];
    const crowd = [at(1500, 800), at(1700, 800), at(1500, 900), at(1700, 1000)];
    assert.deepEqual(fullest(sight, area, [...alone, ...crowd], 600, 400), { x: 1484, y: 784, scale: 1 });
    assert.deepEqual(fullest(sight, area, alone, 600, 400), sight);
    // At the start if nearly as many are whole there.
    const start = [at(0, 0), at(200, 0), at(0, 100)];
    assert.deepEqual(fullest(sight, area, [...start, ...crowd], 600, 400), sight);
    // Not beyond the end of the drawing.
    assert.deepEqual(fullest(sight, area, crowd.slice(0, 2), 1700, 1950), { x: 1316, y: -16, scale: 1 });
});

test("a drawing that does not fit is shown around its root", () => {
    const sight = { x: -16, y: -16, scale: 1 };
    const rootAt = (y: number) => around(sight, { width: 300, height: 2000 }, box(0, y), 600, 400);
    assert.deepEqual(rootAt(1000), { x: -16, y: 810, scale: 1 });
    assert.deepEqual(rootAt(0), { x: -16, y: -16, scale: 1 });
    assert.deepEqual(rootAt(1980), { x: -16, y: 1616, scale: 1 });
});

test("the first view shows the root and as many whole nodes as possible", () => {
    const sight = { x: -16, y: -16, scale: 1 };
    const drawing = { width: 1000, height: 300 };
    const root = box(450, 0);
    // With the root in the middle, the first child would be cut off.
    const children = [box(290, 100), box(420, 100), box(550, 100)];
    assert.equal(around(sight, drawing, root, 400, 400).x, 300);
    const first = amongOthers(sight, drawing, root, children, [root, ...children], 400, 400);
    assert.equal(first.x, 290 - 16);
    // Without children, the root is in the middle, or at least visible.
    assert.equal(amongOthers(sight, drawing, root, [], [root], 400, 400).x, 300);
    assert.equal(amongOthers(sight, drawing, box(0, 0), children, children, 400, 400).x, -16);
    // What is near the root is more important than others.
    const near = [box(640, 100)];
    const far = [box(180, 100), box(180, 140), box(380, 100)];
    assert.ok(amongOthers(sight, drawing, root, near, [root, ...near, ...far], 400, 400).x >= 340);
});

test("a first view cuts nodes off at the lower side rather than at the upper one", () => {
    const sight = { x: -16, y: -16, scale: 1 };
    const drawing = { width: 300, height: 900 };
    const others = [box(0, 10), box(0, 360), box(150, 360)];
    // Beside the state, the second row would be whole without the first node.
    assert.equal(amongOthers(sight, drawing, box(0, 60), [], others, 400, 380).y, -16);
    assert.equal(fullest(sight, drawing, [box(0, 30), box(0, 60), box(0, 400)], 400, 400).y, -16);
    const start = withStart({ x: 200, y: 30, width: 100, height: 20 });
    assert.deepEqual(start, { x: 110, y: 0, width: 190, height: 50 });
});

test("of two drawings that do not fit, the one of which a window shows more is chosen", () => {
    const [wide, high] = [
        { width: 2400, height: 1500 },
        { width: 1300, height: 2300 },
    ];
    assert.equal(bestDrawing([wide, high], 1200, 750), 1);
    assert.equal(
        bestDrawing(
            [
                { width: 2000, height: 900 },
                { width: 1800, height: 2300 },
            ],
            1200,
            750,
        ),
        0,
    );
    // Its whole width is better than a larger part.
    assert.equal(
        bestDrawing(
            [
                { width: 2000, height: 900 },
                { ...high, width: 1100 },
            ],
            1200,
            750,
        ),
        1,
    );
    // The wide outline is lower than the narrow one.
    const outlines = [
        { width: 380, height: 2400 },
        { width: 860, height: 1500 },
    ];
    assert.equal(bestDrawing([wide, high, ...outlines], 1200, 750), 3);
    assert.equal(bestDrawing([wide, high, ...outlines], 500, 750), 2);
    assert.equal(bestDrawing([{ width: 700, height: 600 }, high, ...outlines], 1200, 750), 0);
});

function box(x: number, y: number): Box {
    return { x, y, width: 100, height: 20 };
}

test("the view follows a state with the targets of its transitions", () => {
    const drawing = { width: 3000, height: 3000 };
    const sight = { x: 0, y: 0, scale: 1 };
    const at = (x: number, y: number) => ({ x, y, width: 100, height: 50 });
    // Nothing moves while all of them are visible.
    assert.equal(follow(sight, drawing, at(10, 10), [at(300, 200)], 800, 600), sight);
    // A target outside of the window: both are in the middle.
    const both = follow(sight, drawing, at(500, 500), [at(1000, 800)], 800, 600);
    assert.deepEqual(both, { scale: 1, x: 400, y: 375 });
    // If they do not fit, the state is in the middle.
    const one = follow(sight, drawing, at(1500, 1500), [at(2800, 2800)], 800, 600);
    assert.deepEqual(one, { scale: 1, x: 1150, y: 1225 });
});

const COVERAGE_WORDS: CoverageWords = {
    show: "Coverage",
    hint: "",
    all: "in all {0} traces",
    some: "in {0} of {1} traces",
    none: "in none of {0} traces",
    never: "never",
    part: "the first {0} of {1} traces of {2}",
    inAll: "",
    inSome: "",
    inNone: "",
    notVerified: "",
    stale: "",
    returned: "returned {0}",
};

test("coverage in words names the traces and the statuses", () => {
    const node = { traces: 20, statuses: { SUCCESS: 20, FAILURE: 3 } };
    assert.equal(
        nodeCoverageWords(node, 20, COVERAGE_WORDS),
        "in all 20 traces, returned SUCCESS in all 20 traces, returned FAILURE in 3 of 20 traces",
    );
    assert.equal(nodeCoverageWords({ traces: 0, statuses: {} }, 20, COVERAGE_WORDS), "in none of 20 traces");
    const coverage = { traces: 20, simulated: 120, isStale: false, system: "file:///a%20b/main.xml" };
    const words = summaryOf({ ...coverage, nodes: [], edges: [] }, COVERAGE_WORDS);
    assert.equal(words, "the first 20 of 120 traces of main.xml");
});

test("the badge of a part never rounds to none or all of the traces", () => {
    const badges = [0, 1, 500, 999, 1000].map((traces) => badgeOf(traces, 1000, COVERAGE_WORDS));
    assert.deepEqual(badges, ["never", "< 1 %", "50 %", "> 99 %", ""]);
});

test("a coverage is painted only on the picture for which it was asked", () => {
    const nodes = MACHINE.nodes.map(() => null);
    const coverage = { traces: 1, simulated: 1, isStale: false, system: "", nodes };
    assert.ok(isOf({ ...coverage, edges: MACHINE.edges.map(() => 1) }, MACHINE));
    assert.ok(!isOf({ ...coverage, edges: [] }, MACHINE));
});

test("a collapsed namespace has the activity of its parts", () => {
    const collapsed = node("namespace /a", { kind: "namespace", hides: ["node a", "topic /a/go"] });
    const picture: Picture = { ...MACHINE, kind: "ros", nodes: [collapsed, node("topic /all"), node("node b")] };
    const nodes = { "topic /a/go": "message", "topic /all": "message" };
    const edges = [
        { from: "node a", to: "topic /all" },
        { from: "topic /all", to: "node b" },
    ];
    assert.deepEqual(shownActivity(picture, { nodes, edges }), {
        nodes: { "namespace /a": "message", "topic /all": "message" },
        edges: [
            { from: "namespace /a", to: "topic /all" },
            { from: "topic /all", to: "node b" },
        ],
    });
});
