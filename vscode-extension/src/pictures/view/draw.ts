// SPDX-License-Identifier: Apache-2.0
/** Draws SVG. Colors come from the style sheet; kinds also differ in shapes and lines. */

import type { NodeKind, Picture, PictureEdge, PictureNode, Words } from "../contract";
import {
    SMALL_SIZE,
    TITLE_SIZE,
    hasKindLine,
    pathOf,
    type Box,
    type DrawnEdge,
    type DrawnNode,
    type Drawing,
} from "./layout";

const SVG = "http://www.w3.org/2000/svg";
const LINE = 1.4;

/** The SVG elements of a picture, by the index of the node or edge. */
export interface Scene {
    readonly root: SVGGElement;
    readonly nodes: ReadonlyMap<number, SVGGElement>;
    readonly edges: ReadonlyMap<number, SVGGElement>;
}

export function draw(picture: Picture, drawing: Drawing, words: Words): Scene {
    const root = element("g", { class: "scene" });
    const nodes = new Map<number, SVGGElement>();
    const edges = new Map<number, SVGGElement>();
    // Frames are below the edges, everything else is above them.
    const isFrame = ({ index }: DrawnNode) => picture.nodes[index]?.kind === "thread";
    const addNode = (drawn: DrawnNode) => {
        const node = picture.nodes[drawn.index];
        const made = node ? drawNode(node, drawn, words) : dot(drawn);
        if (node) nodes.set(drawn.index, made);
        root.append(made);
    };
    drawing.nodes.filter(isFrame).forEach(addNode);
    for (const drawn of drawing.edges) {
        const edge = picture.edges[drawn.index];
        const made = drawEdge(edge, drawn, edge ? wordsOf(picture, edge, words) : "");
        if (edge) edges.set(drawn.index, made);
        root.append(made);
    }
    drawing.nodes.filter((drawn) => !isFrame(drawn)).forEach(addNode);
    return { root, nodes, edges };
}

/** The arrow heads that edges refer to. */
export function markers(): SVGDefsElement {
    const marker = (id: string, attributes: Record<string, string | number>) => {
        const made = element("marker", {
            id,
            viewBox: "0 0 10 10",
            refX: 9,
            refY: 5,
            markerWidth: 9,
            markerHeight: 9,
            orient: "auto-start-reverse",
            markerUnits: "userSpaceOnUse",
        });
        made.append(element("path", { d: "M 1 1 L 9 5 L 1 9 z", class: `head ${id}`, ...attributes }));
        return made;
    };
    const made = element("defs", {});
    for (const kind of HEADS) made.append(marker(`head-${kind}`, {}));
    return made;
}

const HEADS = ["plain", "event", "ros", "bt", "blackboard", "service"] as const;

function headOf(edge: PictureEdge | undefined): (typeof HEADS)[number] {
    switch (edge?.kind) {
        case "event":
        case "sends":
            return "event";
        case "ros":
        case "publishes":
        case "subscribes":
            return "ros";
        case "bt":
            return "bt";
        case "reads":
        case "writes":
            return "blackboard";
        case "serves":
        case "calls":
            return "service";
        case "eventless":
        case "child":
        case undefined:
            return "plain";
    }
}

function drawNode(node: PictureNode, box: Box, words: Words): SVGGElement {
    const kind = words.kinds[node.kind];
    const group = element("g", {
        class: `node is-${node.kind}${node.initial ? " initial" : ""}`,
        role: "button",
        tabindex: -1,
        "aria-label": [kind, node.label, ...node.details].join(", "),
        "data-label": node.label,
    });
    group.append(...shape(node.kind, box));
    const small = hasKindLine(node) ? [kind] : [];
    const height = TITLE_SIZE * LINE + (small.length + node.details.length) * SMALL_SIZE * LINE;
    let y = node.kind === "thread" ? box.y + 6 : box.y + (box.height - height) / 2;
    const x = box.x + box.width / 2;
    const write = (text: string, size: number, className: string) => {
        group.append(label(text, x, y + size * 1.05, className));
        y += size * LINE;
    };
    for (const text of small) write(text, SMALL_SIZE, "kind");
    write(node.label, TITLE_SIZE, "label");
    for (const text of node.details) write(text, SMALL_SIZE, "detail");
    return group;
}

function shape(kind: NodeKind, box: Box): SVGElement[] {
    const { x, y, width, height } = box;
    const rect = (radius: number, inset = 0) =>
        element("rect", {
            x: x + inset,
            y: y + inset,
            width: width - 2 * inset,
            height: height - 2 * inset,
            rx: radius,
            class: "shape",
        });
    switch (kind) {
        case "state":
            return [rect(Math.min(14, height / 2))];
        case "node":
        case "plugin":
        case "condition":
            return [rect(height / 2)];
        case "service":
            return [rect(2), rect(1, 3)];
        case "action-interface":
        case "decorator": {
            const cut = Math.min(10, height / 2);
            const points = [
                [x + cut, y],
                [x + width - cut, y],
                [x + width, y + height / 2],
                [x + width - cut, y + height],
                [x + cut, y + height],
                [x, y + height / 2],
            ];
            return [element("polygon", { points: points.map((point) => point.join(",")).join(" "), class: "shape" })];
        }
        case "thread":
        case "action":
        case "variable":
            return [rect(8)];
        case "control":
        case "topic":
            return [rect(2)];
    }
}

function dot(box: Box): SVGGElement {
    const group = element("g", { class: "dot" });
    group.append(element("circle", { cx: box.x + box.width / 2, cy: box.y + box.height / 2, r: box.width / 2 }));
    return group;
}

function drawEdge(edge: PictureEdge | undefined, drawn: DrawnEdge, words: string): SVGGElement {
    const group = element("g", {
        class: `edge is-${edge?.kind ?? "start"}${edge?.probabilistic ? " chance" : ""}`,
        ...(edge?.place ? { role: "button" } : {}),
        ...(words === "" ? {} : { "aria-label": words }),
    });
    const d = pathOf(drawn.points);
    const end = edge?.kind === "child" ? {} : { "marker-end": `url(#head-${headOf(edge)})` };
    group.append(element("path", { d, class: "wide" }), element("path", { d, class: "line", ...end }));
    if (edge && drawn.label) {
        const { x, y, width, height } = drawn.label;
        group.append(element("rect", { x, y, width, height, rx: 3, class: "back" }));
        edge.labels.forEach((text, i) => {
            group.append(label(text, x + width / 2, y + SMALL_SIZE * (1.05 + i * LINE), "detail"));
        });
    }
    return group;
}

function wordsOf(picture: Picture, edge: PictureEdge, words: Words): string {
    const name = (id: string) => picture.nodes.find((node) => node.id === id)?.label ?? "";
    const chance = edge.probabilistic ? [words.byChance] : [];
    return [`${name(edge.source)} → ${name(edge.target)}`, words.kinds[edge.kind], ...edge.labels, ...chance].join(
        ", ",
    );
}

function label(text: string, x: number, y: number, className: string): SVGTextElement {
    const made = element("text", { x, y, class: className });
    made.textContent = text;
    return made;
}

export function element<K extends keyof SVGElementTagNameMap>(
    name: K,
    attributes: Readonly<Record<string, string | number>>,
): SVGElementTagNameMap[K] {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
    return made;
}
