// SPDX-License-Identifier: Apache-2.0
/** Navigation in a picture: by arrow keys, by search, and by zooming. */

import { NO_BANDS, SIDES, type Bands, type Side } from "./exits";
import { DIRECTIONS, type Box, type Drawing, type DrawnNode, type Picture, type Point } from "../contract";

export type Arrow = "ArrowUp" | "ArrowDown" | "ArrowLeft" | "ArrowRight";

const WAYS: Record<Arrow, Point> = {
    ArrowUp: { x: 0, y: -1 },
    ArrowDown: { x: 0, y: 1 },
    ArrowLeft: { x: -1, y: 0 },
    ArrowRight: { x: 1, y: 0 },
};

export function isArrow(key: string): key is Arrow {
    return key in WAYS;
}

/** The index of the nearest node in a direction. Sideways distances have a greater weight. */
export function neighbour(nodes: readonly DrawnNode[], from: number, direction: Arrow): number | undefined {
    const start = nodes.find((node) => node.index === from);
    if (!start) return nodes[0]?.index;
    const way = WAYS[direction];
    const origin = middle(start);
    let best: number | undefined;
    let least = Infinity;
    for (const node of nodes) {
        const { x, y } = middle(node);
        const ahead = (x - origin.x) * way.x + (y - origin.y) * way.y;
        const aside = Math.abs((x - origin.x) * way.y) + Math.abs((y - origin.y) * way.x);
        if (node === start || ahead <= 1) continue;
        const far = ahead + 3 * aside;
        if (far < least) [least, best] = [far, node.index];
    }
    return best;
}

/** The indexes of the nodes that contain all words of a text, ignoring case. A state contains its transitions. */
export function search(picture: Picture, text: string): number[] {
    const words = text
        .toLowerCase()
        .split(/\s+/)
        .filter((word) => word !== "");
    if (words.length === 0) return [];
    return picture.nodes.flatMap((node, index) => {
        const leaving = picture.edges.flatMap(({ source, labels }) => (source === node.id ? labels : []));
        const all = [node.kind, node.label, ...node.details, ...leaving].join(" ").toLowerCase();
        return words.every((word) => all.includes(word)) ? [index] : [];
    });
}

/** The visible part of a drawing: the point at the top left, and the zoom factor. */
export interface Sight extends Point {
    readonly scale: number;
}

const MARGIN = 16;
/** The minimum legible scale: the smallest texts have 12 px, and need at least 11 px on the screen. */
const LEGIBLE = 11 / 12;
/** The smallest scale at which a drawing is shown as a whole first: the smallest texts have at least 10 px. */
const LEGIBLE_WHOLE = 10 / 12;
type Area = Pick<Drawing, "width" | "height">;

function scaleOf(drawing: Area, width: number, height: number): number {
    const across = (width - 2 * MARGIN) / Math.max(1, drawing.width);
    return Math.min(1, across, (height - 2 * MARGIN) / Math.max(1, drawing.height));
}

/** The view that shows a whole drawing in a window; small drawings are not enlarged. */
export function fit(drawing: Area, width: number, height: number): Sight {
    return at(drawing, width, height, Math.max(0.05, scaleOf(drawing, width, height)));
}

/** The view that shows a whole drawing if it is legible, otherwise as much of it as is legible, or at least has a scale,
 * beginning at its start. */
export function fitLegibly(drawing: Area, width: number, height: number, least = LEGIBLE): Sight {
    const scale = scaleOf(drawing, width, height);
    return at(drawing, width, height, scale >= Math.min(least, LEGIBLE_WHOLE) ? scale : least);
}

/** The size of the largest map of a drawing, in pixels. */
export const LARGEST_MAP: Area = { width: 110, height: 190 };
/** The distance of the map from what is beside it, with its border, in pixels. */
export const MAP_DISTANCE = 12;

/** The view at a scale. A drawing that is smaller than the window is centred; others are shown from their start. */
function at(drawing: Area, width: number, height: number, scale: number): Sight {
    const start = (size: number, window: number) => (size <= window ? (size - window) / 2 : -MARGIN / scale);
    return { scale, x: start(drawing.width, width / scale), y: start(drawing.height, height / scale) };
}

/** The index of the first drawing of a tree as an outline. */
export const OUTLINE = DIRECTIONS.indexOf("outline");

/**
 * The index of the drawing that fits a window best: it is legible as a whole, or at least in its whole width; of several
 * others, the one of which the window shows the largest part. An outline is used only if no other drawing is legible as a
 * whole. `least` is the minimum legible scale.
 */
export function bestDrawing(drawings: readonly Area[], width: number, height: number, least = LEGIBLE): number {
    const rank = (drawing: Area): readonly number[] => {
        const scale = scaleOf(drawing, width, height);
        if (scale >= Math.min(least, LEGIBLE_WHOLE))
            return [scale >= least ? 2 : 1, Number(drawings.indexOf(drawing) < OUTLINE), scale];
        const beside = width - gutter(mapOf(drawing, LARGEST_MAP.width, LARGEST_MAP.height));
        const across = Math.min(1, (beside - 2 * MARGIN) / (drawing.width * least));
        const along = Math.min(1, (height - 2 * MARGIN) / (drawing.height * least));
        return [0, Number(across === 1), across * along];
    };
    let best = 0;
    drawings.forEach((drawing, index) => {
        const [mine, other] = [rank(drawing), rank(drawings[best] ?? drawing)];
        const differs = mine.findIndex((value, place) => value !== other[place]);
        if (differs >= 0 && (mine[differs] ?? 0) > (other[differs] ?? 0)) best = index;
    });
    return best;
}

/** The view moved by a distance on the screen. */
export function pan(sight: Sight, dx: number, dy: number): Sight {
    return { ...sight, x: sight.x + dx / sight.scale, y: sight.y + dy / sight.scale };
}

/** The view zoomed by a factor around a fixed point of the window. */
export function zoom(sight: Sight, factor: number, about: Point): Sight {
    const scale = Math.min(4, Math.max(0.05, sight.scale * factor));
    return {
        scale,
        x: sight.x + about.x / sight.scale - about.x / scale,
        y: sight.y + about.y / sight.scale - about.y / scale,
    };
}

/** The view moved by the minimum distance that makes a box visible. */
export function reveal(sight: Sight, box: Box, width: number, height: number): Sight {
    const [w, h] = [width / sight.scale, height / sight.scale];
    const inside = (at: number, low: number, size: number, whole: number) =>
        low < at || size > whole ? low - MARGIN : low + size > at + whole ? low + size - whole + MARGIN : at;
    return { ...sight, x: inside(sight.x, box.x, box.width, w), y: inside(sight.y, box.y, box.height, h) };
}

/** The width that the map needs beside a picture, in pixels. */
export function gutter(map: Area): number {
    return map.width + 2 * MAP_DISTANCE;
}

/** The part of a window that bands at its sides do not cover. */
export interface Frame {
    readonly sight: Sight;
    readonly width: number;
    readonly height: number;
}

export function beside(sight: Sight, width: number, height: number, bands: Bands): Frame {
    return {
        sight: pan(sight, bands.left, bands.top),
        width: width - bands.left - bands.right,
        height: height - bands.top - bands.bottom,
    };
}

/** The view moved so that a point of the drawing is in the middle of the window. */
export function centered(sight: Sight, point: Point, width: number, height: number): Sight {
    return { ...sight, x: point.x - width / sight.scale / 2, y: point.y - height / sight.scale / 2 };
}

/** The view moved so that a box is in the middle of the window, as far as there is no empty space beside the drawing. */
export function around(sight: Sight, drawing: Area, box: Box, width: number, height: number): Sight {
    const inside = (at: number, now: number, size: number, window: number) =>
        size <= window ? now : Math.max(-MARGIN / sight.scale, Math.min(at, size + MARGIN / sight.scale - window));
    const [w, h] = [width / sight.scale, height / sight.scale];
    const { x, y } = centered(sight, middle(box), width, height);
    return { ...sight, x: inside(x, sight.x, drawing.width, w), y: inside(y, sight.y, drawing.height, h) };
}

/**
 * The view in which a box is visible, with as many other boxes as possible as a whole; those near it are more important.
 * Among equally good views, the one with the box nearest to the middle. The box is in the middle if there are no others.
 */
export function amongOthers(
    sight: Sight,
    drawing: Area,
    box: Box,
    near: readonly Box[],
    others: readonly Box[],
    width: number,
    height: number,
): Sight {
    const central = around(sight, drawing, box, width, height);
    const [w, h] = [width / sight.scale, height / sight.scale];
    const margin = MARGIN / sight.scale;
    const places = (now: number, size: number, window: number, own: Part, all: readonly Part[]): readonly number[] => {
        if (size <= window) return [now];
        const edges = all.flatMap(({ at, length }) => [at - margin, at + length + margin - window]);
        const inside = edges.map((at) => Math.max(-margin, Math.min(at, size + margin - window)));
        const shows = (at: number) => at <= own.at && own.at + own.length <= at + window;
        return [now, ...new Set(inside.filter(shows))].slice(0, MAX_PLACES);
    };
    const reachable = others.filter(({ x, y }) => Math.abs(x - box.x) < 2 * w && Math.abs(y - box.y) < 2 * h);
    const columns = places(central.x, drawing.width, w, across(box), reachable.map(across));
    const rows = places(central.y, drawing.height, h, along(box), reachable.map(along));
    const value = (x: number, y: number): number => {
        let sum = -(Math.abs(x - central.x) + Math.abs(y - central.y)) / 1e6;
        for (const other of reachable) {
            const [right, bottom] = [other.x + other.width, other.y + other.height];
            if (other.x >= x && right <= x + w && other.y >= y && bottom <= y + h) sum += near.includes(other) ? 3 : 1;
            else if (other.x < x + w && right > x && other.y < y + h && bottom > y)
                sum -= other.x < x || other.y < y ? CUT_AT_START : CUT_AT_END;
        }
        return sum;
    };
    let best = { x: central.x, y: central.y, value: value(central.x, central.y) };
    for (const x of columns)
        for (const y of rows) {
            const now = value(x, y);
            if (now > best.value) best = { x, y, value: now };
        }
    return { ...sight, x: best.x, y: best.y };
}

/** The part of the largest number of boxes that is enough for a view nearer to the start. */
const NEARLY = 0.7;

/** The view nearest to the start with nearly as many whole boxes as possible, and few that are cut off at the upper
 * side. */
export function fullest(sight: Sight, drawing: Area, boxes: readonly Box[], width: number, height: number): Sight {
    const [w, h] = [width / sight.scale, height / sight.scale];
    const margin = MARGIN / sight.scale;
    const places = (now: number, size: number, window: number, starts: readonly number[]): readonly number[] => {
        if (size <= window) return [now];
        return [now, ...new Set(starts.map((at) => Math.min(at - margin, size + margin - window)))].slice(
            0,
            MAX_PLACES,
        );
    };
    const columns = places(sight.x, drawing.width, w, boxes.map(({ x }) => x).sort(ascending));
    const rows = places(sight.y, drawing.height, h, boxes.map(({ y }) => y).sort(ascending));
    const views: (Sight & { readonly count: number })[] = [];
    for (const y of rows) {
        const inRow = boxes.filter((box) => box.y >= y && box.y + box.height <= y + h);
        const cut = boxes.filter((box) => box.y < y && box.y + box.height > y);
        for (const x of columns) {
            const isWithin = (box: Box) => box.x >= x && box.x + box.width <= x + w;
            const count = inRow.filter(isWithin).length - cut.filter(isWithin).length;
            views.push({ ...sight, x, y, count });
        }
    }
    const most = Math.max(...views.map(({ count }) => count));
    const { x, y } = views.find(({ count }) => count >= NEARLY * most) ?? sight;
    return { ...sight, x, y };
}

/** The distance of the dot before an initial state from the left or the upper side of the state, in pixels. */
const START = 90;

/** The box of an initial state with the dot before it, on the left or above. */
export function withStart<B extends Box>(box: B): B {
    const [left, top] = [Math.min(START, box.x), Math.min(START, box.y)];
    return { ...box, x: box.x - left, y: box.y - top, width: box.width + left, height: box.height + top };
}

/** The most by which a first view is smaller at each side so that it cuts off no boxes, in pixels. */
const TRIMS: Bands = { top: 60, bottom: 100, left: 60, right: 150 };

/** The part of the border of a box that is outside of it, in pixels. */
const BORDER = 1;

/** What a label counts compared with a node: if it is cut off, it is hidden, and its line stays. */
const LABEL = 0.25;
/** What a box counts that a smaller view leaves out, compared with one that it cuts off. */
const LEFT_OUT = 0.5;

/** By how much a view is made smaller at its sides, so that these cut off as few nodes and labels as possible, in
 * pixels. */
export function trimsOf(nodes: readonly Box[], labels: readonly Box[], { sight, width, height }: Frame): Bands {
    const seen = [...nodes, ...labels].map((box, index) => ({
        weight: index < nodes.length ? 1 : LABEL,
        left: (box.x - sight.x) * sight.scale - BORDER,
        right: (box.x + box.width - sight.x) * sight.scale + BORDER,
        top: (box.y - sight.y) * sight.scale - BORDER,
        bottom: (box.y + box.height - sight.y) * sight.scale + BORDER,
    }));
    const trims: Record<Side, number> = { ...NO_BANDS };
    for (const side of SIDES) {
        const [low, high] = [trims.left, width - trims.right];
        const [upper, lower] = [trims.top, height - trims.bottom];
        const isRow = side === "top" || side === "bottom";
        const near = seen
            .filter((box) => (isRow ? box.right > low && box.left < high : box.bottom > upper && box.top < lower))
            .map(({ weight, left, right, top, bottom }): readonly [number, number, number] => {
                if (side === "top") return [top, bottom, weight];
                if (side === "left") return [left, right, weight];
                return side === "bottom"
                    ? [height - bottom, height - top, weight]
                    : [width - right, width - left, weight];
            });
        const cost = (trim: number) =>
            near.reduce((sum, [start, end, weight]) => {
                if (start >= trim || end <= 0) return sum;
                if (end > trim) return sum + weight;
                return start < 0 ? sum : sum + weight * LEFT_OUT;
            }, 0);
        const places = [0, ...near.map(([, end]) => end + 1).filter((end) => end > 0 && end <= TRIMS[side])];
        trims[side] = places.sort(ascending).reduce((best, place) => (cost(place) < cost(best) ? place : best));
    }
    return trims;
}

function ascending(one: number, other: number): number {
    return one - other;
}

/** What a box that is cut off counts, less than a whole one: at the left or the upper side, or at the other sides, where
 * readers expect that a picture goes on. */
const CUT_AT_START = 4;
const CUT_AT_END = 0.5;
/** The maximum number of places in one direction that are compared. */
const MAX_PLACES = 100;
/** The extent of a box in one direction. */
interface Part {
    readonly at: number;
    readonly length: number;
}

function across({ x, width }: Box): Part {
    return { at: x, length: width };
}

function along({ y, height }: Box): Part {
    return { at: y, length: height };
}

/** The smallest box around boxes. */
export function union(boxes: readonly Box[]): Box {
    const [x, y] = [Math.min(...boxes.map((box) => box.x)), Math.min(...boxes.map((box) => box.y))];
    const right = Math.max(...boxes.map((box) => box.x + box.width));
    const bottom = Math.max(...boxes.map((box) => box.y + box.height));
    return { x, y, width: right - x, height: bottom - y };
}

/**
 * The view that follows a box: unchanged while the box and those around it are visible; otherwise with all of them in
 * the middle if they fit, else with the box in the middle.
 */
export function follow(
    sight: Sight,
    drawing: Area,
    box: Box,
    others: readonly Box[],
    width: number,
    height: number,
): Sight {
    const all = union([box, ...others]);
    const [w, h] = [width / sight.scale, height / sight.scale];
    const fits = all.width <= w && all.height <= h;
    const wanted = fits ? all : box;
    const isVisible = (at: number, low: number, size: number, whole: number) => low >= at && low + size <= at + whole;
    if (isVisible(sight.x, wanted.x, wanted.width, w) && isVisible(sight.y, wanted.y, wanted.height, h)) return sight;
    return around(sight, drawing, wanted, width, height);
}

/** Where a node was before, relative to where it is. */
export interface Shift {
    readonly index: number;
    readonly x: number;
    readonly y: number;
}

/** The shifts of the nodes that two drawings of a picture have in common, and that have moved between them. */
export function shifts(before: PlacedNodes, after: PlacedNodes): Shift[] {
    const earlier = new Map(before.nodes.map(({ index, x, y }) => [before.ids[index], { x, y }]));
    return after.nodes.flatMap(({ index, x, y }) => {
        const old = earlier.get(after.ids[index]);
        if (!old || (old.x === x && old.y === y)) return [];
        return [{ index, x: old.x - x, y: old.y - y }];
    });
}

/** The nodes of a drawing, and the ids of all nodes of its picture. */
export interface PlacedNodes {
    readonly nodes: readonly DrawnNode[];
    readonly ids: readonly string[];
}

/** The size of a map of a drawing, and the factor by which the map is smaller. */
export interface MapScale extends Area {
    readonly factor: number;
}

/** The part of a drawing that a window shows. */
export function visiblePart(sight: Sight, drawing: Area, width: number, height: number): Box {
    const [x, y] = [Math.max(0, sight.x), Math.max(0, sight.y)];
    const [right, bottom] = [sight.x + width / sight.scale, sight.y + height / sight.scale];
    return {
        x,
        y,
        width: Math.max(0, Math.min(drawing.width, right) - x),
        height: Math.max(0, Math.min(drawing.height, bottom) - y),
    };
}

/** The largest map of a drawing that fits into a size. */
export function mapOf(drawing: Area, width: number, height: number): MapScale {
    const factor = Math.min(1, width / Math.max(1, drawing.width), height / Math.max(1, drawing.height));
    return { width: drawing.width * factor, height: drawing.height * factor, factor };
}

function middle(box: Box): Point {
    return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}
