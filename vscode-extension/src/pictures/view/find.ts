// SPDX-License-Identifier: Apache-2.0
/** Navigation in a picture: by arrow keys, by search, and by zooming. */

import type { Picture } from "../contract";
import type { Box, DrawnNode, Point } from "./layout";

export type Direction = "ArrowUp" | "ArrowDown" | "ArrowLeft" | "ArrowRight";

const WAYS: Record<Direction, Point> = {
    ArrowUp: { x: 0, y: -1 },
    ArrowDown: { x: 0, y: 1 },
    ArrowLeft: { x: -1, y: 0 },
    ArrowRight: { x: 1, y: 0 },
};

export function isDirection(key: string): key is Direction {
    return key in WAYS;
}

/** The index of the nearest node in a direction; a sideways distance is weighted more. */
export function neighbour(nodes: readonly DrawnNode[], from: number, direction: Direction): number | undefined {
    const shown = nodes.filter((node) => node.index >= 0);
    const start = shown.find((node) => node.index === from);
    if (!start) return shown[0]?.index;
    const way = WAYS[direction];
    const origin = middle(start);
    let best: number | undefined;
    let least = Infinity;
    for (const node of shown) {
        const { x, y } = middle(node);
        const ahead = (x - origin.x) * way.x + (y - origin.y) * way.y;
        const aside = Math.abs((x - origin.x) * way.y) + Math.abs((y - origin.y) * way.x);
        if (node === start || ahead <= 1) continue;
        const far = ahead + 3 * aside;
        if (far < least) [least, best] = [far, node.index];
    }
    return best;
}

/** The indexes of the nodes that contain all words of a text, ignoring case. */
export function search(picture: Picture, text: string): number[] {
    const words = text
        .toLowerCase()
        .split(/\s+/)
        .filter((word) => word !== "");
    if (words.length === 0) return [];
    return picture.nodes.flatMap((node, index) => {
        const all = [node.kind, node.label, ...node.details].join(" ").toLowerCase();
        return words.every((word) => all.includes(word)) ? [index] : [];
    });
}

/** The visible part of a drawing: the point at the top left, and the zoom factor. */
export interface Sight extends Point {
    readonly scale: number;
}

const MARGIN = 24;

/** The view that shows a whole drawing in a window; small drawings are not enlarged. */
export function fit(drawing: { width: number; height: number }, width: number, height: number): Sight {
    const scale = Math.min(
        1,
        (width - 2 * MARGIN) / Math.max(1, drawing.width),
        (height - 2 * MARGIN) / Math.max(1, drawing.height),
    );
    const usable = Math.max(0.05, scale);
    return {
        scale: usable,
        x: (drawing.width - width / usable) / 2,
        y: (drawing.height - height / usable) / 2,
    };
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

function middle(box: Box): Point {
    return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}
