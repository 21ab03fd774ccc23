// SPDX-License-Identifier: Apache-2.0
/** The visible part of the axis, and how it moves. */

import type { Tile } from "../contract";

export interface Stretch {
    readonly from: number;
    readonly to: number;
}

/** The least visible part of the axis, as a part of all. */
const LEAST = 1e-6;

export function pan({ from, to }: Stretch, by: number, extent: number): Stretch {
    const span = to - from;
    const start = Math.min(Math.max(from + by, 0), Math.max(0, extent - span));
    return { from: start, to: start + span };
}

/** Zoom about a position that stays where it is. */
export function zoom({ from, to }: Stretch, factor: number, about: number, extent: number): Stretch {
    const span = Math.min(Math.max((to - from) / factor, extent * LEAST), extent);
    const part = to > from ? (about - from) / (to - from) : 0;
    return pan({ from: about - part * span, to: about - part * span + span }, 0, extent);
}

/** Show a position: nothing changes if it is visible, otherwise it is in the middle. */
export function reveal(stretch: Stretch, position: number, extent: number): Stretch {
    if (stretch.from <= position && position <= stretch.to) return stretch;
    return pan(stretch, position - (stretch.from + stretch.to) / 2, extent);
}

/** The part that is asked for: what is visible, and as much on each side. */
export function withMargins({ from, to }: Stretch, width: number): Stretch & { width: number } {
    const span = to - from;
    const start = Math.max(0, from - span);
    const end = to + span;
    return { from: start, to: end, width: span > 0 ? (width * (end - start)) / span : width };
}

/** Whether a tile has all that is visible, in about the right size. */
export function covers(tile: Pick<Tile, "from" | "to" | "width">, { from, to }: Stretch, width: number): boolean {
    const scale = width / (to - from) / (tile.width / (tile.to - tile.from));
    return contains(tile, { from, to }) && Math.abs(scale - 1) < 0.01;
}

/** Whether a tile has all that is visible, in any size. */
export function contains(tile: Stretch, { from, to }: Stretch): boolean {
    return tile.from <= from && to <= tile.to;
}
