// SPDX-License-Identifier: Apache-2.0
/** The lines of a node stand out: those that leave it and those that enter it have own colors, all others fade. */

import type { Picture } from "../contract";
import type { Scene } from "./scene";

/** The edges of a node. */
export interface NodeEdges {
    readonly leaving: readonly number[];
    readonly entering: readonly number[];
}

/** The edges that leave a node, also through a choice, and those that enter it. */
export function edgesOf(picture: Picture, node: number): NodeEdges {
    const id = picture.nodes[node]?.id;
    if (id === undefined) return { leaving: [], entering: [] };
    const choices = new Set(picture.nodes.filter(({ kind }) => kind === "choice").map((choice) => choice.id));
    const through = (end: "source" | "target", other: "source" | "target") => {
        const own = new Set([id]);
        for (const edge of picture.edges) if (edge[end] === id && choices.has(edge[other])) own.add(edge[other]);
        return picture.edges.flatMap((edge, index) =>
            own.has(edge[end]) && edge.source !== edge.target ? [index] : [],
        );
    };
    return { leaving: through("source", "target"), entering: through("target", "source") };
}

const MARKS = ["leaves", "enters"] as const;

/** Mark the lines and labels of edges; without edges, all lines look as usual. */
export function markEdges({ root, edges }: Scene, { leaving, entering }: NodeEdges): void {
    for (const group of root.querySelectorAll(":scope > :is(.leaves, .enters)")) group.classList.remove(...MARKS);
    const marked = [leaving, entering].map((own) => own.flatMap((edge) => edges.get(edge) ?? []));
    for (const [index, groups] of marked.entries())
        for (const group of groups) group.closest(".scene > *")?.classList.add(MARKS[index] ?? "leaves");
    root.classList.toggle("near", root.querySelector(":scope > :is(.link, .edge):is(.leaves, .enters)") !== null);
}
