// SPDX-License-Identifier: Apache-2.0
/** Lines that lead out of the view: where they cross its border, and to which node. */

import type { Box, Point } from "../contract";
import type { Sight } from "./find";

/** A drawn line: the indexes of its first edge and of its ends, and its corners from the source on. */
export interface DrawnLine {
    readonly edge: number;
    readonly source: number;
    readonly target: number;
    readonly points: readonly Point[];
}

export const SIDES = ["top", "bottom", "left", "right"] as const;
export type Side = (typeof SIDES)[number];

/** A line with one visible end: the side that it crosses, where on this side, in pixels, and its other end. */
export interface Exit {
    readonly side: Side;
    readonly at: number;
    readonly edge: number;
    readonly node: number;
    /** Whether the line leads out of the view, not into it. */
    readonly isOut: boolean;
    /** The distance of the other end from the view, in pixels. */
    readonly distance: number;
}

/** The height of the bands with chips above and below a picture, and the width of those beside it, in pixels. */
const BAND = 24;
export const CHIP = 120;
/** Smaller windows have no space for bands above and below a picture, or beside it, in pixels. */
const SMALLEST_WINDOW = { width: 480, height: 240 };

/** The sizes of what covers a window at its sides, in pixels. */
export type Bands = Readonly<Record<Side, number>>;

export const NO_BANDS: Bands = { top: 0, bottom: 0, left: 0, right: 0 };

/** The bands for chips: at the sides at which the drawing goes on. */
export function bandsOf(
    { x, y, scale }: Sight,
    drawn: { readonly width: number; readonly height: number },
    width: number,
    height: number,
): Bands {
    const band = height < SMALLEST_WINDOW.height ? 0 : BAND;
    const chip = width < SMALLEST_WINDOW.width ? 0 : CHIP;
    return {
        top: y > 0 ? band : 0,
        bottom: (drawn.height - y) * scale > height ? band : 0,
        left: x > 0 ? chip : 0,
        right: (drawn.width - x) * scale > width ? chip : 0,
    };
}

/** Whether a line has a visible end in a window. */
export function hasVisibleEnd(
    { source, target }: DrawnLine,
    boxes: ReadonlyMap<number, Box>,
    { x, y, scale }: Sight,
    width: number,
    height: number,
): boolean {
    return [boxes.get(source), boxes.get(target)].some(
        (box) =>
            box &&
            box.x + box.width > x &&
            box.x < x + width / scale &&
            box.y + box.height > y &&
            box.y < y + height / scale,
    );
}

/** A line ends at its node if it is not farther from it, in pixels of the drawing; others end at their labels. */
const AT_NODE = 12;

/** The places where lines leave a window: of those that have one visible end, and both places of those that have two but
 * lead outside between them. */
export function exitsOf(
    lines: readonly DrawnLine[],
    boxes: ReadonlyMap<number, Box>,
    { x, y, scale }: Sight,
    width: number,
    height: number,
): Exit[] {
    const seen = ({ x: px, y: py }: Point): Point => ({ x: (px - x) * scale, y: (py - y) * scale });
    const middle = (box: Box): Point => seen({ x: box.x + box.width / 2, y: box.y + box.height / 2 });
    const isVisible = ({ x: px, y: py }: Point) => px >= 0 && px <= width && py >= 0 && py <= height;
    const inside = (point: Point): Point => ({ x: within(point.x, 0, width), y: within(point.y, 0, height) });
    return lines.flatMap(({ edge, source, target, points }) => {
        const [from, to] = [boxes.get(source), boxes.get(target)];
        if (!from || !to) return [];
        const exitAt = (isOut: boolean, side: Side, entry: Point): Exit => {
            const other = middle(isOut ? to : from);
            const distance = Math.hypot(other.x - entry.x, other.y - entry.y);
            const at = side === "top" || side === "bottom" ? entry.x : entry.y;
            return { side, at, edge, node: isOut ? target : source, isOut, distance };
        };
        const isOut = isVisible(middle(from));
        const path = points.map(seen);
        if (isOut && isVisible(middle(to))) {
            return [true, false].flatMap((way) => {
                const outside = (way ? path : path.toReversed()).find((point) => !isVisible(point));
                if (!outside) return [];
                const entry = inside(outside);
                return [exitAt(way, sideOf(outside, entry), entry)];
            });
        }
        if (!isOut && !isVisible(middle(to))) return [];
        const [first, last] = [points[0], points.at(-1)];
        if (!isOut && last && distanceTo(to, last) > AT_NODE) return [];
        const inwards = isOut ? path.toReversed() : path;
        for (const [index, start] of inwards.entries()) {
            const end = inwards[index + 1];
            if (!end) break;
            const entry = inside(start);
            if (!isBetween(entry, start, end)) continue;
            if (entry.x === start.x && entry.y === start.y) {
                const isAtNode =
                    index === 0 && first && last && distanceTo(isOut ? to : from, isOut ? last : first) <= AT_NODE;
                const side = isAtNode ? sideNear(entry, width, height) : undefined;
                if (!side) break; // its end is visible
                return [exitAt(isOut, side, entry)];
            }
            return [exitAt(isOut, sideOf(start, entry), entry)];
        }
        return [];
    });
}

/** The side of a window at which a line to a place outside crosses it. */
function sideOf(outside: Point, crossing: Point): Side {
    if (crossing.x === outside.x) return outside.y < crossing.y ? "top" : "bottom";
    return outside.x < crossing.x ? "left" : "right";
}

/** Exits that share a chip, the nearest node first. The lines are between `from` and `to`. */
export interface Chip {
    readonly side: Side;
    readonly from: number;
    readonly to: number;
    /** Whether the lines lead out of the view, or into it, or both. */
    readonly way: "out" | "in" | "both";
    readonly exits: readonly Exit[];
}

/** Lines of a direction to the same node at this distance share a chip, in pixels. */
const SAME_NODE = 160;

/** The exits at one side of a window, grouped so that neighbours of a direction within a distance share a chip, and those
 * that lead to the same node if they are not far from each other, or if no other one is between them. */
export function chipsOf(exits: readonly Exit[], distance: number): Chip[] {
    const groups: Exit[][] = [];
    for (const exit of exits.toSorted((one, other) => one.at - other.at)) {
        const previous = groups.at(-1);
        if (previous?.every(({ node }) => node === exit.node)) {
            previous.push(exit);
            continue;
        }
        const group = groups.findLast((others) => others.every(({ isOut }) => isOut === exit.isOut));
        const isSame = group?.some(({ node, at }) => node === exit.node && exit.at - at <= SAME_NODE);
        if (group && (isSame || exit.at - (group[0]?.at ?? -Infinity) <= distance)) group.push(exit);
        else groups.push([exit]);
    }
    return groups.flatMap((group) => {
        const [first, last] = [group[0], group.at(-1)];
        if (!first || !last) return [];
        const nodes = new Set<number>();
        const own = group.toSorted((one, other) => one.distance - other.distance);
        const different = own.filter(({ node }) => !nodes.has(node) && nodes.add(node));
        const isMixed = group.some(({ isOut }) => isOut !== first.isOut);
        const way = isMixed ? "both" : first.isOut ? "out" : "in";
        return [{ side: first.side, from: first.at, to: last.at, way, exits: different }];
    });
}

/** The places of the starts of things in a row, each near the place of its middle, between two limits. */
export function inARow(
    things: readonly { readonly at: number; readonly size: number }[],
    low: number,
    high: number,
    gap: number,
): number[] {
    const places: number[] = [];
    let free = low;
    for (const { at, size } of things) {
        places.push(Math.max(free, at - size / 2));
        free = (places.at(-1) ?? low) + size + gap;
    }
    let limit = high;
    for (const [index, { size }] of [...things.entries()].reverse()) {
        places[index] = Math.max(low, Math.min(places[index] ?? low, limit - size));
        limit = places[index] - gap;
    }
    return places;
}

/** The corners of a line from the attribute `d` of its path, in which the control points of curves are corners. */
export function cornersOf(path: string): Point[] {
    const numbers = (path.match(/-?[\d.]+/g) ?? []).map(Number);
    return numbers.flatMap((x, index) => (index % 2 === 0 ? [{ x, y: numbers[index + 1] ?? 0 }] : []));
}

/** The side of a window at which a line ends at its node, so that the node is not seen. */
function sideNear({ x, y }: Point, width: number, height: number): Side | undefined {
    const distances = { bottom: height - y, top: y, right: width - x, left: x };
    return SIDES.find((side) => distances[side] <= AT_NODE);
}

function within(value: number, low: number, high: number): number {
    return Math.min(Math.max(value, low), high);
}

/** Whether a point is on a horizontal or vertical piece of a line. */
function isBetween(point: Point, start: Point, end: Point): boolean {
    const isIn = (value: number, one: number, other: number) =>
        value >= Math.min(one, other) - 0.01 && value <= Math.max(one, other) + 0.01;
    return isIn(point.x, start.x, end.x) && isIn(point.y, start.y, end.y);
}

function distanceTo({ x, y, width, height }: Box, point: Point): number {
    return Math.hypot(point.x - within(point.x, x, x + width), point.y - within(point.y, y, y + height));
}
