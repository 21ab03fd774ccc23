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

/** The height of the bands with the chips at the upper and the lower side of a window, in pixels. */
const BAND = 24;

/** The usual width of a chip, in pixels. */
const CHIP = 110;

/** The sizes of what covers a window at its sides, in pixels. */
export type Bands = Readonly<Record<Side, number>>;

export const NO_BANDS: Bands = { top: 0, bottom: 0, left: 0, right: 0 };

/** What chips cover: the sides at which the drawing goes on. */
export function bandsOf(
    { x, y, scale }: Sight,
    drawn: { readonly width: number; readonly height: number },
    width: number,
    height: number,
): Bands {
    return {
        top: y > 0 ? BAND : 0,
        bottom: (drawn.height - y) * scale > height ? BAND : 0,
        left: x > 0 ? CHIP : 0,
        right: (drawn.width - x) * scale > width ? CHIP : 0,
    };
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
        const [first, last] = [points[0], points.at(-1)];
        if (!isOut && last && distanceTo(to, last) > AT_NODE) return [];
        const path = (isOut ? points.toReversed() : points).map(seen);
        const other = middle(isOut ? to : from);
        const exitAt = (side: Side, entry: Point): Exit => {
            const distance = Math.hypot(other.x - entry.x, other.y - entry.y);
            const at = side === "top" || side === "bottom" ? entry.x : entry.y;
            return { side, at, edge, node: isOut ? target : source, isOut, distance };
        };
        for (const [index, start] of path.entries()) {
            const end = path[index + 1];
            if (!end) break;
            const entry = { x: within(start.x, 0, width), y: within(start.y, 0, height) };
            if (!isBetween(entry, start, end)) continue;
            if (entry.x === start.x && entry.y === start.y) {
                const isAtNode =
                    index === 0 && first && last && distanceTo(isOut ? to : from, isOut ? last : first) <= AT_NODE;
                const side = isAtNode ? sideNear(entry, width, height) : undefined;
                if (!side) break; // its end is visible
                return [exitAt(side, entry)];
            }
            const isVertical = entry.x === start.x;
            const side = isVertical ? (start.y < 0 ? "top" : "bottom") : start.x < 0 ? "left" : "right";
            return [exitAt(side, entry)];
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

/** Lines to the same node at this distance share a chip, in pixels. */
const SAME_NODE = 160;

/** The exits at one side of a window, grouped so that neighbours of a direction within a distance share a chip, and those
 * that lead to the same node if they are not far from each other. */
export function chipsOf(exits: readonly Exit[], distance: number): Chip[] {
    const groups: Exit[][] = [];
    for (const exit of exits.toSorted((one, other) => one.at - other.at)) {
        const group = groups.findLast(([first]) => first?.isOut === exit.isOut);
        const first = group?.[0];
        const isSame = group?.some(({ node, at }) => node === exit.node && exit.at - at <= SAME_NODE);
        if (group && first && (isSame || exit.at - first.at <= distance)) group.push(exit);
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
