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

/** The distance of chips from the picture, in which leaders join them to their lines, in pixels. */
export const LEADER = 12;
/** The height of the bands with chips above and below a picture, and the largest width of those beside it, in pixels. */
const BAND = 22 + LEADER;
export const CHIP = 200;
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

/** Whether a window shows a whole box. */
export function isWhole(box: Box, { x, y, scale }: Sight, width: number, height: number): boolean {
    return (
        box.x >= x && box.x + box.width <= x + width / scale && box.y >= y && box.y + box.height <= y + height / scale
    );
}

/** A line ends at its node if it is not farther from it, in pixels of the drawing; others end at their labels. */
const AT_NODE = 12;

/** The places where lines with one visible end leave a window. Lines between two visible nodes have none, also if they
 * lead outside between them, except if they end there at a label with the name of their target. */
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
        const [first, last] = [points[0], points.at(-1)];
        const endsAtLabel = last !== undefined && distanceTo(to, last) > AT_NODE;
        if (isVisible(middle(to))) {
            if (isOut ? !endsAtLabel || isVisible(seen(last)) : endsAtLabel) return [];
        } else if (!isOut) return [];
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

/** Lines of a direction that share a chip. */
export interface Chip {
    readonly side: Side;
    /** Whether the lines lead out of the view, not into it. */
    readonly isOut: boolean;
    /** The lines from the first to the last place. */
    readonly lines: readonly Exit[];
    /** One line for each node that the chip names, the nearest first. */
    readonly exits: readonly Exit[];
}

/** Lines of a direction to the same node at this distance share a chip, in pixels. */
const SAME_NODE = 160;

/** The exits at one side of a window, grouped so that those of a direction within a distance share a chip, and those
 * that lead to the same node if they are not far from each other. Those of a chip are neighbours, unless `skips`: then
 * others may be between them. */
export function chipsOf(exits: readonly Exit[], distance: number, skips = false): Chip[] {
    const groups: Exit[][] = [];
    for (const exit of exits.toSorted((one, other) => one.at - other.at)) {
        const last = groups.at(-1);
        const group = skips ? groups.findLast((others) => isAlike(others, exit)) : last;
        const isSame = group?.some(({ node, at }) => node === exit.node && exit.at - at <= SAME_NODE);
        const isNear = isSame === true || exit.at - (group?.[0]?.at ?? -Infinity) <= distance;
        if (group && isAlike(group, exit) && isNear) group.push(exit);
        else groups.push([exit]);
    }
    return groups.flatMap((lines) => {
        const [first] = lines;
        if (!first) return [];
        const nodes = new Set<number>();
        const own = lines.toSorted((one, other) => one.distance - other.distance);
        const different = own.filter(({ node }) => !nodes.has(node) && nodes.add(node));
        return [{ side: first.side, isOut: first.isOut, lines, exits: different }];
    });
}

function isAlike(others: readonly Exit[], { isOut }: Exit): boolean {
    return others.every((other) => other.isOut === isOut);
}

/** From a place where a line leaves a view to the place where it ends at its chip, along the side. */
export interface Leader {
    readonly exit: Exit;
    readonly end: number;
}

/** A chip with its place along its side, in pixels. */
export interface PlacedChip {
    readonly chip: Chip;
    readonly start: number;
    readonly size: number;
    readonly leaders: readonly Leader[];
}

/** How chips are placed at a side: between two limits, at a distance from each other, with sizes of which that of a chip
 * is at least the one that its text needs. Leaders end at a distance from the ends of a chip. All in pixels. */
export interface Row {
    readonly low: number;
    readonly high: number;
    readonly gap: number;
    readonly round: number;
    readonly sizeOf: (chip: Chip) => number;
}

/** The chips of exits, each as near to its lines as the others allow. Lines within `near` share a chip, and more if there
 * is no space. */
export function placedChips(exits: readonly Exit[], near: number, row: Row): PlacedChip[] {
    const { low, high, gap, round } = row;
    const extent = ({ lines }: Chip) => [lines[0]?.at ?? 0, lines.at(-1)?.at ?? 0] as const;
    const things = fittingChips(exits, near, row).map((chip) => {
        const [from, to] = extent(chip);
        return { chip, at: (from + to) / 2, size: Math.min(row.sizeOf(chip), high - low) };
    });
    const places = inARow(things, low, high, gap);
    return things.map(({ chip, size }, index) => {
        const start = places[index] ?? low;
        const end = (at: number) => within(at, start + round, start + size - round);
        return { chip, start, size, leaders: chip.lines.map((exit) => ({ exit, end: end(exit.at) })) };
    });
}

function fittingChips(exits: readonly Exit[], near: number, { low, high, gap, sizeOf }: Row): Chip[] {
    const fits = (chips: readonly Chip[]) => chips.reduce((sum, chip) => sum + sizeOf(chip) + gap, -gap) <= high - low;
    const middle = ({ lines }: Chip) => (lines[0]?.at ?? 0) + (lines.at(-1)?.at ?? 0);
    for (let distance = near; distance <= 1.5 * (high - low); distance *= 1.5)
        for (const skips of [false, true]) {
            const chips = chipsOf(exits, distance, skips).toSorted((one, other) => middle(one) - middle(other));
            if (fits(chips)) return chips;
        }
    return chipsOf(exits, Infinity, true);
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
