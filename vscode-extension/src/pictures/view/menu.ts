// SPDX-License-Identifier: Apache-2.0
/** The data of the context menus of parts, which VS Code shows. */

import {
    PICTURE_ACTIONS,
    type Breakpoint,
    type MenuContext,
    type MenuPart,
    type Picture,
    type PictureAction,
} from "../contract";
import { edgeHint } from "./words";

/** The text for the attribute `data-vscode-context` of an element that shows some nodes and edges. */
export function menuOf(
    parts: readonly MenuPart[],
    more: readonly PictureAction[] = [],
    breakpoints: readonly Breakpoint[] = [],
): string {
    const isPossible = (action: PictureAction) =>
        more.includes(action) || parts.some(({ actions }) => actions.includes(action));
    const keys = PICTURE_ACTIONS.map((action) => [`as2fm_${action}`, isPossible(action)] as const);
    const context: MenuContext = {
        preventDefaultContextMenuItems: true,
        as2fmParts: parts,
        as2fmBreakpoints: breakpoints,
        as2fmGoTo: parts.length > 0,
        as2fmStops: breakpoints.length > 0,
        ...(Object.fromEntries(keys) as Record<`as2fm_${PictureAction}`, boolean>),
    };
    return JSON.stringify(context);
}

/** The parts of a node: a subtree is used at one place, and defined at another. */
export function nodeParts(picture: Picture, index: number): MenuPart[] {
    const node = picture.nodes[index];
    if (!node) return [];
    const { place, actions, use, useActions } = node;
    const used = use ? [{ label: `<SubTree> ${node.label}`, place: use, actions: useActions }] : [];
    const label = use ? `<BehaviorTree> ${node.label}` : node.label;
    return [...used, ...(place ? [{ label, place, actions }] : [])];
}

/** The parts of edges that share a line; the hover texts describe them. */
export function edgeParts(picture: Picture, indexes: readonly number[]): MenuPart[] {
    return indexes.flatMap((index) => {
        const edge = picture.edges[index];
        if (!edge?.place) return [];
        const label = edgeHint(picture, edge).replaceAll("\n", " ");
        return [{ label, place: edge.place, actions: edge.actions }];
    });
}
