// SPDX-License-Identifier: Apache-2.0
/** Layout: converts a picture to a graph for elkjs, and its result to a drawing. Does not depend on the DOM. */

import type { ElkEdgeSection, ElkExtendedEdge, ElkNode, LayoutOptions } from "elkjs/lib/elk-api";
import type { Picture, PictureEdge, PictureKind, PictureNode } from "../contract";

/** The width of a text in pixels; `size` is the font size. */
export type Measure = (text: string, size: number) => number;

export const TITLE_SIZE = 13;
export const SMALL_SIZE = 11;
const LINE = 1.4;
const PADDING = { x: 14, y: 8 };

export interface Point {
    readonly x: number;
    readonly y: number;
}

export interface Box extends Point {
    readonly width: number;
    readonly height: number;
}

/** A node of the drawing; `index` is its index in the picture, -1 for the dot before an initial state. */
export interface DrawnNode extends Box {
    readonly index: number;
}

export interface DrawnEdge {
    /** -1 for the arrow from the dot to an initial state. */
    readonly index: number;
    readonly points: readonly Point[];
    /** The place of its label, if it has one. */
    readonly label: Box | undefined;
}

export interface Drawing {
    readonly width: number;
    readonly height: number;
    readonly nodes: readonly DrawnNode[];
    readonly edges: readonly DrawnEdge[];
}

const COMMON: LayoutOptions = {
    "elk.algorithm": "layered",
    "elk.hierarchyHandling": "INCLUDE_CHILDREN",
    "elk.spacing.nodeNode": "28",
    "elk.spacing.edgeNode": "16",
    "elk.spacing.edgeEdge": "12",
    "elk.spacing.edgeLabel": "4",
    "elk.spacing.nodeSelfLoop": "14",
    "elk.layered.spacing.nodeNodeBetweenLayers": "44",
    "elk.layered.spacing.edgeNodeBetweenLayers": "18",
    "elk.layered.considerModelOrder.strategy": "NODES_AND_EDGES",
    "elk.edgeRouting": "ORTHOGONAL",
    // The initial nodes come first.
    "elk.layered.cycleBreaking.strategy": "DEPTH_FIRST",
};

const OPTIONS: Record<PictureKind, LayoutOptions> = {
    machine: { ...COMMON, "elk.direction": "DOWN" },
    tree: {
        ...COMMON,
        "elk.direction": "DOWN",
        "elk.layered.crossingMinimization.forceNodeModelOrder": "true",
        "elk.layered.nodePlacement.strategy": "BRANDES_KOEPF",
        "elk.layered.nodePlacement.bk.fixedAlignment": "BALANCED",
    },
    ros: { ...COMMON, "elk.direction": "RIGHT" },
};

/** The lines of a node: the word for its kind, its label, its details. */
export function linesOf(node: PictureNode): number {
    return (hasKindLine(node) ? 1 : 0) + 1 + node.details.length;
}

/** Whether the kind is written above the label; it is omitted for states. */
export function hasKindLine(node: PictureNode): boolean {
    return node.kind !== "state";
}

export function graphOf(picture: Picture, measure: Measure, kindWord: (node: PictureNode) => string): ElkNode {
    const nodes = new Map<string, ElkNode>();
    for (const node of picture.nodes) nodes.set(node.id, { id: node.id, ...sizeOf(node, measure, kindWord(node)) });
    const roots: ElkNode[] = [];
    for (const node of picture.nodes) {
        const made = nodes.get(node.id);
        const parent = nodes.get(node.parent);
        if (!made) continue;
        if (parent) {
            (parent.children ??= []).push(made);
            parent.layoutOptions ??= { ...OPTIONS[picture.kind], "elk.padding": paddingOf(picture, node.parent) };
        } else {
            roots.push(made);
        }
    }
    const edges = picture.edges.map((edge, index) => edgeOf(edge, index, measure));
    if (picture.kind === "machine") addDots(picture, nodes, roots, edges);
    return { id: "picture", layoutOptions: OPTIONS[picture.kind], children: roots, edges };
}

/** Whether an edge is reversed for elkjs, so that what is read is drawn below its reader. */
export function isTurned(edge: PictureEdge): boolean {
    return edge.kind === "reads";
}

/** The padding of a frame, with space for its lines of text at the top. */
function paddingOf(picture: Picture, frame: string): string {
    const node = picture.nodes.find((each) => each.id === frame);
    const top = 6 + TITLE_SIZE * LINE + ((node ? linesOf(node) : 1) - 1) * SMALL_SIZE * LINE + 12;
    return `[top=${top},left=16,bottom=16,right=16]`;
}

function sizeOf(node: PictureNode, measure: Measure, kind: string): { width: number; height: number } {
    const small = hasKindLine(node) ? [kind, ...node.details] : node.details;
    const width = Math.max(measure(node.label, TITLE_SIZE), ...small.map((line) => measure(line, SMALL_SIZE)), 28);
    return {
        width: Math.ceil(width + 2 * PADDING.x),
        height: Math.ceil(TITLE_SIZE * LINE + small.length * SMALL_SIZE * LINE + 2 * PADDING.y),
    };
}

function edgeOf(edge: PictureEdge, index: number, measure: Measure): ElkExtendedEdge {
    const [source, target] = isTurned(edge) ? [edge.target, edge.source] : [edge.source, edge.target];
    const made: ElkExtendedEdge = { id: `edge ${index}`, sources: [source], targets: [target] };
    if (edge.labels.length > 0) {
        const width = Math.max(...edge.labels.map((line) => measure(line, SMALL_SIZE)));
        const size = { width: Math.ceil(width + 6), height: Math.ceil(edge.labels.length * SMALL_SIZE * LINE + 2) };
        made.labels = [{ id: `label ${index}`, text: edge.labels.join("\n"), ...size }];
    }
    return made;
}

function addDots(picture: Picture, nodes: Map<string, ElkNode>, roots: ElkNode[], edges: ElkExtendedEdge[]): void {
    for (const node of picture.nodes) {
        if (!node.initial) continue;
        const dot: ElkNode = { id: `dot ${node.id}`, width: 12, height: 12 };
        const siblings = nodes.get(node.parent)?.children ?? roots;
        siblings.unshift(dot);
        edges.push({ id: `dot ${node.id}`, sources: [dot.id], targets: [node.id] });
    }
}

/** The result of elkjs, in the coordinates of the whole drawing. */
export function drawingOf(picture: Picture, laidOut: ElkNode): Drawing {
    const indexes = new Map(picture.nodes.map((node, index) => [node.id, index]));
    const nodes: DrawnNode[] = [];
    const origins = new Map<string, Point>([[laidOut.id, { x: 0, y: 0 }]]);
    const visit = (parent: ElkNode, origin: Point) => {
        for (const child of parent.children ?? []) {
            const place = { x: origin.x + (child.x ?? 0), y: origin.y + (child.y ?? 0) };
            origins.set(child.id, place);
            nodes.push({
                index: indexes.get(child.id) ?? -1,
                ...place,
                width: child.width ?? 0,
                height: child.height ?? 0,
            });
            visit(child, place);
        }
    };
    visit(laidOut, { x: 0, y: 0 });
    const edges = edgesIn(laidOut).map((edge) => drawnEdge(picture, edge, origins));
    return { width: laidOut.width ?? 0, height: laidOut.height ?? 0, nodes, edges };
}

function edgesIn(node: ElkNode): ElkExtendedEdge[] {
    return [...(node.edges ?? []), ...(node.children ?? []).flatMap(edgesIn)];
}

function drawnEdge(picture: Picture, edge: ElkExtendedEdge, origins: ReadonlyMap<string, Point>): DrawnEdge {
    const match = /^edge (\d+)$/.exec(edge.id);
    const index = match ? Number(match[1]) : -1;
    const container = (edge as { container?: string }).container ?? "picture";
    const origin = origins.get(container) ?? { x: 0, y: 0 };
    const shift = (point: Point): Point => ({ x: point.x + origin.x, y: point.y + origin.y });
    const points = (edge.sections ?? []).flatMap(pointsOf).map(shift);
    const written = picture.edges[index];
    const [label] = edge.labels ?? [];
    return {
        index,
        points: written && isTurned(written) ? points.reverse() : points,
        label: label && {
            ...shift({ x: label.x ?? 0, y: label.y ?? 0 }),
            width: label.width ?? 0,
            height: label.height ?? 0,
        },
    };
}

function pointsOf(section: ElkEdgeSection): Point[] {
    return [section.startPoint, ...(section.bendPoints ?? []), section.endPoint];
}

/** A line through points with round corners, as the `d` of a path. */
export function pathOf(points: readonly Point[], radius = 8): string {
    const [first, ...rest] = points;
    if (!first) return "";
    const parts = [`M ${first.x} ${first.y}`];
    rest.forEach((point, i) => {
        const before = points[i] ?? first;
        const after = rest[i + 1];
        if (!after) {
            parts.push(`L ${point.x} ${point.y}`);
            return;
        }
        const round = Math.min(radius, distance(before, point) / 2, distance(point, after) / 2);
        const [from, to] = [towards(point, before, round), towards(point, after, round)];
        parts.push(`L ${from.x} ${from.y} Q ${point.x} ${point.y} ${to.x} ${to.y}`);
    });
    return parts.join(" ");
}

function distance(a: Point, b: Point): number {
    return Math.hypot(a.x - b.x, a.y - b.y);
}

function towards(from: Point, to: Point, length: number): Point {
    const whole = distance(from, to) || 1;
    return { x: from.x + ((to.x - from.x) * length) / whole, y: from.y + ((to.y - from.y) * length) / whole };
}
