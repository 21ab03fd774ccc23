// SPDX-License-Identifier: Apache-2.0
/** The drawing of the server as elements of the document, with roles and names for screen readers. */

import type { Box, Drawing, Picture, Words } from "../contract";
import { breakpointOf } from "../breakpoints";
import { edgeParts, menuOf, nodeParts } from "./menu";
import { edgeHint, edgeWords, nodeWords } from "./words";

const SVG = "http://www.w3.org/2000/svg";

/** The elements of a drawing, by the index of the node or edge. An edge may consist of a line and a row of text. */
export interface Scene {
    readonly root: SVGGElement;
    readonly nodes: ReadonlyMap<number, SVGGElement>;
    readonly edges: ReadonlyMap<number, readonly SVGGElement[]>;
}

export function sceneOf(picture: Picture, drawing: Drawing, words: Words): Scene {
    const text = `<svg xmlns="${SVG}">${drawing.scene}</svg>`;
    const parsed = new DOMParser().parseFromString(text, "image/svg+xml").querySelector("g");
    const root = parsed ? document.importNode(parsed, true) : element("g", {});
    const nodes = new Map<number, SVGGElement>();
    const edges = new Map<number, SVGGElement[]>();
    for (const group of root.querySelectorAll<SVGGElement>("[data-node]")) {
        const index = Number(group.dataset["node"]);
        const node = picture.nodes[index];
        if (!node) continue;
        nodes.set(index, group);
        group.setAttribute("role", "button");
        group.setAttribute("tabindex", "-1");
        group.setAttribute("aria-label", nodeWords(node, words));
        group.dataset["label"] = node.label;
        group.dataset["vscodeContext"] = menuOf(
            nodeParts(picture, index),
            [],
            [breakpointOf(picture, { node: index })].flatMap((one) => one ?? []),
        );
    }
    for (const group of root.querySelectorAll<SVGGElement>("[data-edges]")) {
        const indexes = (group.dataset["edges"] ?? "").split(" ").map(Number);
        const shown = indexes.flatMap((index) => picture.edges[index] ?? []);
        for (const index of indexes) edges.set(index, [...(edges.get(index) ?? []), group]);
        if (shown.some(({ place }) => place !== null)) group.setAttribute("role", "button");
        group.setAttribute("aria-label", shown.map((edge) => edgeWords(picture, edge, words)).join("; "));
        group.dataset["vscodeContext"] = menuOf(
            edgeParts(picture, indexes),
            [],
            indexes.flatMap((edge) => breakpointOf(picture, { edge }) ?? []),
        );
        group.querySelector(":scope > title")?.remove();
        const title = element("title", {});
        title.textContent = shown.map((edge) => edgeHint(picture, edge)).join("\n\n");
        group.prepend(title, ...wideLines(group));
    }
    hideRepeated(edges);
    return { root, nodes, edges };
}

/** The element of an edge that a screen reader reads: its text, if it has one beside its line. */
export function spoken(groups: readonly SVGGElement[]): SVGGElement {
    const group = groups.at(-1);
    if (!group) throw new Error("an edge has no element");
    return group;
}

export function labelsOf({ root }: Scene): Box[] {
    return [...root.querySelectorAll<SVGGElement>(".label")].map((label) => label.getBBox());
}

/** Hide the lines of edges whose text has the same name from screen readers. */
function hideRepeated(edges: ReadonlyMap<number, readonly SVGGElement[]>): void {
    const all = [...edges.values()];
    const names = new Set(all.map(spoken));
    for (const group of all.flat()) if (!names.has(group)) group.setAttribute("aria-hidden", "true");
}

/** Invisible wide lines under the lines of a group, which are easy to point at. */
function wideLines(group: SVGGElement): SVGPathElement[] {
    return [...group.querySelectorAll<SVGPathElement>(":scope > .line")].map((line) =>
        element("path", { d: line.getAttribute("d") ?? "", class: "wide" }),
    );
}

/** The base64 text of a PNG file. */
export async function pngData(svg: string, scale = 2): Promise<string> {
    const url = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
    try {
        const image = new Image();
        image.src = url;
        await image.decode();
        const canvas = document.createElement("canvas");
        canvas.width = Math.ceil(image.naturalWidth * scale);
        canvas.height = Math.ceil(image.naturalHeight * scale);
        canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
        return canvas.toDataURL("image/png").replace(/^data:[^,]*,/, "");
    } finally {
        URL.revokeObjectURL(url);
    }
}

export function element<K extends keyof SVGElementTagNameMap>(
    name: K,
    attributes: Readonly<Record<string, string | number>>,
): SVGElementTagNameMap[K] {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
    return made;
}
