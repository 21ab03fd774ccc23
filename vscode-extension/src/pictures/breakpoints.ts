// SPDX-License-Identifier: Apache-2.0
/** Breakpoints that are set in pictures: which part stops a run where, and which parts have a breakpoint. */

import type { Breakpoint, MarkedParts, NodeKind, Part, Picture, PictureEdge, PictureNode } from "./contract";

const MESSAGES: readonly NodeKind[] = ["topic", "service", "action-interface"];
const LINES: readonly NodeKind[] = ["state", "control", "decorator", "action", "condition", "subtree"];

/** The breakpoint of a part: on the line of a state, transition or tree node, or on the messages of a topic, service or
 * action; undefined for other parts. */
export function breakpointOf(picture: Picture, part: Part): Breakpoint | undefined {
    if ("edge" in part) return ofEdge(picture, picture.edges[part.edge]);
    return ofNode(picture.nodes[part.node]);
}

function ofNode(node: PictureNode | undefined): Breakpoint | undefined {
    if (!node) return undefined;
    const { kind, label } = node;
    if (MESSAGES.includes(kind)) return { label, event: label };
    const place = node.use ?? node.place;
    return LINES.includes(kind) && place ? { label, uri: place.uri, line: place.range.start.line } : undefined;
}

/** The lines between messages and nodes are no places of a run, those of transitions are. */
function ofEdge({ kind }: Picture, edge: PictureEdge | undefined): Breakpoint | undefined {
    if (!edge?.place || (kind !== "machine" && kind !== "system")) return undefined;
    return { label: edge.labels.join(" "), uri: edge.place.uri, line: edge.place.range.start.line };
}

/** The parts of a picture that have one of the breakpoints. */
export function marked(picture: Picture, breakpoints: readonly Breakpoint[]): MarkedParts {
    const set = new Set(breakpoints.map(keyOf));
    const has = (part: Part) => {
        const breakpoint = breakpointOf(picture, part);
        return breakpoint !== undefined && set.has(keyOf(breakpoint));
    };
    return {
        nodes: [...picture.nodes.keys()].filter((node) => has({ node })),
        edges: [...picture.edges.keys()].filter((edge) => has({ edge })),
    };
}

export function keyOf(breakpoint: Breakpoint): string {
    return "event" in breakpoint ? breakpoint.event : `${breakpoint.uri}:${breakpoint.line}`;
}
