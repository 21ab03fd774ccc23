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

export type Side = "top" | "bottom" | "left" | "right";

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

/** A line ends at its node if it is not farther from it, in pixels of the drawing; others end at their labels. */
const AT_NODE = 12;

/** The places where lines leave a window, of those that have exactly one visible end. */
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
    return lines.flatMap(({ edge, source, target, points }) => {
        const [from, to] = [boxes.get(source), boxes.get(target)];
        if (!from || !to || isVisible(middle(from)) === isVisible(middle(to))) return [];
        const isOut = isVisible(middle(from));
        const last = points.at(-1);
        if (!isOut && last && distanceTo(to, last) > AT_NODE) return [];
        const path = (isOut ? points.toReversed() : points).map(seen);
        const other = middle(isOut ? to : from);
        for (const [index, start] of path.entries()) {
            const end = path[index + 1];
            if (!end) break;
            const entry = { x: within(start.x, 0, width), y: within(start.y, 0, height) };
            if (!isBetween(entry, start, end)) continue;
            if (entry.x === start.x && entry.y === start.y) break; // its end is visible
            const isVertical = entry.x === start.x;
            const side = isVertical ? (start.y < 0 ? "top" : "bottom") : start.x < 0 ? "left" : "right";
            const distance = Math.hypot(other.x - entry.x, other.y - entry.y);
            return [{ side, at: isVertical ? entry.x : entry.y, edge, node: isOut ? target : source, isOut, distance }];
        }
        return [];
    });
}

/** Exits that share a chip, the nearest node first; `at` is in their middle. */
export interface Chip {
    readonly side: Side;
    readonly at: number;
    readonly isOut: boolean;
    readonly exits: readonly Exit[];
}

/** The exits at one side of a window, grouped so that neighbours of a direction within a distance share a chip. */
export function chipsOf(exits: readonly Exit[], distance: number): Chip[] {
    const groups: Exit[][] = [];
    for (const exit of exits.toSorted((one, other) => one.at - other.at)) {
        const group = groups.findLast(([first]) => first?.isOut === exit.isOut);
        const first = group?.[0];
        if (group && first && exit.at - first.at <= distance) group.push(exit);
        else groups.push([exit]);
    }
    return groups.flatMap((group) => {
        const [first, last] = [group[0], group.at(-1)];
        if (!first || !last) return [];
        const nodes = new Set<number>();
        const own = group.toSorted((one, other) => one.distance - other.distance);
        const different = own.filter(({ node }) => !nodes.has(node) && nodes.add(node));
        const { side, isOut } = first;
        return [{ side, at: (first.at + last.at) / 2, isOut, exits: different }];
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
