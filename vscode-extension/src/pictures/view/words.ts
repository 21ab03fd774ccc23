// SPDX-License-Identifier: Apache-2.0
/** The words for the parts of a picture: for screen readers, for hovers, and for the legend. */

import type { EdgeKind, NodeKind, Picture, PictureEdge, PictureNode, Words } from "../contract";

/** The description of a node for screen readers. */
export function nodeWords(node: PictureNode, words: Words): string {
    return [words.kinds[node.kind], node.label, ...node.details].filter((text) => text !== "").join(", ");
}

/** The description of an edge for screen readers. */
export function edgeWords(picture: Picture, edge: PictureEdge, words: Words): string {
    const chance = edge.probabilistic ? [words.byChance] : [];
    const ends = `${labelOf(picture, edge.source)} → ${labelOf(picture, edge.target)}`;
    return [ends, words.kinds[edge.kind], ...edge.labels, ...chance].join(", ");
}

/** The hover of an edge: its ends, the type of its interface, its whole text, and its file and line. */
export function edgeHint(picture: Picture, edge: PictureEdge): string {
    const channel = picture.nodes.find(
        (node) => isChannel(node.kind) && (node.id === edge.source || node.id === edge.target),
    );
    const lines = channel
        ? [throughChannel(picture, edge, channel), ...channel.details]
        : [`${labelOf(picture, edge.source)} → ${labelOf(picture, edge.target)}`];
    if (edge.place) {
        const file = decodeURIComponent(edge.place.uri.replace(/^.*\//, ""));
        lines.push(`${file}:${edge.place.range.start.line + 1}`);
    }
    return [...lines.slice(0, 1), ...edge.labels, ...lines.slice(1)].join("\n");
}

/** The sender, the interface and the receivers, although an edge of the picture has only one of its ends there. */
function throughChannel(picture: Picture, edge: PictureEdge, channel: PictureNode): string {
    const others = picture.edges.filter(({ source, target }) =>
        edge.source === channel.id ? target === channel.id : source === channel.id,
    );
    const names = (ids: readonly string[]) => [...new Set(ids.map((id) => labelOf(picture, id)))].join(", ");
    const senders = edge.source === channel.id ? names(others.map(({ source }) => source)) : names([edge.source]);
    const receivers = edge.source === channel.id ? names([edge.target]) : names(others.map(({ target }) => target));
    return [senders, channel.label, receivers].filter((text) => text !== "").join(" → ");
}

/** An entry of the legend: its tone and its kind of line in the style sheet, and its text. */
export interface LegendEntry {
    readonly tone: string;
    readonly kind: string;
    readonly text: string;
    readonly isLine: boolean;
    /** What a symbol other than a line or a colored square looks like. */
    readonly symbol?: "dot" | "double" | "bar";
}

const EDGE_TONES: Partial<Record<EdgeKind, string>> = { eventless: "plain", event: "event", ros: "ros", bt: "tree" };
const NODE_TONES: Partial<Record<NodeKind, string>> = {
    control: "control",
    decorator: "decorator",
    action: "action",
    condition: "condition",
    subtree: "subtree",
    variable: "blackboard",
};
const CHANNEL_TONES: Partial<Record<NodeKind, string>> = {
    topic: "topic",
    service: "service",
    "action-interface": "ros-action",
};

/** The tone of a node of a tree or a ROS graph; "plain" for other nodes. */
export function toneOf(kind: NodeKind | undefined): string {
    return (kind && (NODE_TONES[kind] ?? CHANNEL_TONES[kind])) ?? "plain";
}

/** One entry for each color of a picture. */
export function legendOf(picture: Picture, words: Words): LegendEntry[] {
    const entries: LegendEntry[] = [];
    const add = (tone: string | undefined, text: string, isLine: boolean, kind = "") => {
        if (tone === undefined || entries.some((entry) => entry.tone === tone)) return;
        entries.push({ tone, kind, text, isLine });
    };
    switch (picture.kind) {
        case "machine":
        case "system":
            for (const { kind } of picture.edges.filter((edge) => !edge.probabilistic))
                add(EDGE_TONES[kind], words.kinds[kind], true, kind);
            if (picture.edges.some((edge) => edge.probabilistic)) add("chance", words.byChance, true, "chance");
            entries.push(...stateMarks(picture, words));
            break;
        case "tree":
            for (const { kind } of picture.nodes) add(NODE_TONES[kind], words.kinds[kind], false);
            if (picture.nodes.some(({ details }) => details.some((detail) => detail.startsWith(MOCK))))
                entries.push({ tone: "chance", kind: "", text: words.mock, isLine: false, symbol: "bar" });
            break;
        case "ros":
            for (const { kind } of picture.nodes) add(CHANNEL_TONES[kind], words.kinds[kind], true);
            for (const { interface: kind } of picture.edges)
                if (kind !== "") add(CHANNEL_TONES[kind], words.kinds[kind], true);
            if (picture.edges.some(({ kind }) => kind === "sends")) add("event", words.kinds.event, true);
            break;
    }
    return entries;
}

/** How the detail of a node that is its mock begins. */
const MOCK = "mock: ";

/** The marks of initial states, and of states which no transition leaves. */
function stateMarks(picture: Picture, words: Words): LegendEntry[] {
    const states = picture.nodes.filter(({ kind }) => kind === "state");
    const left = new Set(picture.edges.map(({ source }) => source));
    const mark = { tone: "plain", kind: "", isLine: false };
    return [
        ...(states.some(({ initial }) => initial) ? [{ ...mark, text: words.initial, symbol: "dot" } as const] : []),
        ...(states.some(({ id }) => !left.has(id)) ? [{ ...mark, text: words.final, symbol: "double" } as const] : []),
    ];
}

function isChannel(kind: NodeKind): boolean {
    return kind in CHANNEL_TONES;
}

function labelOf(picture: Picture, id: string): string {
    const node = picture.nodes.find((candidate) => candidate.id === id);
    if (node?.kind !== "choice") return node?.label ?? "";
    // A choice has no name, because it is a part of the transition that leads to it.
    const source = picture.edges.find(({ target }) => target === id)?.source;
    return source === undefined ? "" : labelOf(picture, source);
}
