// SPDX-License-Identifier: Apache-2.0
/** Lines that lead out of the view, and the lines of a node. */

import assert from "node:assert/strict";
import { test } from "node:test";
import type { Picture } from "../src/pictures/contract";
import {
    bandsOf,
    chipsOf,
    cornersOf,
    exitsOf,
    hasVisibleEnd,
    inARow,
    isWhole,
    NO_BANDS,
    placedChips,
    type Chip,
    type DrawnLine,
    type Exit,
} from "../src/pictures/view/exits";
import { beside, trimsOf } from "../src/pictures/view/find";
import { edgesOf } from "../src/pictures/view/surroundings";

const SIGHT = { x: 0, y: 0, scale: 1 };
const BOXES = new Map([
    [0, { x: 40, y: 40, width: 20, height: 20 }],
    [1, { x: 40, y: 300, width: 20, height: 20 }],
    [2, { x: 70, y: 40, width: 20, height: 20 }],
]);

function line(source: number, target: number, path: string): DrawnLine {
    return { edge: 7, source, target, points: cornersOf(path) };
}

test("a line that leaves the view has an exit with its other end", () => {
    const down = line(0, 1, "M 50 60 L 50 90 Q 50 96 56 96 L 60 96 L 60 200 L 50 200 L 50 300");
    const [exit, ...others] = exitsOf([down], BOXES, SIGHT, 100, 100);
    assert.deepEqual(others, []);
    assert.deepEqual({ ...exit, distance: 0 }, { side: "bottom", at: 60, edge: 7, node: 1, isOut: true, distance: 0 });
    // The same line the other way leads into the view.
    const up = { ...down, source: 1, target: 0, points: down.points.toReversed() };
    const [entry] = exitsOf([up], BOXES, SIGHT, 100, 100);
    assert.deepEqual([entry?.side, entry?.at, entry?.node, entry?.isOut], ["bottom", 60, 1, false]);
});

test("the exit is in pixels of the window, at the last place where the line leaves it", () => {
    const around = line(0, 1, "M 40 50 L -20 50 L -20 80 L 30 80 L 30 -20 L -50 -20 L -50 310 L 40 310");
    const [exit] = exitsOf([around], BOXES, { x: -10, y: -10, scale: 0.5 }, 60, 60);
    assert.deepEqual([exit?.side, exit?.at], ["top", 20]);
});

test("a line that ends at a node just behind the border has an exit there", () => {
    const near = new Map([...BOXES, [1, { x: 40, y: 96, width: 20, height: 20 }] as const]);
    const [exit] = exitsOf([line(0, 1, "M 50 60 L 50 95")], near, SIGHT, 100, 100);
    assert.deepEqual([exit?.side, exit?.at, exit?.node], ["bottom", 50, 1]);
    const far = new Map([...BOXES, [1, { x: 40, y: 80, width: 20, height: 60 }] as const]);
    assert.deepEqual(exitsOf([line(0, 1, "M 50 60 L 50 80")], far, SIGHT, 100, 100), []);
});

test("lines without a visible end, with two, or that end at a label have no exit", () => {
    const lines = [
        line(0, 2, "M 50 40 L 50 20 L 80 20 L 80 40"),
        line(1, 1, "M 50 300 L 50 0"),
        line(0, 1, "M 50 60 L 50 90"),
        // This line ends at a label that names its target.
        { ...line(1, 0, "M 50 300 L 50 280"), points: [...cornersOf("M 50 300 L 50 280")] },
    ];
    assert.deepEqual(exitsOf(lines, BOXES, SIGHT, 100, 100), []);
});

test("a line between two visible ends has no exit, unless it ends outside at a label", () => {
    const around = "M 50 40 L 50 -20 L 130 -20 L 130 50";
    assert.deepEqual(exitsOf([line(0, 2, `${around} L 90 50`)], BOXES, SIGHT, 100, 100), []);
    const exits = exitsOf([line(0, 2, around)], BOXES, SIGHT, 100, 100);
    assert.deepEqual(
        exits.map(({ side, at, node, isOut }) => [side, at, node, isOut]),
        [["top", 50, 2, true]],
    );
});

test("a line leads only through a window that shows neither of its ends, nor a part of them", () => {
    const through = line(1, 1, "M 50 300 L 50 0");
    assert.ok(!hasVisibleEnd(through, BOXES, SIGHT, 100, 100));
    assert.ok(hasVisibleEnd(through, BOXES, SIGHT, 100, 310));
    assert.ok(hasVisibleEnd(line(0, 1, ""), BOXES, SIGHT, 100, 100));
});

function named(chips: readonly Chip[]): unknown[] {
    return chips.map(({ lines, isOut, exits }) => [lines.map(({ at }) => at), isOut, exits.map(({ node }) => node)]);
}

function exitAt(at: number, node: number, isOut = true, distance = at): Exit {
    return { side: "bottom", at, edge: at, node, isOut, distance };
}

test("a window shows a whole box, or only a part of it", () => {
    const box = { x: 10, y: 10, width: 20, height: 20 };
    assert.ok(isWhole(box, { x: 5, y: 5, scale: 2 }, 50, 50));
    assert.ok(!isWhole(box, { x: 5, y: 5, scale: 2 }, 49, 50));
    assert.ok(!isWhole(box, { x: 11, y: 5, scale: 2 }, 90, 50));
});

test("neighbouring exits of a direction share a chip, which names each node once, the nearest first", () => {
    const exits = [exitAt(30, 3, true, 90), exitAt(10, 1, true, 50), exitAt(20, 2, true, 10), exitAt(25, 2, true, 10)];
    const other = exitAt(15, 4, false, 5);
    assert.deepEqual(named(chipsOf(exits, 15)), [
        [[10, 20, 25], true, [2, 1]],
        [[30], true, [3]],
    ]);
    assert.deepEqual(named(chipsOf([...exits, other], 15)), [
        [[10], true, [1]],
        [[15], false, [4]],
        [[20, 25, 30], true, [2, 3]],
    ]);
    assert.deepEqual(named(chipsOf([...exits, other], 15, true)), [
        [[10, 20, 25], true, [2, 1]],
        [[15], false, [4]],
        [[30], true, [3]],
    ]);
});

test("lines of one node share a chip if they are near, but those that leave it and those that enter it do not", () => {
    const exits = [exitAt(10, 1), exitAt(90, 1), exitAt(95, 1, false), exitAt(400, 1)];
    assert.deepEqual(named(chipsOf(exits, 15)), [
        [[10, 90], true, [1]],
        [[95], false, [1]],
        [[400], true, [1]],
    ]);
});

test("each leader leads from the place of its line to a chip that names its other end, also in a narrow row", () => {
    let seed = 1;
    const random = (below: number) => (seed = (seed * 16807) % 2147483647) % below;
    for (let round = 0; round < 200; round++) {
        const exits = Array.from({ length: 1 + random(40) }, () => exitAt(10 + random(900), random(12), random(2) > 0));
        const row = {
            low: 4,
            high: 900,
            gap: 4,
            round: 8,
            sizeOf: ({ exits: own }: Chip) => 60 * Math.min(2, own.length),
        };
        const placed = placedChips(exits, 50, row);
        const leaders = placed.flatMap((one) => one.leaders);
        assert.deepEqual(new Set(leaders.map(({ exit }) => exit)), new Set(exits));
        assert.equal(leaders.length, exits.length);
        let free = row.low;
        for (const { chip, start, size, leaders: own } of placed) {
            assert.ok(start >= free - 0.01 && start + size <= row.high + 0.01);
            free = start + size + row.gap;
            for (const { exit, end } of own) {
                assert.ok(end > start && end < start + size);
                assert.equal(exit.isOut, chip.isOut);
                assert.ok(chip.exits.some(({ node }) => node === exit.node));
                // The chip is moved only if others are at its place.
                if (exits.length === 1 && exit.at > 50 && exit.at < 850) assert.equal(end, exit.at);
            }
        }
    }
});

test("bands for chips are at the sides at which the drawing goes on", () => {
    const drawn = { width: 600, height: 600 };
    const { top, bottom, left, right } = bandsOf({ x: -5, y: 0, scale: 1 }, drawn, 700, 300);
    assert.deepEqual([top, left, right], [0, 0, 0]);
    assert.ok(bottom > 0);
    assert.deepEqual(bandsOf({ x: -5, y: -5, scale: 0.5 }, drawn, 500, 320), NO_BANDS);
    const inside = bandsOf({ x: 50, y: 50, scale: 1 }, drawn, 500, 300);
    assert.ok(inside.top > 0 && inside.left > 0 && inside.right > 0);
    // In a small pane, they would cover most of the picture.
    assert.deepEqual(bandsOf({ x: 50, y: 50, scale: 1 }, drawn, 300, 200), NO_BANDS);
});

const SMALL = { sight: { x: -10, y: -1, scale: 1 }, width: 140 };

test("the first view is smaller at its sides so that it cuts off nothing", () => {
    const rows = Array.from({ length: 20 }, (_, row) => ({ x: 100, y: row * 60, width: 80, height: 30 }));
    for (let height = 400; height < 460; height += 7) {
        const frame = { sight: { x: 0, y: 7, scale: 1 }, width: 140, height };
        const { top, bottom, left, right } = trimsOf(rows, [], frame);
        const [upper, lower] = [7 + top, 7 + height - bottom];
        const cut = rows.filter((row) => [upper, lower].some((at) => row.y < at && row.y + row.height > at));
        assert.deepEqual(cut, [], `height ${height}`);
        assert.equal(left, 0);
        assert.ok(right > 40 && bottom < 40);
    }
    // Nor does it show the border of what is just outside.
    assert.ok(trimsOf([{ x: 0, y: 100, width: 50, height: 50 }], [], { ...SMALL, height: 101 }).bottom > 0);
    // Rather a label is cut off than a node: its line stays.
    const node = { x: 0, y: 60, width: 50, height: 50 };
    const label = { x: 0, y: 105, width: 50, height: 30 };
    assert.deepEqual(trimsOf([node], [label], { ...SMALL, height: 120 }), NO_BANDS);
    // What fits as a whole is not changed, and what is much too large is cut off.
    const all = { sight: { x: 0, y: -10, scale: 1 }, width: 400, height: 1300 };
    assert.deepEqual(trimsOf(rows, [], all), NO_BANDS);
    const large = [{ x: 20, y: 0, width: 1000, height: 1000 }];
    assert.deepEqual(trimsOf(large, [], { ...all, width: 500, height: 500 }), NO_BANDS);
});

test("the part of a window beside its bands", () => {
    const bands = { top: 10, bottom: 20, left: 30, right: 40 };
    assert.deepEqual(beside({ x: 5, y: 6, scale: 2 }, 200, 100, bands), {
        sight: { x: 20, y: 11, scale: 2 },
        width: 130,
        height: 70,
    });
});

test("chips in a row do not overlap, and stay near their lines and inside", () => {
    const row = [
        { at: 5, size: 40 },
        { at: 30, size: 40 },
        { at: 150, size: 20 },
        { at: 195, size: 30 },
    ];
    assert.deepEqual(inARow(row, 4, 200, 4), [4, 48, 140, 170]);
});

test("the lines of a node leave it, also through a choice, or enter it", () => {
    const node = (id: string, kind = "state") => ({ id, kind });
    const edge = (source: string, target: string) => ({ source, target });
    const picture = {
        nodes: [node("a"), node("b"), node("c", "choice"), node("d")],
        edges: [edge("a", "b"), edge("a", "c"), edge("c", "d"), edge("d", "a"), edge("a", "a"), edge("b", "d")],
    } as unknown as Picture;
    assert.deepEqual(edgesOf(picture, 0), { leaving: [0, 1, 2], entering: [3] });
    assert.deepEqual(edgesOf(picture, 3), { leaving: [3], entering: [1, 2, 5] });
    assert.deepEqual(edgesOf(picture, -1), { leaving: [], entering: [] });
});
