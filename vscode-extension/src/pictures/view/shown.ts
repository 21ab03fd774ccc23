// SPDX-License-Identifier: Apache-2.0
/** What a run does in parts that a picture does not show: the node that hides them has their activity. */

import type { Activity, Picture } from "../contract";

/** The id of the node that shows the node with an id: the one that hides it, otherwise the same id. */
export function shownId(picture: Picture, id: string): string {
    return picture.nodes.find(({ hides }) => hides.includes(id))?.id ?? id;
}

/** The activity of the shown nodes and edges. */
export function shownActivity(picture: Picture, { nodes, edges }: Activity): Activity {
    return {
        nodes: Object.fromEntries(Object.entries(nodes).map(([id, look]) => [shownId(picture, id), look])),
        edges: edges.map(({ from, to }) => ({ from: shownId(picture, from), to: shownId(picture, to) })),
    };
}
